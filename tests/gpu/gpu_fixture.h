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
    if (created) shared_device = std::make_unique<Device>(std::move(*created));
    why_none = created ? "" : created.error().message;
  }
  static void TearDownTestSuite() { shared_device.reset(); }

  void SetUp() override {
    if (!shared_device) GTEST_SKIP() << "there is no Vulkan device: " << why_none;
    seen_ = device().validation_messages().size();
  }
  void TearDown() override {
    if (!shared_device) return;
    const auto messages = device().validation_messages();
    for (std::size_t i = seen_; i < messages.size(); ++i) ADD_FAILURE() << messages[i];
  }
  static Device& device() { return *shared_device; }

 private:
  static inline std::unique_ptr<Device> shared_device;
  static inline std::string why_none;
  std::size_t seen_ = 0;
};

}  // namespace applique
