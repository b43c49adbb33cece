#pragma once

#include <array>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "model.h"

namespace applique {

/// A plane "Sheet" over [-1, 1] x [-1, 1], facing +z, whose material "paint" shows noise, and a decal of four
/// quarters (red, green; blue, white) upright on its middle half.
class SheetTest : public testing::Test {
 protected:
  static constexpr int image_size = 64;
  static constexpr int texture_size = 256;
  using Colour = std::array<std::uint16_t, 4>;

  void SetUp() override;

  static Image make_quarters();
  /// The quarter's colour at a place of the plane.
  static Colour quarter_at(double x, double y);

  /// Rewrites model.glb.
  void edit_model(const std::function<void(Document&)>& edit);
  static nlohmann::json job_at(double x, double y, double z);
  CommandResult bake(const nlohmann::json& job,
                     const std::string& arguments = "-o out.glb --report report.json");
  /// The output, which must load.
  [[nodiscard]] Model output(const std::string& name = "out.glb") const;
  nlohmann::json report();

  /// The part under the node of this name, and the texture it shows.
  static const ModelPart& part_named(const Model& model, const std::string& name);
  static Image texture_of(const Model& model, const std::string& node);

  /// Where the texture shows a place of the plane (u, v in [0, 1] without a transform), as a sampler would.
  using Sampler = std::function<std::array<double, 2>(double u, double v)>;
  /// Counts the places of the middle half, but for its edges and axes, at which the texture does not show the
  /// quarter to within `tolerance` of 255.
  static int count_wrong(const Image& texture, const Sampler& sampler, int tolerance = 0);
  static std::array<double, 2> plain(double u, double v) { return {u, v}; }

  CommandFolder folder_;
  Image noise_ = make_noise(texture_size);
};

}  // namespace applique
