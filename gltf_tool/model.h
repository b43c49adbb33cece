#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/image/image.h"
#include "applique/surface/divided_surface.h"
#include "applique/surface/surface_mesh.h"
#include "applique/transfer/transfer.h"

#include "document.h"

namespace applique {

/// A vertex's tangent in scene space, unit, and the sign by which the normal's cross product with it is the
/// bitangent.
struct Tangent {
  Vec3 direction;
  double sign;
};

/// The triangles of one primitive under one node, in scene space at the rest pose (node transforms, the
/// skin's joints at their own transforms, the morph targets' default weights).
struct ModelPart {
  std::size_t node = 0;       ///< Index in the document.
  std::size_t mesh = 0;       ///< Index in the document.
  std::size_t primitive = 0;  ///< Index in the mesh.
  std::optional<std::size_t> material;
  std::vector<Vec3> positions;             ///< Scene space, one per glTF vertex.
  std::vector<Vec3> normals;               ///< Unit; from the file, or smooth ones where it has none.
  std::vector<std::array<double, 2>> uvs;  ///< Of the base-colour texture, KHR_texture_transform applied, in
                                           ///< texture space [0,1] before wrapping. Empty: no UVs.
  /// TEXCOORD_n as stored, by n: the sets of the material's other textures, those of its extensions too, that
  /// are not mapped as the base colour is.
  std::map<std::size_t, std::vector<std::array<double, 2>>> other_uvs;
  std::vector<Tangent> tangents;  ///< From the file; empty: none, and MikkTSpace's are meant.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Lists, strips and fans alike, in drawing order;
                                                        ///< winding seen from outside.
  std::vector<char> tinted;  ///< By vertex: its colour (COLOR_0) is not white. Empty: there are no colours.
  bool mirrored =
      false;          ///< The node mirrors: corners 1 and 2 of each triangle are exchanged against the file.
  bool flat = false;  ///< The file has no normals: viewers show each triangle with its own.
};

/// The unit normal by which viewers shade a corner of a part's triangle.
Vec3 shading_normal(const ModelPart& part, std::size_t triangle, std::size_t corner);

/// How a material shows its base colour.
struct ModelMaterial {
  std::string name;
  std::array<double, 4> base_colour_factor = {1, 1, 1, 1};
  std::optional<std::size_t> texture;  ///< Document texture index of the base colour.
  std::optional<std::size_t> image;    ///< Document image index behind it.
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  std::string alpha_mode = "OPAQUE";
  double alpha_cutoff = 0.5;
  bool double_sided = false;
};

/// A glTF model, decoded: what the default scene shows.
struct Model {
  Document document;
  std::vector<ModelPart> parts;
  std::vector<ModelMaterial> materials;  ///< By document index.
  Vec3 lower = Vec3::Zero();             ///< Bounding box of the parts.
  Vec3 upper = Vec3::Zero();
  std::vector<Warning> warnings;

  [[nodiscard]] double diagonal() const { return (upper - lower).norm(); }
};

/// Reads a .glb or .gltf with its files; images that are not there are warned of (file_missing). Errors:
/// file_unreadable, model_invalid (names the accessor, node, …), model_unsupported (names the extension or
/// format and what to do).
Result<Model> load_model(const std::filesystem::path& path);

/// The same for a document in memory (an edited one, say).
Result<Model> decode_model(Document document);

/// Area-weighted vertex normals of any length, smooth across vertices at one position.
std::vector<Vec3> smooth_normals(std::span<const Vec3> positions,
                                 std::span<const std::array<std::uint32_t, 3>> triangles);

/// Decodes an image of the document. Errors as read_image's, naming the image.
Result<Image> load_model_image(const Model& model, std::size_t image);

/// The same for a document that is not decoded as a model.
Result<Image> load_document_image(const Document& document, std::size_t image);

/// Width and height of an image of the document, without its pixels; also where these cannot be decoded
/// (KTX2, DDS). Errors: as load_model_image's, of the image's header.
Result<std::array<int, 2>> document_image_size(const Document& document, std::size_t image);

/// The surface that a decal may use: parts welded together, and where each surface face came from.
struct ModelSurface {
  SurfaceMesh mesh;
  struct Source {
    std::uint32_t part;      ///< Index in Model::parts.
    std::uint32_t triangle;  ///< Index in its triangles.
  };
  std::vector<Source> sources;  ///< By SurfaceMesh::source.
  /// By face: where its corners are in its source triangle. Empty: faces are whole triangles.
  IdVector<FaceId, FaceCorners> corners;

  [[nodiscard]] const Source& source(FaceId f) const { return sources[mesh.source[f]]; }
  /// Where the face's corners are in its source triangle.
  [[nodiscard]] const FaceCorners& corners_in_source(FaceId f) const {
    return corners.empty() ? whole_face : corners[f];
  }
  /// Whether the face is all of its source triangle.
  [[nodiscard]] bool is_whole(FaceId f) const { return corners_in_source(f) == whole_face; }
};

/// A place in a triangle, from what its corners have: values(k) for corner k.
template <class Values>
auto blend(const std::array<double, 3>& weights, const Values& values) {
  using Value = std::decay_t<decltype(values(0))>;
  return Value(weights[0] * values(0) + weights[1] * values(1) + weights[2] * values(2));
}

/// The texels of a face whose source triangle has these.
std::array<Texel, 3> texels_inside(const std::array<Texel, 3>& triangle, const FaceCorners& corners);

/// The surface with the triangles cut as for a decal.
ModelSurface divided_surface(const ModelSurface& surface, const DividedSurface& divided);

/// Welds the parts whose node and material are allowed; an empty list allows all. Names that match nothing
/// are an error of the caller's to check first.
ModelSurface build_surface(const Model& model, const std::vector<std::size_t>& nodes = {},
                           const std::vector<std::size_t>& materials = {});

}  // namespace applique
