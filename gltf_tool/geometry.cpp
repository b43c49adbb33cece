#include "geometry.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "compression.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Elements of an accessor without data (all zero but for its sparse entries) cost no bytes in the file, so
/// their number needs a limit of its own.
constexpr std::size_t max_zero_elements = std::size_t{1} << 24;

/// A copy of the geometry's part of the document with one buffer, in which nothing is compressed.
class Preparation {
 public:
  Preparation(const Document& document, const Buffers& buffers) : document_(document), buffers_(buffers) {}

  Result<tinygltf::Model> run() {
    json_ = {{"asset", {{"version", "2.0"}}}};
    for (const char* collection : {"bufferViews", "accessors", "meshes", "nodes", "skins"})
      if (const auto* items = find(document_.json, {collection})) json_[collection] = *items;
    APPLIQUE_CHECK(place_buffer_views());
    if (json_.contains("meshes")) APPLIQUE_CHECK(place_primitives());
    if (json_.contains("accessors"))
      for (auto& accessor : json_["accessors"])
        for (const char* key : {"min", "max", "name", "extensions", "extras"}) accessor.erase(key);
    if (bin_.empty()) bin_.resize(4);
    json_["buffers"] = Json::array({Json{{"byteLength", bin_.size()}}});
    return parse();
  }

 private:
  std::size_t append(std::span<const std::uint8_t> bytes) {
    bin_.resize((bin_.size() + 15) / 16 * 16);
    const std::size_t offset = bin_.size();
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
    return offset;
  }

  Result<void> place_buffer_views() {
    std::vector<std::size_t> start;
    for (const auto& bytes : buffers_.bytes) start.push_back(append(bytes));
    for (std::size_t i = 0; i < count_of(document_, "bufferViews"); ++i) {
      auto& view = json_["bufferViews"][i];
      const std::string where = fmt::format("'{}', buffer view {}", document_.name, i);
      const Json* compressed = find(view, {"extensions", "EXT_meshopt_compression"});
      if (compressed == nullptr) compressed = find(view, {"extensions", "KHR_meshopt_compression"});
      if (compressed != nullptr) {
        APPLIQUE_TRY(const auto bytes, decode_meshopt(buffers_, *compressed, where));
        view["byteOffset"] = append(bytes);
        view["byteLength"] = bytes.size();
      } else {
        const auto buffer = view["buffer"].get<std::size_t>();
        const std::size_t offset = index_of(view, "byteOffset").value_or(0);
        // A buffer without bytes (a compression's fallback) leaves its views empty; reading one is an error.
        if (buffers_.bytes[buffer].empty()) view["byteLength"] = 0;
        view["byteOffset"] = buffers_.bytes[buffer].empty() ? 0 : start[buffer] + offset;
      }
      view["buffer"] = 0;
      for (const char* key : {"extensions", "extras", "name", "target"}) view.erase(key);
    }
    return {};
  }

  Result<void> place_primitives() {
    for (std::size_t m = 0; m < json_["meshes"].size(); ++m) {
      auto& primitives = json_["meshes"][m]["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p) {
        auto& primitive = primitives[p];
        if (find(primitive, {"extensions", "KHR_draco_mesh_compression"}) != nullptr)
          APPLIQUE_CHECK(
              place_draco(primitive, fmt::format("'{}', mesh {}, primitive {}", document_.name, m, p)));
        for (const char* key : {"extensions", "extras", "material"}) primitive.erase(key);
      }
    }
    return {};
  }

  /// Replaces the accessors of a compressed primitive by new ones over the decoded data.
  Result<void> place_draco(Json& primitive, const std::string& where) {
    APPLIQUE_TRY(const DracoPrimitive draco, decode_draco(document_, buffers_, primitive, where));
    for (const auto& [name, bytes] : draco.attributes) {
      Json accessor = json_["accessors"][primitive["attributes"][name].get<std::size_t>()];
      accessor["count"] = draco.vertices;
      primitive["attributes"][name] = add_accessor(std::move(accessor), bytes);
    }
    const auto* first = reinterpret_cast<const std::uint8_t*>(draco.indices.data());
    Json indices = {{"componentType", 5125}, {"type", "SCALAR"}, {"count", draco.indices.size()}};
    primitive["indices"] = add_accessor(std::move(indices), {first, 4 * draco.indices.size()});
    primitive["mode"] = 4;
    return {};
  }

