#pragma once

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/small_model.h"
#include "model.h"
#include "save_document.h"

namespace applique {

/// The cube from -1 to 1 whose six faces all show the whole texture.
SmallMesh make_box();

/// A wall from x = -2 to 2 at z = 0 whose right half mirrors the left one's texture coordinates.
SmallMesh make_mirrored_wall();

/// The colour of the decal.
bool is_red(const std::array<double, 4>& colour);

/// A red decal "crest" on models of textured and plain materials.
class UvConflictTest : public testing::Test {
 protected:
  static constexpr int image_size = 64;

  void SetUp() override;

  /// Meshes with the materials "paint", which shows noise, and "plain".
  void write_model(const std::vector<SmallMesh>& meshes, int texture_size = 128);

  /// Changes the model's document.
  template <class Edit>
  void edit_model(const Edit& edit) {
    Document document = load_document(folder_ / "model.glb").value();
    edit(document);
    ASSERT_TRUE(save_document(document, folder_ / "model.glb"));
  }

  /// The image, 1 wide, seen from the front at (x, y).
  static nlohmann::json job_at(double x, double y);

  /// The report, which must be as its schema says.
  nlohmann::json read_report();

  /// Bakes, and returns the report.
  nlohmann::json bake(const nlohmann::json& job, const std::string& output = "out.glb",
                      const std::string& options = "");

  [[nodiscard]] Model load(const std::string& name) const { return load_model(folder_ / name).value(); }

  /// With the decal unseen, the model looks as before everywhere; the report has no warnings.
  void expect_same_look(nlohmann::json job);

  /// The most that two pictures differ, in steps of 1/255, of the models seen from an angle.
  double picture_difference(const std::string& before, const std::string& after, int azimuth);

  /// The model so near that no mip levels are shown, with the decal separated but unseen, or without it.
  Image close_up(nlohmann::json job, bool separated, const std::string& model = "model.glb");

  /// The share of two pictures' numbers that differ by more than 2/255.
  static double share_that_differs(const Image& a, const Image& b);

  /// Nothing that the validator says of the output is new.
  void expect_valid(const std::string& output);

  CommandFolder folder_;
};

}  // namespace applique
