// How materials and nodes show a texture: transforms, texture coordinates, wrapping, mirrors, instances,
// tints.

#include <cmath>
#include <numbers>

#include "binary_edit.h"
#include "cli/sheet.h"
#include "gltf/test_models.h"
#include "gltf/validator.h"

namespace applique {
namespace {

using nlohmann::json;
using Json = Document::Json;

class Placements : public SheetTest {
 protected:
  static Json& texture_info(Document& document) {
    return document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  }

  static void declare_extension(Document& document, const char* name) {
    document.json["extensionsUsed"].push_back(name);
  }

  /// Makes texture coordinates `set` of the plane: `map` of those it has.
  static void write_uvs(Document& document, std::size_t set, const Sampler& map) {
    auto& attributes = document.json["meshes"][0]["primitives"][0]["attributes"];
    const Model model = decode_model(document).value();
    std::vector<float> uvs;
    for (const auto& uv : model.parts[0].uvs)
      for (const double t : map(uv[0], uv[1])) uvs.push_back(static_cast<float>(t));
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(uvs.data());
    const std::size_t view = add_buffer_view(document, {bytes, 4 * uvs.size()});
    attributes["TEXCOORD_" + std::to_string(set)] = document.json["accessors"].size();
    document.json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", 5126}, {"count", uvs.size() / 2}, {"type", "VEC2"}});
  }

  void expect_baked(const Sampler& sampler) {
    const CommandResult result = bake(job_at(0, 0, 0));
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(report()["decals"][0]["coverage_status"], "covered");
    EXPECT_EQ(count_wrong(texture_of(output(), "Sheet"), sampler), 0);
  }
};

double repeated(double t) {
  return t - std::floor(t);
}

double reflected(double t) {
  const double period = t - 2 * std::floor(t / 2);
  return period < 1 ? period : 2 - period;
}

TEST_F(Placements, TextureTransformWithRotation) {
  const double angle = 0.6;
  edit_model([&](Document& document) {
    declare_extension(document, "KHR_texture_transform");
    texture_info(document)["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.3, 0.2}}, {"rotation", angle}, {"scale", {0.8, 0.5}}};
  });
  expect_baked([&](double u, double v) -> std::array<double, 2> {
    // The extension's matrices: offset * rotation * scale.
    const double su = 0.8 * u, sv = 0.5 * v;
    return {repeated(0.3 + std::cos(angle) * su + std::sin(angle) * sv),
            repeated(0.2 - std::sin(angle) * su + std::cos(angle) * sv)};
  });
}

TEST_F(Placements, TextureTransformMayNameTheCoordinates) {
  edit_model([](Document& document) {
    write_uvs(document, 1, [](double u, double v) -> std::array<double, 2> { return {v, 1 - u}; });
    declare_extension(document, "KHR_texture_transform");
    texture_info(document)["extensions"]["KHR_texture_transform"] = {{"scale", {0.5, 1}}, {"texCoord", 1}};
  });
  expect_baked([](double u, double v) -> std::array<double, 2> { return {0.5 * v, 1 - u}; });
}

TEST_F(Placements, OtherTextureCoordinates) {
  for (const std::size_t set : {1U, 2U}) {
    edit_model([&](Document& document) {
      write_uvs(document, set, [](double u, double v) -> std::array<double, 2> {
        return {1 - v, 1 - 0.5 * u};
      });
      texture_info(document)["texCoord"] = set;
    });
    expect_baked([](double u, double v) -> std::array<double, 2> { return {1 - v, 1 - 0.5 * u}; });
    SetUp();
  }
}

TEST_F(Placements, RepeatedCoordinatesComeRoundTheBorder) {
  const Sampler beyond = [](double u, double v) -> std::array<double, 2> {
    return {0.9 * u + 1.3, 0.9 * v - 0.6};
  };
  edit_model([&](Document& document) { write_uvs(document, 0, beyond); });
  expect_baked([&](double u, double v) -> std::array<double, 2> {
    const auto uv = beyond(u, v);
    return {repeated(uv[0]), repeated(uv[1])};
  });
}

TEST_F(Placements, MirroredCoordinatesTurnRound) {
  edit_model([](Document& document) {
    write_uvs(document, 0, [](double u, double v) -> std::array<double, 2> { return {u + 1, v - 1}; });
    document.json["samplers"] = Json::array({{{"wrapS", 33648}, {"wrapT", 33648}}});
    document.json["textures"][0]["sampler"] = 0;
  });
  expect_baked([](double u, double v) -> std::array<double, 2> {
    return {reflected(u + 1), reflected(v - 1)};
  });
}

TEST_F(Placements, ClampedCoordinatesEndAtTheBorder) {
  edit_model([](Document& document) {
    write_uvs(document, 0, [](double u, double v) -> std::array<double, 2> { return {u - 0.4, v}; });
    document.json["samplers"] = Json::array({{{"wrapS", 33071}, {"wrapT", 33071}}});
    document.json["textures"][0]["sampler"] = 0;
  });
  // What lies beyond the border shares its texels: by default it would get texture space of its own.
  auto job = job_at(0, 0, 0);
  job["decals"][0]["uv_conflict"] = "share";
  ASSERT_EQ(bake(job).status, 0);
  const Image texture = texture_of(output(), "Sheet");
  // The plane from x = -0.2 on lies in the texture; nothing comes in again from the other side.
  for (const double x : {-0.15, -0.1, 0.1, 0.3, 0.4})
    for (const double y : {-0.4, -0.2, 0.2, 0.4}) {
      const int column = static_cast<int>(texture_size * (0.5 + 0.5 * x - 0.4));
      const std::uint16_t* texel = texture.pixel(column, static_cast<int>(texture_size * (0.5 - 0.5 * y)));
      const Colour expected = quarter_at(x, y);
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), texel)) << x << ", " << y;
    }
  for (int y = 0; y < texture_size; ++y)
    for (int x = texture_size / 2; x < texture_size; ++x)
      ASSERT_EQ(texture.pixel(x, y)[0], noise_.pixel(x, y)[0]) << x << ", " << y;
}

