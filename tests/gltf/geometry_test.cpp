// Geometry in every form that glTF and its extensions store it: what is decoded, and that it stays as it was.

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "edit.h"
#include "gltf/test_models.h"
#include "model.h"
#include "overlay.h"
#include "save_document.h"

namespace applique {
namespace {

using Json = Document::Json;
using Bytes = std::vector<std::uint8_t>;

std::size_t bytes_of(int component_type) {
  return component_type <= 5121 ? 1 : component_type <= 5123 ? 2 : 4;
}

/// A document under construction: accessors over values of any component type, one triangle mesh.
struct Builder {
  Document document;

  Builder() {
    document.json = {{"asset", {{"version", "2.0"}}},
                     {"nodes", Json::array({{{"mesh", 0}}})},
                     {"extensionsUsed", {"KHR_mesh_quantization"}}};
    document.name = "made.glb";
    document.json["buffers"] = Json::array({{{"byteLength", 0}}});
    document.chunk_buffer = 0;
  }

  static void put(Bytes& bytes, double value, int component_type) {
    const auto add = [&](auto number) {
      const auto* first = reinterpret_cast<const std::uint8_t*>(&number);
      bytes.insert(bytes.end(), first, first + sizeof number);
    };
    switch (component_type) {
      case 5120:
        return add(static_cast<std::int8_t>(std::lround(value)));
      case 5121:
        return add(static_cast<std::uint8_t>(std::lround(value)));
      case 5122:
        return add(static_cast<std::int16_t>(std::lround(value)));
      case 5123:
        return add(static_cast<std::uint16_t>(std::lround(value)));
      case 5125:
        return add(static_cast<std::uint32_t>(std::lround(value)));
      default:
        return add(static_cast<float>(value));
    }
  }

  std::size_t add_view(const Bytes& bytes, std::size_t stride = 0) {
    auto& chunk = document.binary_chunk;
    chunk.resize((chunk.size() + 7) / 8 * 8);
    Json view = {{"buffer", 0}, {"byteOffset", chunk.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    chunk.insert(chunk.end(), bytes.begin(), bytes.end());
    document.json["buffers"][0]["byteLength"] = chunk.size();
    document.json["bufferViews"].push_back(view);
    return document.json["bufferViews"].size() - 1;
  }

  /// Rows as they are stored; elements of attributes begin on multiples of 4.
  std::size_t add_accessor(const std::vector<std::vector<double>>& rows, int component_type,
                           bool normalized) {
    static constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    Bytes bytes;
    const std::size_t width = rows[0].size(), element = width * bytes_of(component_type);
    const std::size_t stride = width == 1 ? element : (element + 3) / 4 * 4;
    for (const auto& row : rows) {
      for (const double value : row) put(bytes, value, component_type);
      bytes.resize((bytes.size() + stride - 1) / stride * stride, 0xee);
    }
    Json accessor = {{"bufferView", add_view(bytes, width == 1 ? 0 : stride)},
                     {"componentType", component_type},
                     {"count", rows.size()},
                     {"type", types[width - 1]}};
    if (normalized) accessor["normalized"] = true;
    document.json["accessors"].push_back(accessor);
    return document.json["accessors"].size() - 1;
  }

  void set_primitives(Json primitives) {
    document.json["meshes"] = Json::array({{{"primitives", primitives}}});
  }

  [[nodiscard]] Model decode() const {
    auto model = decode_model(document);
    EXPECT_TRUE(model) << model.error().message;
    return model ? std::move(*model) : Model();
  }
};

/// A unit square as a strip, at z = 0.
const std::vector<std::array<double, 2>> square = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};

std::vector<std::vector<double>> square_rows(double scale, bool with_z) {
  std::vector<std::vector<double>> rows;
  for (const auto& [x, y] : square) {
    rows.push_back({scale * x, scale * y});
    if (with_z) rows.back().push_back(0);
  }
  return rows;
}

TEST(Geometry, ReadsEveryComponentTypeOfAttributesAndIndices) {
  struct Stored {
    int type;
    bool normalized;
    double one;  ///< What 1 is stored as.
  };
  const std::vector<Stored> kinds = {{5126, false, 1},    {5120, true, 127},   {5121, true, 255},
                                     {5122, true, 32767}, {5123, true, 65535}, {5120, false, 1},
                                     {5121, false, 1},    {5122, false, 1},    {5123, false, 1}};
  for (const Stored& position : kinds)
    for (const Stored& uv : kinds)
      for (const int index : {5121, 5123, 5125}) {
        Builder made;
        Json attributes;
        attributes["POSITION"] =
            made.add_accessor(square_rows(position.one, true), position.type, position.normalized);
        attributes["TEXCOORD_0"] = made.add_accessor(square_rows(uv.one, false), uv.type, uv.normalized);
        Json primitive = {{"attributes", attributes}};
        primitive["indices"] = made.add_accessor({{0}, {1}, {2}, {2}, {1}, {3}}, index, false);
        made.set_primitives({primitive});
        SCOPED_TRACE(made.document.json["accessors"].dump());
        const Model model = made.decode();
        ASSERT_EQ(model.parts.size(), 1u);
        const ModelPart& part = model.parts[0];
        EXPECT_EQ(part.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 1, 3}}));
        for (std::size_t i = 0; i < square.size(); ++i) {
          EXPECT_LT((part.positions[i] - Vec3(square[i][0], square[i][1], 0)).norm(), 1e-12);
          EXPECT_EQ(part.uvs[i], square[i]);
        }
      }
}

