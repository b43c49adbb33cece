#include "applique/patch/seed.h"

#include <algorithm>

#include "applique/surface/shortest_path.h"

namespace applique {
namespace {

PatchVertexId any_vertex_over(const ImmersedDisc& disc, VertexId target) {
  for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count()))
    if (disc.alive(v) && disc.mesh_vertex(v) == target) return v;
  return {};
}

PatchFaceId any_face_over(const ImmersedDisc& disc, FaceId target) {
  for (PatchFaceId q : ids<PatchFaceId>(disc.faces().size()))
    if (disc.alive(q) && disc.faces()[q].mesh_face == target) return q;
  return {};
}

/// Grows the disc along the path, from the patch face `start`, and returns the face over `goal`. Where the
/// way on is covered already, by a branch that came this way, the walk goes on from that branch's vertex.
PatchFaceId thicken_path(ImmersedDisc& disc, PatchFaceId start, std::span<const VertexId> path, FaceId goal,
                         std::uint32_t cover_limit) {
  const auto& corners = disc.faces()[start].vertices;
  PatchVertexId at = *std::find_if(corners.begin(), corners.end(),
                                   [&](PatchVertexId v) { return disc.mesh_vertex(v) == path.front(); });
  for (std::size_t i = 0; i < path.size(); ++i) {
    at = disc.complete_fan(at, cover_limit);
    if (i + 1 == path.size()) break;
    const PatchVertexId next = disc.neighbour_over(at, path[i + 1]);
    at = next.valid() ? next : any_vertex_over(disc, path[i + 1]);
    APPLIQUE_ASSERT(at.valid());  // a face beside the path's edge is glued, or covered and so in the disc
  }
  for (PatchFaceId q : disc.fan(at))
    if (disc.faces()[q].mesh_face == goal) return q;
  const PatchFaceId covered = any_face_over(disc, goal);
  APPLIQUE_ASSERT(covered.valid());
  return covered;
}

void add_ring(ImmersedDisc& disc, std::uint32_t cover_limit) {
  const std::size_t count = disc.faces().size();
  for (PatchFaceId q : ids<PatchFaceId>(count))
    for (int k = 0; k < 3; ++k)
      if (!disc.faces()[q].neighbours[k].valid()) disc.glue(q, k, cover_limit);
}

}  // namespace

tl::expected<Seed, SeedFailure> build_seed(BridgedSurface& surface, std::span<const SurfacePoint> features,
                                           std::span<const FeaturePair> tree, std::uint32_t cover_limit) {
  Seed seed{ImmersedDisc(surface, features[0].face), std::vector<PatchFaceId>(features.size())};
  seed.feature_faces[0] = PatchFaceId(0);
  seed.disc.pin(PatchFaceId(0));
  // Breadth first from feature 0: an edge is walked as soon as one of its ends is placed.
  std::vector<std::uint32_t> queue = {0};
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t from = queue[i];
    for (const FeaturePair& edge : tree) {
      if (edge[0] != from && edge[1] != from) continue;
      const std::uint32_t to = edge[0] == from ? edge[1] : edge[0];
      if (seed.feature_faces[to].valid()) continue;
      const std::vector<VertexId> path = shortest_path(surface.mesh(), features[from], features[to]);
      if (path.empty()) return tl::unexpected(SeedFailure{edge});
      seed.feature_faces[to] =
          thicken_path(seed.disc, seed.feature_faces[from], path, features[to].face, cover_limit);
      seed.disc.pin(seed.feature_faces[to]);
      queue.push_back(to);
    }
  }
  APPLIQUE_ASSERT(queue.size() == features.size());
  add_ring(seed.disc, cover_limit);
  const ImmersedDisc::Renumbering map = seed.disc.compact();
  for (PatchFaceId& q : seed.feature_faces) q = map.faces[q];
  return seed;
}

}  // namespace applique
