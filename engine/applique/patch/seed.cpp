#include "applique/patch/seed.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "applique/surface/shortest_path.h"

namespace applique {
namespace {

constexpr double short_cut = 2;    // times the usual scale: the way over the surface is not the image's
constexpr double far_share = 0.1;  // of the features' extent: farther apart in the image are two sheets

/// An edge of the tree on the surface, in the order in which it is walked.
struct Strand {
  std::size_t edge;  ///< In the tree.
  std::uint32_t from, to;
  std::vector<VertexId> path;
  std::vector<Vec2> image;  ///< By path vertex: spread along the edge by arc length (§4.3 of the paper).
  double scale;             ///< Plane units per scene unit.
};

/// Breadth first from feature 0: an edge is walked as soon as one of its ends is placed.
tl::expected<std::vector<Strand>, SeedFailure> lay_strands(const SurfaceMesh& mesh,
                                                           std::span<const SeedFeature> features,
                                                           std::span<const FeaturePair> tree) {
  std::vector<Strand> strands;
  std::vector<char> placed(features.size(), false);
  std::vector<std::uint32_t> queue = {0};
  placed[0] = true;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t from = queue[i];
    for (std::size_t e = 0; e < tree.size(); ++e) {
      if (tree[e][0] != from && tree[e][1] != from) continue;
      const std::uint32_t to = tree[e][0] == from ? tree[e][1] : tree[e][0];
      if (placed[to]) continue;
      Strand strand{e, from, to, shortest_path(mesh, features[from].surface, features[to].surface), {}, 0};
      if (strand.path.empty()) return tl::unexpected(SeedFailure{tree[e], false});
      placed[to] = true;
      queue.push_back(to);
      strands.push_back(std::move(strand));
    }
  }
  APPLIQUE_ASSERT(queue.size() == features.size());
  for (Strand& strand : strands) {
    const SeedFeature &from = features[strand.from], &to = features[strand.to];
    Vec3 last = position_of(mesh, from.surface);
    double length = 0;
    std::vector<double> along;
    for (VertexId v : strand.path) {
      length += (mesh.positions[v] - last).norm();
      last = mesh.positions[v];
      along.push_back(length);
    }
    length += (position_of(mesh, to.surface) - last).norm();
    for (const double s : along)
      strand.image.push_back(from.image + (length > 0 ? s / length : 0.0) * (to.image - from.image));
    strand.scale = length > 0 ? std::abs(to.image - from.image) / length : 0;
  }
  return strands;
}

/// Image per surface along the shortest way between two features; infinite where there is none.
double scale_along(const SurfaceMesh& mesh, const SeedFeature& from, const SeedFeature& to) {
  const auto length = way_length(mesh, from.surface, to.surface);
  return length ? std::abs(to.image - from.image) / *length : std::numeric_limits<double>::infinity();
}

/// How many sheets each face near the paths has: as many as there are strands over it that lie far apart in
/// the image. Strands that share a feature are both shortest ways from it, and so are one sheet wherever they
/// meet.
std::unordered_map<FaceId, std::uint32_t> count_sheets(const SurfaceMesh& mesh,
                                                       const std::vector<Strand>& strands, double far) {
  constexpr double far_widths = 8;
  struct Mark {
    const Strand* strand;
    Vec2 image;
  };
  std::unordered_map<FaceId, std::vector<Mark>> marks;
  for (const Strand& strand : strands)
    for (std::size_t i = 0; i < strand.path.size(); ++i)
      for_each_face(mesh, strand.path[i], [&](FaceId f) {
        std::vector<Mark>& list = marks[f];
        if (list.empty() || list.back().strand != &strand) list.push_back({&strand, strand.image[i]});
      });
  const auto apart = [&](const Mark& a, const Mark& b, double width) {
    const bool adjacent = a.strand->from == b.strand->from || a.strand->from == b.strand->to ||
                          a.strand->to == b.strand->from || a.strand->to == b.strand->to;
    return !adjacent && std::abs(a.image - b.image) >
                            std::max(far_widths * width * std::max(a.strand->scale, b.strand->scale), far);
  };
  std::unordered_map<FaceId, std::uint32_t> sheets;
  for (const auto& [f, list] : marks) {
    const auto corners = mesh.corners(f);
    const double longest = std::max({(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(),
                                     (corners[0] - corners[2]).norm()});
    const double double_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
    const double width = longest > 0 ? double_area / longest : 0;  // Its least height.
    std::vector<const Mark*> distinct;
    for (const Mark& mark : list)
      if (std::all_of(distinct.begin(), distinct.end(),
                      [&](const Mark* other) { return apart(mark, *other, width); }))
        distinct.push_back(&mark);
    sheets[f] = static_cast<std::uint32_t>(distinct.size());
  }
  return sheets;
}

/// The disc in the making, and how often it may cover each face.
class Thickening {
 public:
  /// `far` as in count_sheets.
  Thickening(BridgedSurface& surface, std::span<const SeedFeature> features,
             std::unordered_map<FaceId, std::uint32_t> sheets, double far)
      : features_(features), sheets_(std::move(sheets)), far_(far), disc_(surface, features[0].surface.face) {
    place_new_vertices(features[0].image);
    disc_.pin(PatchFaceId(0));
  }

  /// Grows the disc along the strand, from the patch face `start`, and returns the face over its end, pinned;
  /// invalid when others' faces leave no way there.
  /// Where the way on is covered already, by a branch of the same sheet that came this way, the walk goes on
  /// from that branch's vertex.
  PatchFaceId add_strand(PatchFaceId start, const Strand& strand) {
    const auto& corners = disc_.faces()[start].vertices;
    PatchVertexId at = *std::find_if(corners.begin(), corners.end(), [&](PatchVertexId v) {
      return disc_.mesh_vertex(v) == strand.path.front();
    });
    for (std::size_t i = 0; i < strand.path.size(); ++i) {
      at = disc_.complete_fan(at, [&](FaceId f) { return limit(f, strand.image[i]); });
      place_new_vertices(strand.image[i]);
      if (i + 1 == strand.path.size()) break;
      const PatchVertexId next = disc_.neighbour_over(at, strand.path[i + 1]);
      at = next.valid() ? next : vertex_over(strand.path[i + 1], strand.image[i + 1]);
      if (!at.valid()) return {};
    }
    const SeedFeature& end = features_[strand.to];
    PatchFaceId found;
    for (PatchFaceId q : disc_.fan(at))
      if (disc_.faces()[q].mesh_face == end.surface.face) found = q;
    if (!found.valid()) found = face_over(end.surface.face, end.image);
    if (found.valid()) disc_.pin(found);
    return found;
  }

  void add_ring() {
    const std::size_t count = disc_.faces().size();
    for (PatchFaceId q : ids<PatchFaceId>(count))
      for (int k = 0; k < 3; ++k) {
        if (disc_.faces()[q].neighbours[k].valid()) continue;
        const PatchVertexId beside = disc_.faces()[q].vertices[(k + 1) % 3];
        const FaceId beyond = disc_.surface().neighbour(disc_.faces()[q].mesh_face, k);
        if (!beyond.valid()) continue;
        disc_.glue(q, k, limit(beyond, image_[beside]));
        place_new_vertices(image_[beside]);
      }
  }

  Seed finish(std::vector<PatchFaceId> feature_faces) && {
    const ImmersedDisc::Renumbering map = disc_.compact();
    for (PatchFaceId& q : feature_faces) q = map.faces[q];
    Seed seed{std::move(disc_), std::move(feature_faces), {}, {}, 1, false};
    seed.image.resize(seed.disc.vertex_count());
    for (PatchVertexId v : ids<PatchVertexId>(map.vertices.size()))
      if (map.vertices[v].valid()) seed.image[map.vertices[v]] = image_[v];
    for (const auto& [f, count] : sheets_) seed.sheets = std::max(seed.sheets, count);
    return seed;
  }

 private:
  /// How often f may be covered when a part of the image about `image` is to go there: not again by one
  /// sheet.
  [[nodiscard]] std::uint32_t limit(FaceId f, Vec2 image) const {
    const auto sheets = sheets_.find(f);
    if (sheets == sheets_.end() || sheets->second == 1) return 1;
    for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
      if (disc_.alive(q) && disc_.faces()[q].mesh_face == f &&
          std::abs(image_[disc_.faces()[q].vertices[0]] - image) <= far_)
        return disc_.cover(f);
    return sheets->second;
  }

  void place_new_vertices(Vec2 image) { image_.resize(disc_.vertex_count(), image); }

  /// The vertex over `target` that is nearest in the image.
  [[nodiscard]] PatchVertexId vertex_over(VertexId target, Vec2 image) const {
    PatchVertexId nearest;
    for (PatchVertexId v : ids<PatchVertexId>(disc_.vertex_count()))
      if (disc_.alive(v) && disc_.mesh_vertex(v) == target &&
          (!nearest.valid() || std::abs(image_[v] - image) < std::abs(image_[nearest] - image)))
        nearest = v;
    return nearest;
  }

  [[nodiscard]] PatchFaceId face_over(FaceId target, Vec2 image) const {
    PatchFaceId nearest;
    const auto distance = [&](PatchFaceId q) {
      return std::abs(image_[disc_.faces()[q].vertices[0]] - image);
    };
    for (PatchFaceId q : ids<PatchFaceId>(disc_.faces().size()))
      if (disc_.alive(q) && disc_.faces()[q].mesh_face == target &&
          (!nearest.valid() || distance(q) < distance(nearest)))
        nearest = q;
    return nearest;
  }

  std::span<const SeedFeature> features_;
  std::unordered_map<FaceId, std::uint32_t> sheets_;  // 1 where not named
  double far_;
  ImmersedDisc disc_;
  IdVector<PatchVertexId, Vec2> image_;
};

}  // namespace

std::vector<FeaturePair> faithful_tree(const SurfaceMesh& mesh, std::span<const SeedFeature> features,
                                       const FeatureGraph& graph) {
  struct Edge {
    double scale, image_length;
    FeaturePair pair;
  };
  const auto measure = [&](std::span<const FeaturePair> pairs) {
    std::vector<Edge> edges;
    for (const FeaturePair pair : pairs) {
      const SeedFeature &a = features[pair[0]], &b = features[pair[1]];
      edges.push_back({scale_along(mesh, a, b), std::abs(b.image - a.image), pair});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.scale, a.pair) < std::tie(b.scale, b.pair);
    });
    return edges;
  };
  if (graph.planar.size() < 3) return graph.tree;
  std::vector<Edge> edges = measure(graph.tree);
  if (edges.back().scale <= short_cut * edges.front().scale) return graph.tree;

  std::vector<FeaturePair> candidates = graph.tree;
  std::set_difference(graph.planar.begin(), graph.planar.end(), graph.tree.begin(), graph.tree.end(),
                      std::back_inserter(candidates));
  edges = measure(candidates);
  const double usual = edges[edges.size() / 4].scale;
  // Faithful ones come first, as in the graph by their length; the others as little short cuts as can be.
  const auto rest = std::partition_point(edges.begin(), edges.end(),
                                         [&](const Edge& edge) { return edge.scale <= short_cut * usual; });
  std::sort(edges.begin(), rest, [](const Edge& a, const Edge& b) {
    return std::tie(a.image_length, a.pair) < std::tie(b.image_length, b.pair);
  });
  std::vector<std::uint32_t> part(features.size());
  std::iota(part.begin(), part.end(), 0);
  std::vector<FeaturePair> tree;
  for (const Edge& edge : edges) {
    const std::uint32_t a = part[edge.pair[0]], b = part[edge.pair[1]];
    if (a == b) continue;
    std::replace(part.begin(), part.end(), b, a);
    tree.push_back(edge.pair);
  }
  std::sort(tree.begin(), tree.end());
  return tree;
}

