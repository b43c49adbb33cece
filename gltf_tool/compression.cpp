#include "compression.h"

#include <array>
#include <cstring>

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

namespace applique {
namespace {

using Json = Document::Json;

/// First byte of attributes in KHR_meshopt_compression's newer codec.
constexpr std::uint8_t attribute_codec_1 = 0xa1;

std::span<const std::uint8_t> bytes_of(const Buffers& buffers, const Json& range) {
  const auto bytes = buffers.bytes[range["buffer"].get<std::size_t>()];
  const std::size_t offset = index_of(range, "byteOffset").value_or(0);
  const std::size_t length = range["byteLength"].get<std::size_t>();
  if (offset > bytes.size() || length > bytes.size() - offset) return {};
  return bytes.subspan(offset, length);
}

template <class T>
bool copy_attribute(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                    std::vector<std::uint8_t>& out) {
  const auto components = static_cast<std::size_t>(attribute.num_components());
  out.resize(mesh.num_points() * components * sizeof(T));
  std::array<T, 4> values = {};
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    const auto value = attribute.mapped_index(i);
    if (value.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<T>(value, attribute.num_components(), values.data())) return false;
    std::memcpy(out.data() + i.value() * components * sizeof(T), values.data(), components * sizeof(T));
  }
  return true;
}

bool copy_attribute(std::size_t component_type, const draco::Mesh& mesh,
                    const draco::PointAttribute& attribute, std::vector<std::uint8_t>& out) {
  switch (component_type) {
    case 5120:
      return copy_attribute<std::int8_t>(mesh, attribute, out);
    case 5121:
      return copy_attribute<std::uint8_t>(mesh, attribute, out);
    case 5122:
      return copy_attribute<std::int16_t>(mesh, attribute, out);
    case 5123:
      return copy_attribute<std::uint16_t>(mesh, attribute, out);
    case 5125:
      return copy_attribute<std::uint32_t>(mesh, attribute, out);
    default:
      return copy_attribute<float>(mesh, attribute, out);
  }
}

}  // namespace

std::size_t component_bytes(std::size_t component_type) {
  return component_type <= 5121 ? 1 : component_type <= 5123 ? 2 : 4;
}

int component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "MAT3") return 9;
  return type == "MAT4" ? 16 : 4;
}

Result<DracoPrimitive> decode_draco(const Document& document, const Buffers& buffers, const Json& primitive,
                                    const std::string& where) {
  const auto invalid = [&](const std::string& what) {
    return fail(ErrorCode::model_invalid, fmt::format("{}: its Draco data {}", where, what));
  };
  const auto& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
  const auto bytes =
      bytes_of(buffers, document.json["bufferViews"][extension["bufferView"].get<std::size_t>()]);
  draco::DecoderBuffer input;
  input.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&input);
  if (!decoded.ok())
    return invalid(fmt::format("cannot be decoded: {}", decoded.status().error_msg_string()));
  const draco::Mesh& mesh = *decoded.value();

  DracoPrimitive result;
  result.vertices = mesh.num_points();
  result.indices.reserve(3 * static_cast<std::size_t>(mesh.num_faces()));
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const auto& corner : mesh.face(f)) {
      if (corner.value() >= mesh.num_points())
        return invalid("has a triangle with a vertex that is not there");
      result.indices.push_back(corner.value());
    }
  for (const auto& item : extension["attributes"].items()) {
    const std::string& name = item.key();
    const auto accessor = index_of(primitive["attributes"], name.c_str());
    if (!accessor)
      return invalid(fmt::format("names the attribute {}, which the primitive does not have", name));
    const auto& entry = document.json["accessors"][*accessor];
    const auto* attribute =
        as_index(item.value()) ? mesh.GetAttributeByUniqueId(item.value().get<std::uint32_t>()) : nullptr;
    if (attribute == nullptr)
      return invalid(fmt::format("has no attribute {} for {}", item.value().dump(), name));
    if (attribute->num_components() != component_count(entry["type"].get<std::string>()) ||
        attribute->num_components() > 4)
      return invalid(fmt::format("has {} components for {}, whose accessor is {}",
                                 attribute->num_components(), name, entry["type"].get<std::string>()));
    if (!copy_attribute(entry["componentType"].get<std::size_t>(), mesh, *attribute, result.attributes[name]))
      return invalid(fmt::format("cannot be converted for {}", name));
  }
  return result;
}

Result<std::vector<std::uint8_t>> decode_meshopt(const Buffers& buffers, const Json& compression,
                                                 const std::string& where) {
  const auto invalid = [&](const std::string& what) {
    return fail(ErrorCode::model_invalid, fmt::format("{}: its meshopt data {}", where, what));
  };
  const auto input = bytes_of(buffers, compression);
  const std::size_t count = compression["count"].get<std::size_t>();
  const std::size_t stride = compression["byteStride"].get<std::size_t>();
  const auto* mode = find(compression, {"mode"});
  const std::string mode_name = mode != nullptr ? mode->get<std::string>() : "";
  // No stream of the codec expands 256-fold: a larger count is a lie that would only cost memory.
  if (stride > 256 || count > (input.size() + 64) * 256 / stride)
    return invalid("says more elements than it can hold");
  if (mode_name == "ATTRIBUTES" && !input.empty() && input[0] == attribute_codec_1)
    return fail(
        ErrorCode::model_unsupported,
        fmt::format("{}: its meshopt data are of version 1 of the attribute codec, which is not read; "
                    "compress the model by EXT_meshopt_compression (version 0), or not at all",
                    where));
  const auto* filter = find(compression, {"filter"});
  const std::string filter_name = filter != nullptr ? filter->get<std::string>() : "NONE";
  if (filter_name == "COLOR") return std::vector<std::uint8_t>();
  std::vector<std::uint8_t> output(count * stride);
  int status = 1;
  if (mode_name == "ATTRIBUTES" && stride % 4 == 0) {
    status = meshopt_decodeVertexBuffer(output.data(), count, stride, input.data(), input.size());
  } else if (mode_name == "TRIANGLES" && (stride == 2 || stride == 4) && count % 3 == 0) {
    status = meshopt_decodeIndexBuffer(output.data(), count, stride, input.data(), input.size());
  } else if (mode_name == "INDICES" && (stride == 2 || stride == 4)) {
    status = meshopt_decodeIndexSequence(output.data(), count, stride, input.data(), input.size());
  } else {
    return invalid(fmt::format("has mode '{}' with a stride of {}", mode_name, stride));
  }
  if (status != 0) return invalid(fmt::format("cannot be decoded (status {})", status));
  if (filter_name == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(output.data(), count, stride);
  } else if (filter_name == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(output.data(), count, stride);
  } else if (filter_name == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(output.data(), count, stride);
  } else if (filter_name != "NONE") {
    return invalid(fmt::format("has filter '{}' with a stride of {}", filter_name, stride));
  }
  return output;
}

}  // namespace applique