  std::size_t add_accessor(Json accessor, std::span<const std::uint8_t> bytes) {
    accessor.erase("sparse");
    accessor["byteOffset"] = 0;
    accessor["bufferView"] = json_["bufferViews"].size();
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", append(bytes)}, {"byteLength", bytes.size()}});
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  /// Hands the prepared document to tinygltf as a GLB in memory.
  Result<tinygltf::Model> parse() {
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bin_.resize((bin_.size() + 3) / 4 * 4);
    const std::size_t length = 12 + 8 + text.size() + 8 + bin_.size();
    if (length > std::numeric_limits<std::uint32_t>::max())
      return fail(
          ErrorCode::model_unsupported,
          fmt::format("'{}': its geometry has {} bytes; at most 4 GiB are read", document_.name, length));
    std::vector<std::uint8_t> glb(length);
    std::size_t at = 0;
    const auto put = [&](const void* data, std::size_t size) {
      std::memcpy(glb.data() + at, data, size);
      at += size;
    };
    const auto put_u32 = [&](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      put(&word, 4);
    };
    for (const std::size_t word :
         {std::size_t{0x46546C67}, std::size_t{2}, length, text.size(), std::size_t{0x4E4F534A}})
      put_u32(word);
    put(text.data(), text.size());
    put_u32(bin_.size());
    put_u32(0x004E4942);
    put(bin_.data(), bin_.size());

    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error;
    std::string warning;
    if (!loader.LoadBinaryFromMemory(&model, &error, &warning, glb.data(), static_cast<unsigned>(length), "",
                                     tinygltf::NO_REQUIRE)) {
      while (!error.empty() && error.back() == '\n') error.pop_back();
      return fail(ErrorCode::model_invalid, fmt::format("'{}': {}", document_.name, error));
    }
    return model;
  }

  const Document& document_;
  const Buffers& buffers_;
  Json json_;
  std::vector<std::uint8_t> bin_;
};

/// Where elements lie: a checked range of a buffer.
struct Range {
  const std::uint8_t* first = nullptr;
  std::size_t stride = 0;
};

Result<Range> range_of(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
                       std::size_t element, const std::string& what) {
  const auto& view = model.bufferViews[static_cast<std::size_t>(view_index)];
  const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  const std::size_t stride = view.byteStride != 0 ? view.byteStride : element;
  if (stride < element)
    return fail(ErrorCode::model_invalid,
                fmt::format("{}: a stride of {} bytes is less than an element's {}", what, stride, element));
  const bool fits = view.byteOffset <= data.size() && view.byteLength <= data.size() - view.byteOffset &&
                    offset <= view.byteLength && element <= view.byteLength - offset &&
                    count - 1 <= (view.byteLength - offset - element) / stride;
  if (!fits)
    return fail(ErrorCode::model_invalid,
                fmt::format("{}: {} elements of {} bytes lie beyond the end of a buffer view of {} bytes",
                            what, count, element, view.byteLength));
  return Range{data.data() + view.byteOffset + offset, stride};
}

template <class T>
T load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

double load_number(const std::uint8_t* at, int type, bool normalized) {
  switch (type) {
    case 5120:
      return normalized ? std::max(load<std::int8_t>(at) / 127.0, -1.0) : load<std::int8_t>(at);
    case 5121:
      return normalized ? *at / 255.0 : *at;
    case 5122:
      return normalized ? std::max(load<std::int16_t>(at) / 32767.0, -1.0) : load<std::int16_t>(at);
    case 5123:
      return normalized ? load<std::uint16_t>(at) / 65535.0 : load<std::uint16_t>(at);
    case 5125:
      return load<std::uint32_t>(at);
    default:
      return static_cast<double>(load<float>(at));
  }
}

std::uint32_t load_integer(const std::uint8_t* at, int type) {
  if (type == 5121) return *at;
  return type == 5123 ? load<std::uint16_t>(at) : load<std::uint32_t>(at);
}

/// Reads elements with `load`, a function of an address; the sparse entries replace what the buffer view
/// gives.
template <class Value, class Load>
Result<std::vector<Value>> read_elements(const tinygltf::Model& model, int index, int components,
                                         const std::string& what, Load load_value) {
  const auto& accessor = model.accessors[static_cast<std::size_t>(index)];
  const std::string where = fmt::format("{} (accessor {})", what, index);
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)) != components)
    return fail(ErrorCode::model_invalid,
                fmt::format("{}: expected {} components an element", where, components));
  const auto width = static_cast<std::size_t>(components);
  const std::size_t bytes = component_bytes(static_cast<std::size_t>(accessor.componentType));
  std::vector<Value> values;
  const auto read = [&](const Range& range, std::size_t element, Value* out) {
    for (std::size_t c = 0; c < width; ++c)
      out[c] = load_value(range.first + element * range.stride + c * bytes);
  };
  if (accessor.bufferView >= 0) {
    APPLIQUE_TRY(const Range range, range_of(model, accessor.bufferView, accessor.byteOffset, accessor.count,
                                             width * bytes, where));
    values.resize(accessor.count * width);
    for (std::size_t i = 0; i < accessor.count; ++i) read(range, i, &values[i * width]);
  } else if (accessor.count > max_zero_elements) {
    return fail(ErrorCode::model_invalid,
                fmt::format("{}: {} elements without a buffer view", where, accessor.count));
  } else {
    values.resize(accessor.count * width);
  }
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    APPLIQUE_TRY(
        const Range at,
        range_of(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                 component_bytes(static_cast<std::size_t>(sparse.indices.componentType)),
                 where + ", sparse indices"));
    APPLIQUE_TRY(const Range from,
                 range_of(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                          count, width * bytes, where + ", sparse values"));
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t element = load_integer(at.first + i * at.stride, sparse.indices.componentType);
      if (element >= accessor.count)
        return fail(ErrorCode::model_invalid,
                    fmt::format("{}: sparse index {} of {} elements", where, element, accessor.count));
      read(from, i, &values[element * width]);
    }
  }
  return values;
}

}  // namespace

