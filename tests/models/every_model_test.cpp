// A decal on every third-party model: none crashes or hangs, nearly all are solved, the rest say why not, and
// the validator finds nothing that it did not find before.

#include "models/every_model.h"

#include <cstdio>
#include <fstream>

#include <gtest/gtest.h>

#include "gltf/test_models.h"
#include "gltf/validator.h"
#include "support/thorough.h"

namespace applique {
namespace {

class EveryModel : public testing::Test {
 protected:
  void SetUp() override {
    if (test_data().empty()) GTEST_SKIP() << no_test_data;
  }

  std::vector<ModelRow> bake(const DecalWish& wish) const {
    auto rows = bake_every_model(APPLIQUE_COMMAND, test_data(), folder_.path(), wish);
    std::puts(table_of(rows).c_str());
    EXPECT_GT(rows.size() * wish.every, 50u);
    return rows;
  }

  TemporaryFolder folder_;
};

void expect_solved_or_turned_down(const ModelRow& row) {
  SCOPED_TRACE(row.model);
  EXPECT_GE(row.inspect_status, 0) << "inspect crashed or hung";
  EXPECT_GE(row.bake_status, 0) << "bake crashed or hung";
  if (row.solved()) {
    EXPECT_LT(row.residual_px, 0.01);
    EXPECT_EQ(row.sentence, "");
  } else {
    EXPECT_TRUE(row.bake_status == 2 || row.bake_status == 3) << row.bake_status;
    const std::string name = std::filesystem::path(row.model).filename().string();
    const std::string culprit = row.triangles == 0 ? "'" + name + "'" : "'decal'";
    EXPECT_NE(row.sentence.find(culprit), std::string::npos) << row.sentence;
  }
}

double share_solved(const std::vector<ModelRow>& rows) {
  double solved = 0, all = 0;
  for (const ModelRow& row : rows) {
    if (row.triangles == 0) continue;  // points and lines
    ++all;
    if (row.solved()) ++solved;
  }
  return solved / all;
}

void expect_nothing_new_to_the_validator(const std::vector<ModelRow>& rows) {
  std::vector<std::filesystem::path> files;
  for (const ModelRow& row : rows)
    if (row.solved()) files.insert(files.end(), {test_data() / row.model, row.output});
  const auto counts = validate(files);
  if (!counts) GTEST_SKIP() << "the glTF validator is not installed (./dev test installs it)";
  for (std::size_t i = 0; i < files.size(); i += 2)
    for (const auto& [code, count] : (*counts)[i + 1]) {
      // Images of a kind that glTF does not know cannot be packed; they stay beside the GLB. An overlay's
      // picture has the size it needs.
      if (code == "2 URI_GLB" || code == "2 IMAGE_NPOT_DIMENSIONS") continue;
      const auto before = (*counts)[i].find(code);
      // Copying a mesh repeats what there is to remark on its other primitives, and dividing a vertex what
      // there is to say about it.
      const bool repeated = code.front() >= '2' || code.substr(2).starts_with("ACCESSOR_");
      EXPECT_LE(repeated ? 1 : count, before != (*counts)[i].end() ? before->second : 0)
          << files[i].filename() << ": " << code;
    }
}

TEST_F(EveryModel, TakesADecalIntoItsTextures) {
  const auto rows = bake({});
  for (const ModelRow& row : rows) expect_solved_or_turned_down(row);
  expect_nothing_new_to_the_validator(rows);
  EXPECT_GE(share_solved(rows), 0.9);
}

TEST_F(EveryModel, TakesAnOverlayWithLayers) {
  Image relief = make_image(64, 64, {0xcccc, 0x8080, 0xe666, 0xffff});
  relief.channels = 3;
  const std::string file = (folder_.path() / "relief.png").string();
  const auto png = encode_png(relief).value();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  const std::string changes = R"({"output": "overlay", "layers": {"normal": ")" + file +
                              R"(", "metallic": 0.3, "roughness": {"value": 0.4, "opacity": 0.5},)" +
                              R"( "occlusion": 0.8, "emissive": [0.2, 0.1, 0]}})";
  const auto rows = bake({changes, 1, thorough() ? 1u : 4u});
  for (const ModelRow& row : rows) expect_solved_or_turned_down(row);
  EXPECT_GE(share_solved(rows), 0.9);
  expect_nothing_new_to_the_validator(rows);
}

/// Larger than the surface has room for.
TEST_F(EveryModel, TakesALargeDecal) {
  const auto rows = bake({R"({"output": "overlay"})", 12, thorough() ? 1u : 6u});
  for (const ModelRow& row : rows) expect_solved_or_turned_down(row);
  EXPECT_GE(share_solved(rows), 0.9);
}

}  // namespace
}  // namespace applique