TEST(Geometry, FillsInSparseAccessors) {
  for (const int index : {5121, 5123, 5125})
    for (const bool with_base : {true, false}) {
      Builder made;
      Json attributes;
      attributes["POSITION"] = made.add_accessor(square_rows(1, true), 5126, false);
      made.set_primitives({Json{{"attributes", attributes}, {"mode", 5}}});
      Bytes indices, values;
      Builder::put(indices, 1, index);
      Builder::put(indices, 3, index);
      for (const double x : {1, 0, 5, 1, 1, 5}) Builder::put(values, x, 5126);
      auto& accessor = made.document.json["accessors"][0];
      if (!with_base) accessor.erase("bufferView");
      const std::size_t at = made.add_view(indices), from = made.add_view(values);
      accessor["sparse"] = {{"count", 2},
                            {"indices", {{"bufferView", at}, {"componentType", index}}},
                            {"values", {{"bufferView", from}}}};
      const ModelPart part = made.decode().parts.at(0);
      EXPECT_EQ(part.positions[0], Vec3(0, 0, 0));
      EXPECT_EQ(part.positions[1], Vec3(1, 0, 5));
      EXPECT_EQ(part.positions[2], with_base ? Vec3(0, 1, 0) : Vec3(0, 0, 0));
      EXPECT_EQ(part.positions[3], Vec3(1, 1, 5));
    }
}

TEST(Geometry, StripsFansAndListsAreOneSquare) {
  // The square's corners in the order that each mode wants.
  struct Case {
    int mode;
    std::vector<std::vector<double>> order;
  };
  for (const Case& test : {Case{4, {{0}, {1}, {2}, {2}, {1}, {3}}}, Case{5, {{0}, {1}, {2}, {3}}},
                           Case{6, {{0}, {1}, {3}, {2}}}})
    for (const bool indexed : {true, false}) {
      Builder made;
      Json primitive = {{"mode", test.mode}};
      if (indexed) {
        primitive["attributes"]["POSITION"] = made.add_accessor(square_rows(1, true), 5126, false);
        primitive["indices"] = made.add_accessor(test.order, 5123, false);
      } else {
        std::vector<std::vector<double>> corners;
        for (const auto& corner : test.order)
          corners.push_back(square_rows(1, true)[static_cast<std::size_t>(corner[0])]);
        primitive["attributes"]["POSITION"] = made.add_accessor(corners, 5126, false);
      }
      made.set_primitives({primitive});
      const Model model = made.decode();
      double area = 0;
      for (const auto& t : model.parts.at(0).triangles) {
        const auto& p = model.parts[0].positions;
        area += 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).z();
      }
      EXPECT_EQ(area, 1) << "mode " << test.mode << ": both triangles face +z";
      EXPECT_EQ(build_surface(model).mesh.positions.size(), 4u);
    }
}

