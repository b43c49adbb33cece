#include "applique/features_at_fault.h"

#include <algorithm>

#include "applique/embed/align.h"
#include "applique/warp/build_warp.h"

namespace applique {
namespace {

constexpr std::size_t most_at_fault = 3;
constexpr std::size_t least_left = 2;    // features, which lie flat of themselves
constexpr std::size_t most_sets = 5000;  // of one number of features, which are ranked
constexpr std::size_t probe_count = 64;  // of a warp
constexpr std::size_t most_tried = 8;    // of these, by a warp each

using Features = std::vector<std::uint32_t>;

/// The features that are left, in the embedding and in the image.
struct Left {
  std::vector<Vec2> features, targets;
  FeatureGroups groups;
};

Left leave_out(const Features& out, std::span<const Vec2> features, std::span<const Vec2> targets,
               const FeatureGroups& groups) {
  Left left;
  left.groups = {groups.count, {}, groups.meet};
  for (std::uint32_t k = 0; k < features.size(); ++k) {
    if (std::find(out.begin(), out.end(), k) != out.end()) continue;
    left.features.push_back(features[k]);
    left.targets.push_back(targets[k]);
    if (groups.count > 1) left.groups.of.push_back(groups.of[k]);
  }
  return left;
}

/// Of the embedding of these features alone. An image that lies over itself stays where all of them have it.
Similarity align(const Left& left) {
  return left.groups.count > 1 ? Similarity() : fit_similarity(left.features, left.targets);
}

/// The next set of as many of `count` features, in lexicographic order; false after the last.
bool next_set(Features& set, std::size_t count) {
  for (std::size_t i = set.size(); i-- > 0;) {
    if (set[i] + (set.size() - i) >= count) continue;
    ++set[i];
    for (std::size_t k = i + 1; k < set.size(); ++k) set[k] = set[k - 1] + 1;
    return true;
  }
  return false;
}

/// Sets of `size` features, those first without which the others lie nearest to their image points. None if
/// there are too many.
std::vector<Features> ranked_sets(std::size_t size, std::span<const Vec2> features,
                                  std::span<const Vec2> targets, const FeatureGroups& groups) {
  std::vector<std::pair<double, Features>> ranked;
  Features set(size);
  for (std::uint32_t k = 0; k < size; ++k) set[k] = k;
  do {
    const Left left = leave_out(set, features, targets, groups);
    const Similarity similarity = align(left);
    double off = 0;
    for (std::size_t k = 0; k < left.features.size(); ++k)
      off += std::norm(similarity(left.features[k]) - left.targets[k]);
    ranked.emplace_back(off, set);
    if (ranked.size() > most_sets) return {};
  } while (next_set(set, features.size()));
  std::sort(ranked.begin(), ranked.end());
  std::vector<Features> sets;
  for (auto& [off, out] : ranked) sets.push_back(std::move(out));
  return sets;
}

/// Whether the warp of these features alone turns nothing over that the image shows.
bool lies_flat(const SurfaceMesh& surface, const Region& region, const DecalMap& map, const Left& left) {
  const Similarity similarity = align(left);
  std::vector<Vec2> features = left.features, plane = map.plane.raw();
  for (Vec2& z : features) z = similarity(z);
  for (Vec2& z : plane) z = similarity(z);
  std::vector<WarpProbe> probes;
  const std::size_t stride = std::max<std::size_t>(1, plane.size() / probe_count);
  for (std::size_t v = 0; v < plane.size(); v += stride) {
    const auto influence = map.influence.begin() + static_cast<std::ptrdiff_t>(v * map.groups);
    probes.push_back({plane[v], {influence, influence + map.groups}});
  }
  const Warp warp =
      build_warp(features, left.targets, build_feature_graph(region, left.targets), probes, left.groups);
  const IdVector<PatchVertexId, Vec2> image(warp_all(warp, plane, map.influence));
  IdVector<PatchFaceId, char> shown;
  shown.reserve(map.patch.faces.size());
  for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    const auto& v = map.patch.faces[q].vertices;
    shown.push_back(
        map.patch.faces[q].mesh_face.valid() &&
        std::any_of(v.begin(), v.end(), [&](PatchVertexId c) { return region.contains(image[c]); }));
  }
  const MapQuality quality = measure_quality(surface, map.patch, IdVector<PatchVertexId, Vec2>(plane), image,
                                             shown, warp, region, map.influence);
  return quality.flipped_plane + quality.flipped_image == 0;
}

}  // namespace

std::vector<std::uint32_t> features_at_fault(const SurfaceMesh& surface, const Region& region,
                                             const DecalMap& map, std::span<const Vec2> features,
                                             std::span<const Vec2> targets, const FeatureGroups& groups) {
  for (std::size_t size = 1; size <= most_at_fault && size + least_left <= features.size(); ++size) {
    const std::vector<Features> sets = ranked_sets(size, features, targets, groups);
    for (std::size_t k = 0; k < std::min(sets.size(), most_tried); ++k)
      if (lies_flat(surface, region, map, leave_out(sets[k], features, targets, groups))) return sets[k];
  }
  return {};
}

}  // namespace applique
