#include "model.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gltf/test_models.h"

namespace applique {
namespace {

Model load(const std::string& name) {
  auto model = load_model(test_data() / name);
  EXPECT_TRUE(model) << name << ": " << (model ? "" : model.error().message);
  return model ? std::move(*model) : Model();
}

std::size_t count_triangles(const Model& model) {
  std::size_t count = 0;
  for (const auto& part : model.parts) count += part.triangles.size();
  return count;
}

Vec3 normal_of(const ModelPart& part, std::size_t triangle) {
  const auto& t = part.triangles[triangle];
  return (part.positions[t[1]] - part.positions[t[0]]).cross(part.positions[t[2]] - part.positions[t[0]]);
}

/// Six times the volume inside the triangles: positive when they are seen from outside.
double volume(const Model& model) {
  double sum = 0;
  for (const auto& part : model.parts)
    for (const auto& t : part.triangles)
      sum += part.positions[t[0]].dot(part.positions[t[1]].cross(part.positions[t[2]]));
  return sum;
}

/// A model of one triangle (0,0,0) (1,0,0) (0,1,0) with what `extra` adds to the root, `node` to its node and
/// `primitive` to its primitive.
Result<Model> make_model(const std::string& extra, const std::string& node, const std::string& primitive) {
  const std::string json = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" +
                           node + R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0})" + primitive +
                           R"(}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
    "buffers":[{"byteLength":39}])" +
                           extra + "}";
  std::vector<std::uint8_t> chunk(39);
  const std::array<float, 9> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::memcpy(chunk.data(), positions.data(), 36);
  chunk[37] = 1;
  chunk[38] = 2;
  APPLIQUE_TRY(auto document, parse_document(make_glb(json, chunk), "made.glb", ""));
  return decode_model(std::move(document));
}

std::string error_of(const Result<Model>& model) {
  return model ? "" : model.error().message;
}

TEST(LoadModel, LoadsEveryGoodModel) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  for (const auto& path : good_models()) {
    const auto model = load_model(path);
    if (!model) {
      // The one reason: points and lines only.
      EXPECT_NE(model.error().message.find("shows no triangles"), std::string::npos) << model.error().message;
      EXPECT_NE(path.string().find("PrimitiveMode"), std::string::npos) << path;
      continue;
    }
    for (const auto& part : model->parts) {
      EXPECT_EQ(part.normals.size(), part.positions.size());
      EXPECT_TRUE(part.uvs.empty() || part.uvs.size() == part.positions.size());
      for (const Vec3& normal : part.normals) ASSERT_NEAR(normal.norm(), 1, 1e-9) << path;
    }
    const ModelSurface surface = build_surface(*model);
    EXPECT_EQ(surface.mesh.faces.size() + surface.mesh.dropped_triangles, count_triangles(*model)) << path;
    for (const FaceId f : ids<FaceId>(surface.mesh.faces.size())) {
      const auto& source = surface.source(f);
      const ModelPart& part = model->parts[source.part];
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_LT((surface.mesh.corners(f)[k] - part.positions[part.triangles[source.triangle][k]]).norm(),
                  1e-6 * model->diagonal())
            << path;
    }
  }
}

TEST(LoadModel, SeesClosedModelsFromOutside) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  for (const char* name : {"gltf/Duck.glb", "gltf/CesiumMan.glb", "gltf/Fox.glb", "gltf/RiggedFigure.glb",
                           "gltf/DenseSphere_quant_draco.glb", "gltf/MultiUVTest/MultiUVTest.gltf"})
    EXPECT_GT(volume(load(name)), 0) << name;
}

TEST(LoadModel, DecodesDracoLikeThePlainModel) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model draco = load("gltf/LeePerrySmith/LeePerrySmith.glb");
  const Model plain = load("derived/gltf/LeePerrySmith_nodraco_textured.glb");
  ASSERT_EQ(draco.parts.size(), 1u);
  EXPECT_EQ(count_triangles(draco), 17684u);
  EXPECT_LT((draco.lower - plain.lower).norm(), 1e-6);
  EXPECT_LT((draco.upper - plain.upper).norm(), 1e-6);
  EXPECT_NEAR(volume(draco), volume(plain), 1e-6 * volume(plain));
  EXPECT_EQ(build_surface(draco).mesh.positions.size(), build_surface(plain).mesh.positions.size());
}

TEST(LoadModel, DecodesEveryPrimitiveMode) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  // Modes 4 to 6 without indices, 11 to 13 with 16-bit ones, 14 and 15 lists with 8 and 32 bits: all one
  // square.
  for (const char* mode : {"04", "05", "06", "11", "12", "13", "14", "15"}) {
    const Model model = load(std::string("gltf/primitive_modes/Mesh_PrimitiveMode_") + mode + ".gltf");
    ASSERT_EQ(model.parts.size(), 1u) << mode;
    const ModelPart& part = model.parts[0];
    ASSERT_EQ(part.triangles.size(), 2u) << mode;
    EXPECT_NEAR(normal_of(part, 0).norm() + normal_of(part, 1).norm(), 2, 1e-6) << mode;
    EXPECT_GT(normal_of(part, 0).dot(normal_of(part, 1)), 0) << mode;
  }
}