TEST(Geometry, PointsAndLinesAreLeftAlone) {
  Builder made;
  const std::size_t positions = made.add_accessor(square_rows(1, true), 5126, false);
  const std::size_t uvs = made.add_accessor(square_rows(1, false), 5126, false);
  Json primitives = Json::array();
  for (const int mode : {0, 1, 2, 3, 5})
    primitives.push_back(
        {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"mode", mode}, {"material", 0}});
  made.set_primitives(primitives);
  made.document.json["materials"] = Json::array({{{"name", "all"}}});
  const Model model = made.decode();
  ASSERT_EQ(model.parts.size(), 1u);
  EXPECT_EQ(model.parts[0].primitive, 4u);
  Document document = model.document;
  const auto materials = isolate_materials(document, std::vector<PartKey>{{0, 0, 4}});
  set_slot_image(document, materials[0], MaterialSlot::base_color, make_png(8, {0, 0, 0, 0xffff}));
  const TemporaryFolder folder;
  ASSERT_TRUE(save_document(document, folder / "out.glb"));
  const Model after = load_model(folder / "out.glb").value();
  for (std::size_t p = 0; p < 4; ++p)
    EXPECT_EQ(after.document.json["meshes"][0]["primitives"][p], primitives[p]);
  EXPECT_EQ(after.document.json["materials"][0], model.document.json["materials"][0]);
  EXPECT_TRUE(after.materials.at(materials[0]).image);
}

/// The square with every view compressed.
Builder make_meshopt_square(const char* extension, const char* filter = nullptr) {
  Builder made;
  const std::size_t vertices = square.size();
  std::vector<std::uint16_t> positions;
  for (const auto& [x, y] : square)
    positions.insert(positions.end(), {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), 0, 0});
  Bytes packed(meshopt_encodeVertexBufferBound(vertices, 8));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), vertices, 8));
  const std::array<std::uint32_t, 6> corners = {0, 1, 2, 2, 1, 3};
  Bytes packed_corners(meshopt_encodeIndexBufferBound(corners.size(), vertices));
  packed_corners.resize(meshopt_encodeIndexBuffer(packed_corners.data(), packed_corners.size(),
                                                  corners.data(), corners.size()));
  Json attributes;
  attributes["POSITION"] = made.add_accessor(square_rows(1, true), 5123, false);
  Json primitive = {{"attributes", attributes}};
  primitive["indices"] = made.add_accessor({{0}, {1}, {2}, {2}, {1}, {3}}, 5125, false);
  made.set_primitives({primitive});
  // The views themselves lie in a buffer that has no bytes.
  auto& root = made.document.json;
  made.document.binary_chunk.clear();
  const auto compress = [&](std::size_t view, const Bytes& bytes, std::size_t count, std::size_t stride,
                            const char* mode) {
    auto& chunk = made.document.binary_chunk;
    chunk.resize((chunk.size() + 3) / 4 * 4);
    root["bufferViews"][view]["buffer"] = 1;
    root["bufferViews"][view]["extensions"][extension] = {{"buffer", 0},
                                                          {"byteOffset", chunk.size()},
                                                          {"byteLength", bytes.size()},
                                                          {"byteStride", stride},
                                                          {"count", count},
                                                          {"mode", mode}};
    chunk.insert(chunk.end(), bytes.begin(), bytes.end());
  };
  compress(0, packed, vertices, 8, "ATTRIBUTES");
  compress(1, packed_corners, corners.size(), 4, "TRIANGLES");
  if (filter != nullptr) root["bufferViews"][0]["extensions"][extension]["filter"] = filter;
  root["buffers"] = Json::array({{{"byteLength", made.document.binary_chunk.size()}}, {{"byteLength", 64}}});
  root["buffers"][1]["extensions"][extension] = {{"fallback", true}};
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    root[list] = {"KHR_mesh_quantization", extension};
  return made;
}

TEST(Geometry, MeshoptIsReadUnderBothNames) {
  for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const Model model = make_meshopt_square(extension).decode();
    EXPECT_EQ(model.parts.at(0).positions.at(3), Vec3(1, 1, 0)) << extension;
    EXPECT_EQ(model.parts.at(0).triangles.size(), 2u);
  }
  if (test_data().empty()) return;
  const auto khr = load_model(test_data() / "gltf/meshopt_nofallback_khr/meshopt-no-fallback.gltf");
  ASSERT_TRUE(khr) << khr.error().message;
  EXPECT_EQ(khr->parts.size(), 2u);
}

