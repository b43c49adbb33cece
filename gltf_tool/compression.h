#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "applique/base/error.h"

#include "document.h"

namespace applique {

/// A Draco-compressed primitive, decoded.
struct DracoPrimitive {
  std::size_t vertices = 0;
  std::vector<std::uint32_t> indices;  ///< A triangle list.
  std::map<std::string, std::vector<std::uint8_t>>
      attributes;  ///< Tightly packed, in the accessor's own type.
};

/// Decodes the KHR_draco_mesh_compression extension of a primitive (§"Decoding procedure" of the extension).
/// `where` names the primitive in errors (model_invalid).
Result<DracoPrimitive> decode_draco(const Document& document, const Buffers& buffers,
                                    const Document::Json& primitive, const std::string& where);

/// Decodes a buffer view compressed with EXT_meshopt_compression or KHR_meshopt_compression; `compression` is
/// the extension object, `where` names the view in errors (model_invalid; model_unsupported for version 1 of
/// the attribute codec). Colours behind the filter COLOR stay undecoded, and the result is empty: nothing
/// here needs them.
Result<std::vector<std::uint8_t>> decode_meshopt(const Buffers& buffers, const Document::Json& compression,
                                                 const std::string& where);

/// Bytes of a component (5120 … 5126) and components of an element ("VEC3"), of a checked accessor.
std::size_t component_bytes(std::size_t component_type);
int component_count(const std::string& type);

}  // namespace applique