TEST(LoadModel, AppliesSparseAccessorsAndQuantization) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model sparse = load("gltf/SimpleSparseAccessor.gltf");
  EXPECT_EQ(sparse.upper.y(), 4) << "only the sparse values are that high";
  const Model meshopt = load("gltf/pirate_meshopt.glb");
  EXPECT_EQ(count_triangles(meshopt), 5010u);
  EXPECT_NEAR(meshopt.upper.y() - meshopt.lower.y(), 1.8, 0.5);
}

TEST(LoadModel, PlacesSkinsByTheirJoints) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model man = load("gltf/CesiumMan.glb");
  const Vec3 size = man.upper - man.lower;
  EXPECT_NEAR(size.y(), 1.5, 0.1) << "he stands along y, his feet on the ground";
  EXPECT_NEAR(man.lower.y(), 0, 0.01);
}

TEST(LoadModel, RotatesTextureCoordinatesAsTheTestModelShows) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model model = load("gltf/TextureTransformTest/TextureTransformTest.gltf");
  // The marker where the rotated arrow points, as texture coordinates of the quad; the arrow runs along u =
  // v.
  const double u = 0.5 - 0.07904822439840126;
  const double v = 0.5 + 0.5162674857624154;
  for (const ModelPart& part : model.parts) {
    if (model.materials[part.material.value()].name != "Rotation") continue;
    const auto& uvs = part.uvs;  // At (0,0), (1,0), (1,1), (0,1).
    EXPECT_NEAR(u * uvs[1][0] + v * uvs[3][0], u * uvs[1][1] + v * uvs[3][1], 1e-3);
    return;
  }
  FAIL() << "the model has no material Rotation";
}

TEST(LoadModel, MirroringNodesTurnTheWinding) {
  const Model plain = make_model("", "", "").value();
  const Model mirrored = make_model("", R"(,"scale":[-1,1,1])", "").value();
  EXPECT_FALSE(plain.parts[0].mirrored);
  EXPECT_TRUE(mirrored.parts[0].mirrored);
  EXPECT_EQ(normal_of(plain.parts[0], 0), Vec3(0, 0, 1));
  EXPECT_EQ(normal_of(mirrored.parts[0], 0), Vec3(0, 0, 1))
      << "a mirror does not turn the surface inside out";
  EXPECT_EQ(mirrored.parts[0].normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mirrored.parts[0].positions[1], Vec3(-1, 0, 0));
}

TEST(LoadModel, ComposesNodes) {
  const double h = std::sqrt(0.5);
  const auto model = make_model(
      "", fmt::format(R"(,"translation":[1,2,3],"rotation":[0,0,{},{}],"scale":[2,2,2])", h, h), "");
  ASSERT_TRUE(model) << error_of(model);
  EXPECT_LT((model->parts[0].positions[1] - Vec3(1, 4, 3)).norm(), 1e-12);
  const auto matrix = make_model("", R"(,"matrix":[0,2,0,0,-2,0,0,0,0,0,2,0,1,2,3,1])", "");
  EXPECT_LT((matrix->parts[0].positions[1] - Vec3(1, 4, 3)).norm(), 1e-12);
}

TEST(LoadModel, TakesTheDefaultScene) {
  const std::string nodes = R"("nodes":[{"mesh":0},{"mesh":0},{"children":[1]}])";
  const auto count_parts = [&](const std::string& scenes) {
    const std::string json = R"({"asset":{"version":"2.0"},)" + scenes + nodes + R"(,
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
      "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
    std::vector<std::uint8_t> chunk(36);
    const std::array<float, 9> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::memcpy(chunk.data(), positions.data(), 36);
    const auto model = decode_model(parse_document(make_glb(json, chunk), "made.glb", "").value());
    return model ? model->parts.size() : 0;
  };
  EXPECT_EQ(count_parts(""), 2u) << "without scenes, every root";
  EXPECT_EQ(count_parts(R"("scenes":[{"nodes":[0]},{"nodes":[0,2]}],)"), 1u)
      << "without a default, the first";
  EXPECT_EQ(count_parts(R"("scene":1,"scenes":[{"nodes":[0]},{"nodes":[0,2]}],)"), 2u);
}

