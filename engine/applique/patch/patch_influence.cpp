#include "applique/patch/patch_influence.h"

#include <algorithm>

namespace applique {
namespace {

constexpr double longest_edge =
    0.1;  // in the image, of the region's diameter: a longer one is no edge of a sheet

template <class Visit>
void for_each_neighbour(const ImmersedDisc& disc, PatchVertexId v, Visit visit) {
  for (PatchFaceId q : disc.fan(v))
    for (PatchVertexId w : disc.faces()[q].vertices)
      if (w != v) visit(w);
}

}  // namespace

std::vector<double> influence_on_patch(const ImmersedDisc& disc, const PatchPoints& points,
                                       const Region& region, const InfluenceField& field,
                                       std::span<const PatchFaceId> feature_faces,
                                       std::span<const std::uint32_t> group) {
  const std::uint32_t groups = field.groups();
  std::vector<double> influence(points.size() * groups, 0);
  const auto of = [&](PatchVertexId v) { return std::span(influence).subspan(v.value * groups, groups); };
  IdVector<PatchVertexId, char> known(points.size(), false);

  // Inside the region, from the features on.
  std::vector<PatchVertexId> queue;
  const auto read_field = [&](PatchVertexId v) {
    known[v] = true;
    field.at(points[v].image, of(v));
    queue.push_back(v);
  };
  for (std::size_t k = 0; k < feature_faces.size(); ++k)
    for (PatchVertexId v : disc.faces()[feature_faces[k]].vertices) {
      if (known[v]) continue;  // by a feature next to this one
      read_field(v);
      std::fill(of(v).begin(), of(v).end(), 0.0);
      of(v)[group[k]] = 1;
    }
  for (std::size_t i = 0; i < queue.size(); ++i)
    for_each_neighbour(disc, queue[i], [&](PatchVertexId w) {
      if (!known[w] && region.contains(points[w].image) &&
          std::abs(points[w].image - points[queue[i]].image) <= longest_edge * region.diameter())
        read_field(w);
    });

  // The rest, ring by ring.
  while (!queue.empty()) {
    std::vector<PatchVertexId> ring;
    for (PatchVertexId v : queue)
      for_each_neighbour(disc, v, [&](PatchVertexId w) {
        if (!known[w]) ring.push_back(w);
      });
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    for (PatchVertexId v : ring) {
      double total = 0;
      for_each_neighbour(disc, v, [&](PatchVertexId w) {
        if (!known[w]) return;
        total += 1;
        for (std::uint32_t g = 0; g < groups; ++g) of(v)[g] += of(w)[g];
      });
      for (double& value : of(v)) value /= total;
    }
    for (PatchVertexId v : ring) known[v] = true;
    queue = std::move(ring);
  }
  return influence;
}

}  // namespace applique