TEST_F(Placements, NegativeScaleShowsTheImageTheRightWayRound) {
  edit_model([](Document& document) { document.json["nodes"][0]["scale"] = {-1, 1, 1}; });
  // The plane's left is now at the right of the scene, where the image's right is.
  expect_baked([](double u, double v) -> std::array<double, 2> { return {1 - u, v}; });
}

TEST_F(Placements, DoubleSidedPlanesAreFine) {
  edit_model([](Document& document) { document.json["materials"][0]["doubleSided"] = true; });
  expect_baked(plain);
  EXPECT_EQ(output().document.json["materials"][0]["doubleSided"], true);
}

TEST_F(Placements, AlphaModesStay) {
  for (const char* mode : {"OPAQUE", "MASK", "BLEND"}) {
    edit_model([&](Document& document) { document.json["materials"][0]["alphaMode"] = mode; });
    expect_baked(plain);
    EXPECT_EQ(output().document.json["materials"][0]["alphaMode"], mode);
  }
}

/// Three nodes show the sheet, at x = 0, 4 and 8, the last one mirrored.
class Instances : public Placements {
 protected:
  void SetUp() override {
    SheetTest::SetUp();
    edit_model([](Document& document) {
      auto& nodes = document.json["nodes"];
      nodes = Json::array({{{"name", "A"}, {"mesh", 0}},
                           {{"name", "B"}, {"mesh", 0}, {"translation", {4, 0, 0}}},
                           {{"name", "C"}, {"mesh", 0}, {"translation", {8, 0, 0}}, {"scale", {-1, 1, 1}}}});
      document.json["scenes"][0]["nodes"] = {0, 1, 2};
    });
    write_png(folder_ / "black.png", make_image(image_size, image_size, {0, 0, 0, 0xffff}));
  }

  static bool is_untouched(const Image& texture, const Image& noise) { return texture.rgba == noise.rgba; }

  static std::size_t mesh_of(const Model& model, const std::string& node) {
    return part_named(model, node).mesh;
  }
};

TEST_F(Instances, ThisCopiesTheMesh) {
  json job = job_at(4, 0, 0);
  job["decals"][0]["instance"] = "this";
  ASSERT_EQ(bake(job).status, 0);
  const Model model = output();
  EXPECT_EQ(model.document.json["meshes"].size(), 2u);
  EXPECT_EQ(count_wrong(texture_of(model, "B"), plain), 0);
  EXPECT_TRUE(is_untouched(texture_of(model, "A"), noise_));
  EXPECT_TRUE(is_untouched(texture_of(model, "C"), noise_));
  EXPECT_EQ(report()["decals"][0]["warnings"], json::array());
}