TEST(LoadModel, NamesWhatItCannotUse) {
  EXPECT_EQ(error_of(make_model(R"(,"extensionsRequired":["EXT_mesh_gpu_instancing"])", "", "")),
            "'made.glb', extensionsRequired: the extension EXT_mesh_gpu_instancing is not supported; export "
            "the model "
            "without it");
  EXPECT_EQ(error_of(make_model("", R"(,"children":[0])", "")),
            "'made.glb', node 0: it is its own ancestor (a node cycle)");
  EXPECT_EQ(error_of(make_model("", R"(,"children":[7])", "")),
            "'made.glb', node 0: children holds 7, but there are 1 nodes");
  EXPECT_EQ(error_of(make_model("", "", R"(,"indices":9)")),
            "'made.glb', mesh 0, primitive 0: indices is 9, but there are 2 accessors");
  EXPECT_EQ(error_of(make_model("", "", R"(,"indices":0)")),
            "'made.glb', mesh 0, primitive 0, indices (accessor 0): expected unsigned integers");
  EXPECT_EQ(error_of(make_model("", "", R"(,"material":0)")),
            "'made.glb', mesh 0, primitive 0: material is 0, but there are 0 materials");
  EXPECT_EQ(error_of(make_model("", R"(,"translation":[0,0,"x"])", "")),
            "'made.glb', node 0: translation holds \"x\", expected a finite number");
  EXPECT_EQ(error_of(make_model("", R"(,"scale":[0,0,0])", "")),
            "'made.glb': all its triangles are one point");
  EXPECT_EQ(error_of(make_model(R"(,"materials":[{"emissiveFactor":"x"}])", "", "")),
            "'made.glb', material 0: emissiveFactor is not an array of 3 numbers");
  EXPECT_EQ(
      error_of(make_model(R"(,"materials":[{"pbrMetallicRoughness":{"metallicFactor":"shiny"}}])", "", "")),
      "'made.glb', material 0: metallicFactor is \"shiny\", expected a number");
  EXPECT_EQ(error_of(make_model(R"(,"materials":[{"normalTexture":{"index":3}}])", "", "")),
            "'made.glb', material 0, normalTexture: index is 3, but there are 0 textures");
  EXPECT_EQ(error_of(make_model("", "", R"(,"mode":1)")),
            "'made.glb': its default scene shows no triangles, and points and lines cannot carry a "
            "decal");
}

TEST(LoadModel, DoesNotTrustCounts) {
  const auto with_accessor = [](const std::string& accessor) {
    const std::string json = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[)" +
                             accessor + R"(],
      "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
    return error_of(
        decode_model(parse_document(make_glb(json, std::vector<std::uint8_t>(36)), "made.glb", "").value()));
  };
  EXPECT_EQ(with_accessor(R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})"),
            "'made.glb', mesh 0, primitive 0, POSITION (accessor 0): 4 elements of 12 bytes lie beyond the "
            "end of a "
            "buffer view of 36 bytes");
  EXPECT_NE(
      with_accessor(R"({"bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3"})"),
      "");
  EXPECT_EQ(
      with_accessor(R"({"componentType":5126,"count":4000000000,"type":"VEC3"})"),
      "'made.glb', mesh 0, primitive 0, POSITION (accessor 0): 4000000000 elements without a buffer view");
  EXPECT_EQ(with_accessor(R"({"bufferView":0,"byteOffset":30,"componentType":5126,"count":1,"type":"VEC3"})"),
            "'made.glb', mesh 0, primitive 0, POSITION (accessor 0): 1 elements of 12 bytes lie beyond the "
            "end of a "
            "buffer view of 36 bytes");
}

TEST(LoadModel, NamesTheMissingFile) {
  const TemporaryFolder folder;
  write_text(folder / "m.gltf",
             R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"lost%20one.bin"}]})");
  const auto model = load_model(folder / "m.gltf");
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::file_unreadable);
  EXPECT_NE(model.error().message.find("lost one.bin"), std::string::npos) << model.error().message;
  EXPECT_EQ(load_model(folder / "none.glb").error().code, ErrorCode::file_unreadable);
}

TEST(BuildSurface, TakesOnlyWhatIsAllowed) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model model = load("gltf/FlightHelmet/FlightHelmet.gltf");
  std::size_t all = build_surface(model).mesh.faces.size();
  for (const ModelPart& part : model.parts) {
    const ModelSurface by_node = build_surface(model, {part.node});
    const ModelSurface by_material = build_surface(model, {}, {part.material.value()});
    EXPECT_EQ(by_node.sources.size(), part.triangles.size());
    EXPECT_EQ(by_material.sources.size(), part.triangles.size());
    all -= by_node.mesh.faces.size();
  }
  EXPECT_EQ(all, 0u);
}

TEST(LoadModelImage, DecodesTheTextureAViewerShows) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const Model webp = load("gltf/webp_box/box-textured-with-fallback.gltf");
  const auto image = load_model_image(webp, webp.materials[0].image.value());
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 128);
  const Model lamp = load("gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf");
  EXPECT_TRUE(load_model_image(lamp, lamp.materials[lamp.parts[0].material.value()].image.value_or(0)));
}

}  // namespace
}  // namespace applique