TEST(Geometry, TheNewerMeshoptCodecIsNamed) {
  Builder made = make_meshopt_square("KHR_meshopt_compression");
  made.document.binary_chunk[0] = 0xa1;
  const auto model = decode_model(made.document);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::model_unsupported);
  EXPECT_EQ(
      model.error().message,
      "'made.glb', buffer view 0: its meshopt data are of version 1 of the attribute codec, which is not "
      "read; compress the model by EXT_meshopt_compression (version 0), or not at all");
  // Colours are not needed.
  const auto coloured = decode_model(make_meshopt_square("KHR_meshopt_compression", "COLOR").document);
  ASSERT_FALSE(coloured) << "these are positions";
  const auto unknown = decode_model(make_meshopt_square("KHR_meshopt_compression", "SEPIA").document);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("filter 'SEPIA'"), std::string::npos) << unknown.error().message;
}

TEST(Geometry, QuantizedSquareInItsPlace) {
  // As gltfpack writes it: integers, and the node that makes them metres.
  Builder made;
  Json attributes;
  attributes["POSITION"] = made.add_accessor(square_rows(16000, true), 5122, false);
  made.set_primitives({Json{{"attributes", attributes}, {"mode", 5}}});
  made.document.json["nodes"][0]["scale"] = {1 / 8000.0, 1 / 8000.0, 1 / 8000.0};
  made.document.json["nodes"][0]["translation"] = {-1, -1, 3};
  const Model model = made.decode();
  EXPECT_LT((model.lower - Vec3(-1, -1, 3)).norm() + (model.upper - Vec3(1, 1, 3)).norm(), 1e-12);
}

Bytes view_bytes(const Document& document, const Json& range) {
  const Buffers buffers = read_buffers(document).value();
  const auto bytes = buffers.bytes[range["buffer"].get<std::size_t>()];
  const auto part =
      bytes.subspan(index_of(range, "byteOffset").value_or(0), range["byteLength"].get<std::size_t>());
  return {part.begin(), part.end()};
}

/// The stored bytes of all geometry: what accessors, Draco and meshopt refer to.
std::vector<Bytes> geometry_of(const Document& document) {
  std::vector<Bytes> list;
  const auto add = [&](std::size_t view) {
    const auto& entry = document.json["bufferViews"][view];
    const Json* range = &entry;
    for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (const auto* compressed = find(entry, {"extensions", extension})) range = compressed;
    list.push_back(view_bytes(document, *range));
  };
  for (const auto& accessor : document.json["accessors"])
    if (const auto view = index_of(accessor, "bufferView")) add(*view);
  for (const auto& mesh : document.json["meshes"])
    for (const auto& primitive : mesh["primitives"])
      if (const auto* draco = find(primitive, {"extensions", "KHR_draco_mesh_compression"}))
        add(draco->at("bufferView").get<std::size_t>());
  return list;
}

TEST(Geometry, CompressedOnesStayByteForByte) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const TemporaryFolder folder;
  for (const char* name :
       {"gltf/LeePerrySmith/LeePerrySmith.glb", "gltf/DenseSphere_quant_draco.glb", "gltf/pirate_meshopt.glb",
        "gltf/meshopt_nofallback_khr/meshopt-no-fallback.gltf", "gltf/SimpleSparseAccessor.gltf"}) {
    SCOPED_TRACE(name);
    const auto model = load_model(test_data() / name);
    ASSERT_TRUE(model) << model.error().message;
    const ModelPart& part = model->parts.front();
    Document document = model->document;
    const auto materials =
        isolate_materials(document, std::vector<PartKey>{{part.node, part.mesh, part.primitive}});
    set_slot_image(document, materials[0], MaterialSlot::base_color,
                   make_png(64, {0, 0x8080, 0x8080, 0xffff}));
    for (const char* output : {"out.glb", "out.gltf"}) {
      ASSERT_TRUE(save_document(document, folder / output));
      const auto again = load_model(folder / output);
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(geometry_of(again->document), geometry_of(model->document));
      EXPECT_EQ(again->parts.front().positions, part.positions);
      EXPECT_EQ(again->parts.front().triangles, part.triangles);
    }
  }
}

}  // namespace
}  // namespace applique
