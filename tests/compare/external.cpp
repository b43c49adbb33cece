#include "compare/external.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include <fmt/format.h>

#include "applique/embed/align.h"
#include "applique/surface/surface_query.h"

#include "compare/pins.h"

namespace applique::compare {
namespace {

constexpr double matching_distance = 1e-5;  // of the patch's extent: files have floats

double extent_of(const std::vector<Vec3>& positions) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions) box.extend(p);
  return box.diagonal().norm();
}

/// The surface vertex at each position of the file.
Result<std::vector<VertexId>> match_vertices(const SurfaceMesh& mesh, const std::vector<Vec3>& positions) {
  const SurfaceQuery query(mesh);
  const double tolerance = matching_distance * extent_of(positions);
  std::vector<VertexId> matched;
  for (const Vec3& position : positions) {
    const SurfacePoint point = query.nearest(position);
    const auto heaviest = std::max_element(point.barycentric.begin(), point.barycentric.end());
    const VertexId v = mesh.faces[point.face][static_cast<std::size_t>(heaviest - point.barycentric.begin())];
    const double distance = (mesh.positions[v] - position).norm();
    if (distance > tolerance)
      return fail(ErrorCode::model_invalid,
                  fmt::format("vertex {} is {:.2g} away from the nearest vertex of the surface: the program "
                              "must keep the exported positions",
                              matched.size(), distance));
    matched.push_back(v);
  }
  return matched;
}

/// The face at `corners[0]` with these corners in this order or turned; invalid when there is none.
FaceId face_with(const SurfaceMesh& mesh, const std::array<VertexId, 3>& corners) {
  FaceId found;
  for_each_face(mesh, corners[0], [&](FaceId f) {
    if (std::is_permutation(corners.begin(), corners.end(), mesh.faces[f].begin())) found = f;
  });
  return found;
}

/// A patch whose vertices are told apart by their surface vertex and their texture coordinates.
class SeamedPatch {
 public:
  PatchVertexId vertex(VertexId over, const std::array<double, 2>& uv) {
    const auto [entry, is_new] = vertices_.try_emplace({over, uv}, PatchVertexId(image_.size()));
    if (is_new) {
      patch_.vertices.push_back(over);
      image_.push_back({uv[0], -uv[1]});
    }
    return entry->second;
  }
  void add_face(FaceId f, const std::array<PatchVertexId, 3>& corners) {
    const PatchFaceId q = patch_.faces.push_back({f, corners, {}});
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchVertexId a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
      if (const auto across = sides_.find({b, a}); across != sides_.end()) {
        patch_.faces[q].neighbours[k] = across->second.face;
        patch_.faces[across->second.face].neighbours[across->second.edge] = q;
      }
      sides_[{a, b}] = {q, k};
    }
  }
  /// The patch, and its texture coordinates with v up.
  DecalMap map() && {
    DecalMap map;
    map.patch = std::move(patch_);
    map.image = std::move(image_);
    return map;
  }

 private:
  struct Side {
    PatchFaceId face;
    std::size_t edge;
  };
  Patch patch_;
  IdVector<PatchVertexId, Vec2> image_;
  std::map<std::pair<VertexId, std::array<double, 2>>, PatchVertexId> vertices_;
  std::map<std::pair<PatchVertexId, PatchVertexId>, Side> sides_;
};

Result<DecalMap> lay_out(const SurfaceMesh& mesh, const PatchFile& file) {
  APPLIQUE_TRY(const std::vector<VertexId> over, match_vertices(mesh, file.positions));
  SeamedPatch patch;
  for (const auto& triangle : file.triangles) {
    const FaceId f = face_with(mesh, {over[triangle[0]], over[triangle[1]], over[triangle[2]]});
    if (!f.valid())
      return fail(ErrorCode::model_invalid,
                  fmt::format("the triangle of the vertices {}, {} and {} is not a face of the surface: the "
                              "program must keep the exported triangles",
                              triangle[0], triangle[1], triangle[2]));
    std::array<PatchVertexId, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = std::find_if(triangle.begin(), triangle.end(),
                                       [&](std::uint32_t i) { return over[i] == mesh.faces[f][k]; });
      corners[k] = patch.vertex(mesh.faces[f][k], file.uvs[*corner]);
    }
    patch.add_face(f, corners);
  }
  DecalMap map = std::move(patch).map();
  map.plane = map.image;
  map.linear.resize(map.patch.faces.size(), 1);
  map.depth.resize(map.patch.faces.size(), 0);
  map.sheet.resize(map.patch.faces.size(), 0);
  map.influence.assign(map.patch.vertices.size(), 1);
  return map;
}

