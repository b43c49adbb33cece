#include "edit.h"

#include <cstring>

#include <gtest/gtest.h>

#include "gltf/test_models.h"
#include "gltf/validator.h"
#include "model.h"
#include "overlay.h"
#include "save_document.h"

namespace applique {
namespace {

using Json = Document::Json;

constexpr std::array<std::uint16_t, 4> teal = {0, 0x8080, 0x8080, 0xFFFF};

PartKey key_of(const ModelPart& part) {
  return {part.node, part.mesh, part.primitive};
}

/// A document whose nodes show a triangle's mesh: node i shows mesh `meshes[i]`; mesh m has one primitive for
/// each entry of `materials[m]` (negative: no material). Material k uses texture k and image k.
Document make_document(const std::vector<int>& meshes, const std::vector<std::vector<int>>& materials,
                       int textures) {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  Document document;
  document.json = std::move(json);
  document.name = "made.glb";
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::vector<float> uvs = {0, 0, 1, 0, 0, 1};
  auto& chunk = document.binary_chunk;
  chunk.resize(60);
  std::memcpy(chunk.data(), positions.data(), 36);
  std::memcpy(chunk.data() + 36, uvs.data(), 24);
  auto& root = document.json;
  root["bufferViews"] =
      Json::parse(R"([{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}])");
  root["accessors"] = Json::parse(R"([
    {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
    {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}])");
  for (int k = 0; k < textures; ++k) {
    const auto png = make_png(4 + k, {0x2020, 0x2020, static_cast<std::uint16_t>(0x1111 * k), 0xFFFF});
    Json view;
    view["buffer"] = 0;
    view["byteOffset"] = chunk.size();
    view["byteLength"] = png.size();
    chunk.insert(chunk.end(), png.begin(), png.end());
    chunk.resize((chunk.size() + 3) / 4 * 4);
    Json image = {{"mimeType", "image/png"}};
    image["bufferView"] = root["bufferViews"].size();
    root["bufferViews"].push_back(view);
    root["images"].push_back(image);
    Json texture = {{"source", k}, {"name", "texture " + std::to_string(k)}};
    root["textures"].push_back(texture);
    Json material = {{"name", "material " + std::to_string(k)}, {"extras", {{"keep", k}}}};
    material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = k;
    root["materials"].push_back(material);
  }
  Json buffer;
  buffer["byteLength"] = chunk.size();
  root["buffers"].push_back(buffer);
  document.chunk_buffer = 0;
  for (const auto& list : materials) {
    Json mesh;
    for (const int material : list) {
      Json primitive = {{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"extras", {{"kept", true}}}};
      if (material >= 0) primitive["material"] = material;
      mesh["primitives"].push_back(primitive);
    }
    root["meshes"].push_back(mesh);
  }
  Json scene = Json::object();
  for (const int mesh : meshes) {
    Json node;
    node["mesh"] = mesh;
    scene["nodes"].push_back(root["nodes"].size());
    root["nodes"].push_back(node);
  }
  root["scenes"].push_back(scene);
  return document;
}

std::size_t material_at(const Document& document, std::size_t node, std::size_t primitive) {
  const auto mesh = index_of(document.json["nodes"][node], "mesh").value();
  return index_of(document.json["meshes"][mesh]["primitives"][primitive], "material").value();
}

TEST(IsolateMaterials, LeavesWhatIsAloneAsItIs) {
  Document document = make_document({0, 1}, {{0}, {1}}, 2);
  const Json before = document.json;
  EXPECT_EQ(isolate_materials(document, std::vector<PartKey>{{0, 0, 0}}), std::vector<std::size_t>{0});
  EXPECT_EQ(document.json, before);
}

TEST(IsolateMaterials, CopiesAMaterialThatAnotherPrimitiveUses) {
  Document document = make_document({0, 1}, {{0}, {0}}, 1);
  const auto materials = isolate_materials(document, std::vector<PartKey>{{1, 1, 0}});
  EXPECT_EQ(materials, std::vector<std::size_t>{1});
  EXPECT_EQ(material_at(document, 0, 0), 0u);
  EXPECT_EQ(material_at(document, 1, 0), 1u);
  EXPECT_EQ(document.json["materials"][1], document.json["materials"][0]);
}

TEST(IsolateMaterials, KeepsTouchedPrimitivesTogether) {
  Document document = make_document({0, 1, 2}, {{0, 0}, {0}, {0}}, 1);
  const auto materials = isolate_materials(document, std::vector<PartKey>{{0, 0, 0}, {1, 1, 0}});
  EXPECT_EQ(materials[0], materials[1]);
  EXPECT_NE(materials[0], 0u);
  EXPECT_EQ(material_at(document, 0, 1), 0u) << "the untouched primitive of a touched mesh";
  EXPECT_EQ(material_at(document, 2, 0), 0u);
}

TEST(IsolateMaterials, CopiesAMeshThatAnotherNodeShows) {
  Document document = make_document({0, 0}, {{0}}, 1);
  const auto materials = isolate_materials(document, std::vector<PartKey>{{1, 0, 0}});
  EXPECT_EQ(document.json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(document.json["nodes"][1]["mesh"], 1);
  EXPECT_EQ(material_at(document, 0, 0), 0u);
  EXPECT_EQ(material_at(document, 1, 0), materials[0]);
  EXPECT_NE(materials[0], 0u);
  EXPECT_EQ(document.json["accessors"].size(), 2u) << "accessors stay shared";
}

TEST(IsolateMaterials, GivesTwoTouchedInstancesTheirOwnMaterials) {
  Document document = make_document({0, 0}, {{0, 0}}, 1);
  const std::vector<PartKey> parts = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}};
  const auto materials = isolate_materials(document, parts);
  EXPECT_EQ(materials[0], materials[1]);
  EXPECT_EQ(materials[2], materials[3]);
  EXPECT_NE(materials[0], materials[2]);
  EXPECT_EQ(document.json["meshes"].size(), 2u);
  EXPECT_EQ(document.json["materials"].size(), 2u) << "the first instance keeps the original";
}

TEST(IsolateMaterials, LeavesTheMeshToAllThatShareAChange) {
  Document document = make_document({0, 0, 0}, {{0}}, 1);
  // One part for the first node and the last together, one for the second alone.
  const std::vector<PartKey> parts = {{0, 0, 0, true}, {1, 0, 0, false}};
  const auto materials = isolate_materials(document, parts);
  EXPECT_EQ(document.json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(document.json["nodes"][1]["mesh"], 1);
  EXPECT_EQ(document.json["nodes"][2]["mesh"], 0);
  EXPECT_NE(materials[0], materials[1]);
  EXPECT_EQ(material_at(document, 2, 0), materials[0]);
  EXPECT_EQ(material_at(document, 1, 0), materials[1]);
  EXPECT_EQ(document.json["materials"].size(), 2u);
}

TEST(IsolateMaterials, VariantsOfThePartFollow) {
  const auto mappings = [](Document& document, std::size_t mesh) -> Json& {
    return document.json["meshes"][mesh]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"];
  };
  const Json both = Json::parse(R"([{"material":0,"variants":[0]},{"material":1,"variants":[1]}])");
  Document alone = make_document({0}, {{0}}, 2);
  mappings(alone, 0) = both;
  EXPECT_EQ(isolate_materials(alone, std::vector<PartKey>{{0, 0, 0}})[0], 0u) << "nothing else uses it";
  EXPECT_EQ(mappings(alone, 0), both);

  Document shared = make_document({0, 1}, {{0}, {1}}, 2);
  mappings(shared, 0) = both;
  mappings(shared, 1) = both;
  EXPECT_EQ(isolate_materials(shared, std::vector<PartKey>{{0, 0, 0}})[0], 2u);
  EXPECT_EQ(mappings(shared, 0)[0]["material"], 2u);
  EXPECT_EQ(mappings(shared, 0)[1]["material"], 1u);
  EXPECT_EQ(mappings(shared, 1), both) << "a variant of another part is a use of its own";
}

TEST(IsolateMaterials, MakesAMaterialWhereThereIsNone) {
  Document document = make_document({0, 1}, {{-1}, {-1}}, 0);
  const auto materials = isolate_materials(document, std::vector<PartKey>{{0, 0, 0}});
  EXPECT_EQ(materials[0], 0u);
  EXPECT_FALSE(document.json["meshes"][1]["primitives"][0].contains("material"));
}

TEST(SetBaseColourImage, ReplacesTheImageInPlaceAndDropsItsBytes) {
  Document document = make_document({0, 1}, {{0}, {1}}, 2);
  const auto other = read_image_bytes(document, 1).value();
  const Json before = document.json;
  const std::size_t old_size = document.binary_chunk.size();
  const std::size_t old_png = read_image_bytes(document, 0)->size();
  const auto png = make_png(8, teal);
  set_slot_image(document, 0, MaterialSlot::base_color, png);
  EXPECT_EQ(read_image_bytes(document, 0).value(), png);
  EXPECT_EQ(read_image_bytes(document, 1).value(), other);
  EXPECT_EQ(document.json["textures"], before["textures"]);
  EXPECT_EQ(document.json["materials"], before["materials"]);
  EXPECT_LE(document.binary_chunk.size(), old_size - old_png + png.size() + 8);
  EXPECT_EQ(document.json["buffers"][0]["byteLength"], document.binary_chunk.size());
  EXPECT_TRUE(decode_model(document).has_value());
}

TEST(SetBaseColourImage, CopiesATextureThatAnotherSlotUses) {
  Document document = make_document({0}, {{0}}, 1);
  document.json["materials"][0]["emissiveTexture"]["index"] = 0;
  const auto original = read_image_bytes(document, 0).value();
  const auto png = make_png(8, teal);
  set_slot_image(document, 0, MaterialSlot::base_color, png);
  EXPECT_EQ(document.json["materials"][0]["emissiveTexture"]["index"], 0);
  EXPECT_EQ(read_image_bytes(document, 0).value(), original);
  const Model model = decode_model(document).value();
  EXPECT_EQ(read_image_bytes(model.document, model.materials[0].image.value()).value(), png);
}

TEST(SetBaseColourImage, GivesATextureToAMaterialWithoutOne) {
  Document document = make_document({0}, {{-1}}, 0);
  const auto materials = isolate_materials(document, std::vector<PartKey>{{0, 0, 0}});
  document.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.5, 0.5, 1.0};
  const auto png = make_png(8, teal);
  set_slot_image(document, materials[0], MaterialSlot::base_color, png);
  const Model model = decode_model(document).value();
  EXPECT_EQ(model.materials[0].base_colour_factor, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(read_image_bytes(model.document, model.materials[0].image.value()).value(), png);
}

TEST(SetBaseColourImage, ShowsAWebpByItsExtension) {
  Document document = make_document({0}, {{0}}, 1);
  const auto webp = encode_webp(make_image(8, 8, teal), 100).value();
  for (int times = 0; times < 2; ++times) {
    set_slot_image(document, 0, MaterialSlot::base_color, webp);
    const auto image =
        document.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"].get<std::size_t>();
    EXPECT_EQ(read_image_bytes(document, image).value(), webp);
    EXPECT_EQ(document.json["images"][image]["mimeType"], "image/webp");
    EXPECT_FALSE(document.json["textures"][0].contains("source"));
    EXPECT_EQ(document.json["extensionsRequired"], Json::array({"EXT_texture_webp"}));
  }
  set_slot_image(document, 0, MaterialSlot::base_color, make_png(8, teal));
  EXPECT_FALSE(document.json["textures"][0].contains("extensions"));
  EXPECT_EQ(document.json["textures"][0]["source"], 0);
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    EXPECT_FALSE(document.json.contains(list)) << "no WebP is left";
}

TEST(SetBaseColourImage, WinsOverAWebpOfTheTexture) {
  Document document = make_document({0, 1}, {{0}, {1}}, 3);
  // Texture 0 shows image 1 as WebP, image 0 otherwise; texture 1 shows image 2.
  document.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  document.json["textures"][1]["source"] = 2;
  document.json["textures"].erase(2);
  document.json["materials"].erase(2);
  const auto other = read_image_bytes(document, 2).value();
  const auto png = make_png(8, teal);
  set_slot_image(document, 0, MaterialSlot::base_color, png);
  const Model model = decode_model(document).value();
  EXPECT_EQ(read_image_bytes(model.document, model.materials[0].image.value()).value(), png);
  EXPECT_EQ(read_image_bytes(model.document, model.materials[1].image.value()).value(), other);
  EXPECT_EQ(document.json["images"].size(), 2u) << "no image is left that nothing shows";
}

OverlayMesh make_overlay() {
  OverlayMesh overlay;
  overlay.positions = {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  overlay.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  overlay.uvs = {{0, 1}, {1, 1}, {0, 0}};
  overlay.triangles = {{0, 1, 2}};
  return overlay;
}

OverlayMaterial material_of(const std::vector<std::uint8_t>& png) {
  OverlayMaterial material;
  material.textures[MaterialSlot::base_color] = png;
  return material;
}

TEST(AddOverlay, IsANamedMeshOfTheScene) {
  Document document = make_document({0}, {{0}}, 1);
  const auto png = make_png(8, teal);
  const std::size_t node = add_overlay(document, "crest", make_overlay(),
                                       add_overlay_material(document, "crest", material_of(png)));
  const Model model = decode_model(document).value();
  ASSERT_EQ(model.parts.size(), 2u);
  const ModelPart& part = model.parts[1];
  EXPECT_EQ(part.node, node);
  EXPECT_EQ(part.positions[1], Vec3(1, 0, 2));
  EXPECT_EQ(part.uvs[0], (std::array<double, 2>{0, 1}));
  const Json& mesh = model.document.json["meshes"][part.mesh];
  EXPECT_EQ(mesh["name"], "crest");
  EXPECT_EQ(mesh["extras"], Json::parse(R"({"applique":{"decal":"crest"}})"));
  const ModelMaterial& material = model.materials[part.material.value()];
  EXPECT_EQ(material.alpha_mode, "BLEND");
  EXPECT_EQ(read_image_bytes(model.document, material.image.value()).value(), png);
}

/// Bakes an image into the first part's material and adds an overlay, on every model that loads; what comes
/// out loads again, and the validator has nothing to say about it that it did not say before.
class EditedModels : public testing::TestWithParam<const char*> {};

TEST_P(EditedModels, ReportNothingNewToTheValidator) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  std::vector<std::string> names;
  for (const auto& path : good_models()) {
    auto model = load_model(path);
    if (!model) continue;
    Document document = model->document;
    const ModelPart& first = model->parts.front();
    if (!first.uvs.empty()) {
      const auto materials = isolate_materials(document, std::vector<PartKey>{key_of(first)});
      set_slot_image(document, materials[0], MaterialSlot::base_color, make_png(16, teal));
    }
    add_overlay(document, "crest", make_overlay(),
                add_overlay_material(document, "crest", material_of(make_png(8, teal))));
    const auto output = folder / (std::to_string(names.size()) + "_" + path.stem().string() + GetParam());
    const auto saved = save_document(document, output);
    ASSERT_TRUE(saved) << path << ": " << saved.error().message;
    const auto again = load_model(output);
    ASSERT_TRUE(again) << path << ": " << again.error().message;
    EXPECT_EQ(again->parts.size(), model->parts.size() + 1) << path;
    names.push_back(path.string());
    files.push_back(path);
    files.push_back(output);
  }
  const auto counts = validate(files);
  if (!counts) GTEST_SKIP() << "the glTF validator is not installed (./dev test installs it)";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ValidatorCounts& before = (*counts)[2 * i];
    for (const auto& [code, count] : (*counts)[2 * i + 1]) {
      // Images of a kind that glTF does not know cannot be packed; they stay beside the GLB.
      if (code == "2 URI_GLB") continue;
      const auto old = before.find(code);
      // Copying a mesh repeats what there is to remark on its other primitives.
      const bool remark = code.front() >= '2';
      EXPECT_LE(remark ? 1 : count, old != before.end() ? old->second : 0) << names[i] << ": " << code;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EditedModels, testing::Values(".glb", ".gltf"),
                         [](const auto& format) { return std::string(format.param).substr(1); });

}  // namespace
}  // namespace applique