tl::expected<Seed, SeedFailure> build_seed(BridgedSurface& surface, std::span<const SeedFeature> features,
                                           std::span<const FeaturePair> tree, Crossings crossings) {
  auto strands = lay_strands(surface.mesh(), features, tree);
  if (!strands) return tl::unexpected(strands.error());
  double extent = 0;
  for (const SeedFeature& feature : features)
    extent = std::max(extent, std::abs(feature.image - features[0].image));
  const double far = far_share * extent;
  auto sheets = count_sheets(surface.mesh(), *strands, far);
  const bool crossed =
      std::any_of(sheets.begin(), sheets.end(), [](const auto& face) { return face.second > 1; });
  if (crossings == Crossings::one_sheet) sheets.clear();
  Thickening thickening(surface, features, std::move(sheets), far);
  std::vector<PatchFaceId> feature_faces(features.size());
  feature_faces[0] = PatchFaceId(0);
  for (const Strand& strand : *strands) {
    feature_faces[strand.to] = thickening.add_strand(feature_faces[strand.from], strand);
    if (!feature_faces[strand.to].valid()) return tl::unexpected(SeedFailure{{strand.from, strand.to}, true});
  }
  thickening.add_ring();
  Seed seed = std::move(thickening).finish(std::move(feature_faces));
  seed.crossed = crossed;
  seed.paths.resize(tree.size());
  for (const Strand& strand : *strands) {
    std::vector<Vec3>& path = seed.paths[strand.edge];
    path.push_back(position_of(surface.mesh(), features[strand.from].surface));
    for (VertexId v : strand.path) path.push_back(surface.mesh().positions[v]);
    path.push_back(position_of(surface.mesh(), features[strand.to].surface));
  }
  return seed;
}

}  // namespace applique