Result<tinygltf::Model> decode_geometry(const Document& document, const Buffers& buffers) {
  return Preparation(document, buffers).run();
}

Result<std::vector<double>> read_accessor(const tinygltf::Model& model, int accessor, int components,
                                          const std::string& what) {
  const auto& entry = model.accessors[static_cast<std::size_t>(accessor)];
  auto values = read_elements<double>(model, accessor, components, what, [&](const std::uint8_t* at) {
    return load_number(at, entry.componentType, entry.normalized);
  });
  if (!values) return values;
  const auto bad = std::find_if(values->begin(), values->end(), [](double x) { return !std::isfinite(x); });
  if (bad != values->end())
    return fail(ErrorCode::model_invalid, fmt::format("{} (accessor {}): element {} is not a finite number",
                                                      what, accessor, (bad - values->begin()) / components));
  return values;
}

Result<std::vector<double>> read_stored(const tinygltf::Model& model, int accessor, int& components,
                                        const std::string& what) {
  const auto& entry = model.accessors[static_cast<std::size_t>(accessor)];
  components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(entry.type));
  return read_elements<double>(model, accessor, components, what, [&](const std::uint8_t* at) {
    return load_number(at, entry.componentType, false);
  });
}

Result<std::vector<std::uint32_t>> read_integers(const tinygltf::Model& model, int accessor, int components,
                                                 const std::string& what) {
  const int type = model.accessors[static_cast<std::size_t>(accessor)].componentType;
  if (type != 5121 && type != 5123 && type != 5125)
    return fail(ErrorCode::model_invalid,
                fmt::format("{} (accessor {}): expected unsigned integers", what, accessor));
  return read_elements<std::uint32_t>(model, accessor, components, what,
                                      [type](const std::uint8_t* at) { return load_integer(at, type); });
}

std::vector<Vec3> to_vectors(const std::vector<double>& values) {
  std::vector<Vec3> vectors(values.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return vectors;
}

}  // namespace applique