/// Takes the first of `from` exactly to the first of `to`, the others as near as it can.
Similarity fit_about_first(std::span<const Vec2> from, std::span<const Vec2> to) {
  Vec2 product = 0;
  double norm = 0;
  for (std::size_t k = 1; k < from.size(); ++k) {
    product += std::conj(from[k] - from[0]) * (to[k] - to[0]);
    norm += std::norm(from[k] - from[0]);
  }
  const Vec2 scale = product / norm;
  return {scale, to[0] - scale * from[0]};
}

/// Where the coordinates have the pins, and where those belong; with one pin, also the vertices, where `ours`
/// has them.
Result<Similarity> align(const DecalInput& input, const DecalMap& ours, const DecalMap& external) {
  std::vector<Vec2> from, to;
  for (const Feature& feature : input.features) {
    const Vec2 target = input.region.frame().to_plane(feature.image);
    const auto at = image_of(external, feature.surface, target);
    if (!at)
      return fail(ErrorCode::model_invalid,
                  fmt::format("pin {} lies on a face that the file does not have", from.size()));
    from.push_back(*at);
    to.push_back(target);
  }
  if (from.size() == 1) {
    std::map<VertexId, Vec2> our_image;
    for (const PatchVertexId v : ids<PatchVertexId>(ours.patch.vertices.size()))
      our_image[ours.patch.vertices[v]] = ours.image[v];
    for (const PatchVertexId v : ids<PatchVertexId>(external.patch.vertices.size())) {
      const auto found = our_image.find(external.patch.vertices[v]);
      if (found == our_image.end()) continue;
      from.push_back(external.image[v]);
      to.push_back(found->second);
    }
  }
  return fit_about_first(from, to);
}

void measure(const Site& site, const DecalInput& input, DecalMap& map) {
  for (const PatchFace& face : map.patch.faces) {
    const auto& v = face.vertices;
    map.textured.push_back(input.region.meets_triangle(map.image[v[0]], map.image[v[1]], map.image[v[2]]));
  }
  map.quality =
      measure_quality(site.mesh, map.patch, map.plane, map.image, map.textured, map.warp, input.region);
  for (const Feature& feature : input.features) {
    const Vec2 target = input.region.frame().to_plane(feature.image);
    map.quality.feature_residual.push_back(std::abs(*image_of(map, feature.surface, target) - target) *
                                           input.region.frame().pixels_per_unit());
  }
  map.status = Coverage::covered;
}

}  // namespace

Result<DecalMap> external_map(const Site& site, const DecalInput& input, const DecalMap& ours,
                              const PatchFile& file) {
  APPLIQUE_TRY(DecalMap map, lay_out(site.mesh, file));
  APPLIQUE_TRY(const Similarity similarity, align(input, ours, map));
  for (Vec2& z : map.image) z = similarity(z);
  map.plane = map.image;
  measure(site, input, map);
  return map;
}

Result<Row> measure_external(const Comparison& comparison, const std::string& method,
                             const std::filesystem::path& file) {
  APPLIQUE_TRY(const PatchFile patch, read_patch(file));
  const Case* found = comparison.find(patch.name);
  if (found == nullptr)
    return fail(ErrorCode::option_invalid,
                fmt::format("{}: its node is named '{}', which is no case of this comparison; export a case "
                            "with --export and keep the node's name",
                            file.string(), patch.name));
  if (!found->input) return tl::unexpected(found->input.error());
  const Site& site = comparison.sites[found->site];
  APPLIQUE_TRY(const DecalMap ours, solve_decal(site.mesh, *found->input));
  auto map = external_map(site, *found->input, ours, patch);
  if (!map) return fail(map.error().code, fmt::format("{}: {}", file.string(), map.error().message));
  Row row = row_of(found->name, method, *map);
  row.figures->seconds.reset();
  row.map = std::move(*map);
  return row;
}

}  // namespace applique::compare
