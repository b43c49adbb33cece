#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "applique/gpu/device.h"

namespace applique {

/// A test on the best Vulkan device, with the validation layers on: whatever they say fails the test.
class GpuTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto created = Device::create({"", true});
    if (created) device_ = std::make_unique<Device>(std::move(*created));
    reason_ = created ? "" : created.error().message;
  }
  static void TearDownTestSuite() { device_.reset(); }

  void SetUp() override {
    if (!device_) GTEST_SKIP() << "there is no Vulkan device: " << reason_;
    seen_ = device().validation_messages().size();
  }
  void TearDown() override {
    if (!device_) return;
    const auto messages = device().validation_messages();
    for (std::size_t i = seen_; i < messages.size(); ++i) ADD_FAILURE() << messages[i];
  }
  static Device& device() { return *device_; }

 private:
  static inline std::unique_ptr<Device> device_;
  static inline std::string reason_;
  std::size_t seen_ = 0;
};

}  // namespace applique