TEST_F(Instances, AllIsSeenOnEveryNode) {
  json job = job_at(4, 0, 0);
  job["decals"][0]["instance"] = "all";
  ASSERT_EQ(bake(job).status, 0);
  const Model model = output();
  EXPECT_EQ(model.document.json["meshes"].size(), 1u) << "the mesh is not copied";
  EXPECT_EQ(model.document.json["materials"].size(), 1u);
  for (const char* node : {"A", "B", "C"}) {
    EXPECT_EQ(mesh_of(model, node), 0u);
    EXPECT_EQ(count_wrong(texture_of(model, node), plain), 0);
  }
  EXPECT_EQ(report()["decals"][0]["warnings"], json::array()) << "the other instances are no UV overlap";
}

TEST_F(Instances, AllFromAMirroredNode) {
  json job = job_at(8, 0, 0);
  job["decals"][0]["instance"] = "all";
  ASSERT_EQ(bake(job).status, 0);
  const Image texture = texture_of(output(), "A");
  EXPECT_EQ(count_wrong(texture,
                        [](double u, double v) -> std::array<double, 2> {
                          return {1 - u, v};
                        }),
            0)
      << "right at the node it was put on, so mirrored on the others";
}

TEST_F(Instances, DecalsOfBothSortsMeet) {
  json job = job_at(0, 0, 0);
  json everywhere = job["decals"][0], here = job["decals"][0];
  everywhere["name"] = "everywhere";
  everywhere["image"] = "black.png";
  everywhere["instance"] = "all";
  here["features"][0]["position"][0] = 3.75;
  here["features"][1]["position"][0] = 4.25;
  job["decals"] = {everywhere, here};
  ASSERT_EQ(bake(job).status, 0);
  const Model model = output();
  EXPECT_EQ(model.document.json["meshes"].size(), 2u);
  EXPECT_EQ(count_wrong(texture_of(model, "B"), plain), 0) << "its own decal lies over the common one";
  for (const char* node : {"A", "C"}) {
    const Image texture = texture_of(model, node);
    EXPECT_EQ(texture.pixel(texture_size / 2, texture_size / 2)[0], 0) << node;
    EXPECT_EQ(texture.pixel(texture_size * 2 / 3, texture_size * 2 / 3)[2], 0) << node;
  }
  // The common decal is seen on B as well, where its own does not cover it.
  job["decals"][1]["features"][0]["position"][1] = 0.6;
  job["decals"][1]["features"][1]["position"][1] = 0.6;
  ASSERT_EQ(bake(job).status, 0);
  EXPECT_EQ(texture_of(output(), "B").pixel(texture_size / 2, texture_size * 11 / 16)[1], 0);
}

TEST_F(Instances, OverlaysKnowNone) {
  json job = job_at(4, 0, 0);
  job["decals"][0]["instance"] = "all";
  job["decals"][0]["output"] = "overlay";
  ASSERT_EQ(bake(job).status, 0);
  EXPECT_EQ(report()["decals"][0]["warnings"][0]["code"], "instance_ignored");
}

class Tints : public Placements {
 protected:
  /// Vertex colours of the plane: red where x > 0 and white elsewhere, or white all over.
  static void write_colours(Document& document, bool tinted) {
    const Model model = decode_model(document).value();
    std::vector<std::uint8_t> colours;
    for (const Vec3& p : model.parts[0].positions) {
      const std::uint8_t other = tinted && p.x() > 0.01 ? 0 : 255;
      colours.insert(colours.end(), {255, other, other, 255});
    }
    const std::size_t view = add_buffer_view(document, colours);
    document.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = document.json["accessors"].size();
    document.json["accessors"].push_back({{"bufferView", view},
                                          {"componentType", 5121},
                                          {"normalized", true},
                                          {"count", colours.size() / 4},
                                          {"type", "VEC4"}});
  }

  void write_factor(const std::array<double, 4>& factor) {
    edit_model([&](Document& document) {
      document.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = factor;
    });
  }

  /// The codes of what a check warns of, and a bake.
  void expect_warnings(const json& job, const std::vector<std::string>& codes) {
    folder_.write("job.json", job);
    ASSERT_EQ(folder_.run("check job.json --report report.json").status, 0);
    EXPECT_EQ(warnings(), codes) << "check";
    ASSERT_EQ(bake(job).status, 0);
    EXPECT_EQ(warnings(), codes) << "bake";
  }

  std::vector<std::string> warnings() {
    std::vector<std::string> codes;
    const json all = report();
    for (const json& warning : all["decals"][0]["warnings"]) codes.push_back(warning["code"]);
    return codes;
  }
};

TEST_F(Tints, VertexColoursUnderTheDecalAreWarnedOf) {
  edit_model([](Document& document) { write_colours(document, true); });
  ASSERT_EQ(bake(job_at(0, 0, 0)).status, 0);
  EXPECT_EQ(warnings(), std::vector<std::string>{"vertex_colors_tint"});
  json away = job_at(-0.6, 0, 0);
  away["decals"][0]["region"] = {{"contour", {{16, 8}, {48, 8}, {48, 56}, {16, 56}}}};
  ASSERT_EQ(bake(away).status, 0);
  EXPECT_EQ(warnings(), std::vector<std::string>{}) << "white there";
}

TEST_F(Tints, WhiteVertexColoursAreNoMatter) {
  edit_model([](Document& document) { write_colours(document, false); });
  ASSERT_EQ(bake(job_at(0, 0, 0)).status, 0);
  EXPECT_EQ(warnings(), std::vector<std::string>{});
}

TEST_F(Tints, FactorsAreWarnedOf) {
  write_factor({1, 0.5, 0.5, 1});
  expect_warnings(job_at(0, 0, 0), {"base_color_factor_tints"});
}

TEST_F(Tints, TransparentMaterialsAreWarnedOf) {
  const auto write_mode = [&](const char* mode, double alpha, double cutoff) {
    write_factor({1, 1, 1, alpha});
    edit_model([&](Document& document) {
      document.json["materials"][0].update({{"alphaMode", mode}, {"alphaCutoff", cutoff}});
    });
  };
  write_mode("OPAQUE", 0.4, 0.5);
  expect_warnings(job_at(0, 0, 0), {});
  write_mode("BLEND", 0.4, 0.5);
  expect_warnings(job_at(0, 0, 0), {"base_color_factor_fades"});
  write_mode("MASK", 0.4, 0.5);
  expect_warnings(job_at(0, 0, 0), {"base_color_factor_fades"});
  write_mode("MASK", 0.4, 0.3);
  expect_warnings(job_at(0, 0, 0), {});
  // Without a texture the factor goes into the one that is made, and the decal over it.
  write_mode("BLEND", 0.4, 0.5);
  edit_model([](Document& document) {
    document.json["materials"][0]["pbrMetallicRoughness"].erase("baseColorTexture");
  });
  expect_warnings(job_at(0, 0, 0), {});
  const Image texture = texture_of(output(), "Sheet");
  EXPECT_EQ(texture.pixel(texture.width * 2 / 5, texture.height * 2 / 5)[3], 65535) << "opaque";
}

TEST_F(Tints, LayersThatAnUnlitMaterialHasNoUseForAreWarnedOf) {
  edit_model([](Document& document) {
    document.json["materials"][0]["extensions"]["KHR_materials_unlit"] = Json::object();
    declare_extension(document, "KHR_materials_unlit");
  });
  expect_warnings(job_at(0, 0, 0), {});
  json job = job_at(0, 0, 0);
  job["decals"][0]["layers"] = {{"roughness", 0.5}};
  expect_warnings(job, {"unlit_layers"});
  job["decals"][0]["output"] = "overlay";
  expect_warnings(job, {});
}

TEST_F(Tints, AColourThatSomeViewersTakeElsewhereIsWarnedOf) {
  edit_model([](Document& document) {
    document.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"] =
        texture_info(document);
    declare_extension(document, "KHR_materials_pbrSpecularGlossiness");
  });
  expect_warnings(job_at(0, 0, 0), {"specular_glossiness"});
  json job = job_at(0, 0, 0);
  job["decals"][0]["layers"] = {{"baseColor", false}, {"emissive", {0, 1, 0}}};
  expect_warnings(job, {});
  job = job_at(0, 0, 0);
  job["decals"][0]["output"] = "overlay";
  expect_warnings(job, {});
}

}  // namespace
}  // namespace applique
