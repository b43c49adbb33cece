#include "applique/suggest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "applique/base/parallel.h"
#include "applique/decal_input.h"
#include "applique/surface/surface_query.h"
#include "applique/warp/build_warp.h"

namespace applique {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double first_step = 0.25;      // of the compass search, share of the way to the nearest feature
constexpr double last_step = 0.01;       // the same
constexpr int most_moves = 24;           // of the compass search
constexpr double lost_coverage = 0.001;  // what a suggestion may cost of it
constexpr double per_pixel = 10;         // image points are suggested in tenths of a pixel
constexpr int position_digits = 6;       // of the decal's size on the surface, in suggested positions

/// A correspondence that is tried out.
struct Pin {
  Vec2 plane, image;
  double stretch = infinite;  ///< Squared L2, as the trial has it.
};

/// To the nearest multiple of 1 / `per_unit`: a short decimal fraction where that is a power of ten.
double rounded(double x, double per_unit) {
  return std::round(x * per_unit) / per_unit;
}

double distance_to_nearest(Vec2 z, std::span<const Vec2> places) {
  double nearest = infinite;
  for (const Vec2 place : places) nearest = std::min(nearest, std::abs(z - place));
  return nearest;
}

/// The features in the aligned embedding: where the warp starts from.
std::vector<Vec2> features_in_plane(const DecalMap& map, const std::vector<Vec2>& targets) {
  if (map.warp.steps == 0) return targets;
  return {map.warp.position.begin(), map.warp.position.begin() + map.warp.features};
}

/// The decal with one more feature on the patch that it has: embedding and influences stay as they are.
class Trial {
 public:
  Trial(const SurfaceMesh& surface, const DecalInput& input, const DecalMap& map)
      : region_(input.region),
        map_(map),
        targets_(targets_of(input)),
        from_(features_in_plane(map, targets_)) {
    for (PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
      const std::array<Vec2, 3> p = image_of(q, map.image);
      const double area = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
      if (map.textured[q] == 0 || area <= 0) continue;
      const auto corners = map.patch_surface(surface).corners(map.patch.faces[q].mesh_face);
      const double share = area_in_region(region_, p) / area;
      faces_.push_back(
          {q, corners, share, share * 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm()});
      surface_area_ += faces_.back().area;
      image_area_ += share * area;
    }
  }

  /// Places amid much stretch and far from the features and from each other, as they are mapped now.
  [[nodiscard]] std::vector<Pin> stretched_places(std::size_t count) const {
    std::vector<Pin> places;
    std::vector<Vec2> taken = targets_;
    while (places.size() < count) {
      double best = 0;
      Pin place;
      for (const Face& face : faces_) {
        const auto p = image_of(face.patch_face, map_.image);
        const Vec2 middle = (p[0] + p[1] + p[2]) / 3.0;
        const double stretch =
            singular_values(face.corners, p).squared_l2_stretch() * image_area_ / surface_area_;
        const double score = std::abs(std::log(stretch)) * distance_to_nearest(middle, taken);
        if (score <= best || !region_.contains(middle)) continue;
        best = score;
        const auto f = image_of(face.patch_face, map_.plane);
        place = {(f[0] + f[1] + f[2]) / 3.0, middle};
      }
      if (best <= 0) break;
      places.push_back(place);
      taken.push_back(place.image);
    }
    return places;
  }

  /// Moves the pin in the plane to where it lowers the stretch.
  void relax(Pin& pin) const {
    std::vector<Vec2> targets = targets_;
    targets.push_back(pin.image);
    const FeatureGraph graph = build_feature_graph(region_, targets);
    const FeatureGroups groups = groups_with(pin);
    const auto stretch = [&](Vec2 plane) {
      std::vector<Vec2> from = from_;
      from.push_back(plane);
      return squared_stretch(build_warp(from, targets, graph, {}, groups));
    };
    const double reach = distance_to_nearest(pin.plane, from_);
    double step = first_step * reach;
    pin.stretch = stretch(pin.plane);
    for (int move = 0; move < most_moves && step > last_step * reach; ++move) {
      Pin best = pin;
      for (const Vec2 way : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}) {
        const Vec2 plane = pin.plane + step * way;
        const double there = stretch(plane);
        if (there < best.stretch) best = {plane, pin.image, there};
      }
      if (best.plane == pin.plane) step /= 2;
      pin = best;
    }
  }

  /// The pin as a feature, if it is on the surface: on the sheet that shows nearly its image point.
  [[nodiscard]] std::optional<Feature> feature_at(const Pin& pin) const {
    std::optional<Feature> feature;
    double nearest = infinite;
    for (PatchFaceId q : ids<PatchFaceId>(map_.patch.faces.size())) {
      const auto f = image_of(q, map_.plane), p = image_of(q, map_.image);
      const double area = cross(f[1] - f[0], f[2] - f[0]);
      const std::array<double, 3> weights = {cross(f[1] - pin.plane, f[2] - pin.plane) / area,
                                             cross(f[2] - pin.plane, f[0] - pin.plane) / area,
                                             cross(f[0] - pin.plane, f[1] - pin.plane) / area};
      if (!map_.patch.faces[q].mesh_face.valid() || !(area > 0) ||
          std::min({weights[0], weights[1], weights[2]}) < 0)
        continue;
      const double off = std::abs(weights[0] * p[0] + weights[1] * p[1] + weights[2] * p[2] - pin.image);
      if (off >= nearest) continue;
      nearest = off;
      feature = Feature{on_grid(pin.image), {map_.patch.faces[q].mesh_face, weights}, map_.depth[q]};
    }
    if (feature && map_.divided != nullptr) feature->surface = map_.divided->to_whole(feature->surface);
    return feature;
  }

  /// Scene units of surface that show the region, along one side of a square of their area.
  [[nodiscard]] double surface_size() const { return std::sqrt(surface_area_); }

  /// An image point to write down.
  [[nodiscard]] Pixel on_grid(Vec2 image) const {
    const Pixel at = region_.frame().to_pixel(image);
    return {rounded(at.x, per_pixel), rounded(at.y, per_pixel)};
  }

 private:
  struct Face {
    PatchFaceId patch_face;
    std::array<Vec3, 3> corners;
    double share;  ///< Of it that lies in the region.
    double area;   ///< Of that share on the surface.
  };

  [[nodiscard]] std::array<Vec2, 3> image_of(PatchFaceId q, const IdVector<PatchVertexId, Vec2>& at) const {
    const auto& v = map_.patch.faces[q].vertices;
    return {at[v[0]], at[v[1]], at[v[2]]};
  }

  [[nodiscard]] std::span<const double> influence_of(std::size_t vertex) const {
    return std::span(map_.influence).subspan(vertex * map_.groups, map_.groups);
  }

  /// The map's groups, the pin in the one that moves its place most. Groups meet where the warp has a pair.
  [[nodiscard]] FeatureGroups groups_with(const Pin& pin) const {
    if (map_.groups == 1) return {};
    FeatureGroups groups = {map_.groups, map_.feature_groups,
                            std::vector<char>(std::size_t{map_.groups} * map_.groups, 0)};
    const auto meet = [&](std::uint32_t a, std::uint32_t b) {
      groups.meet[std::size_t{a} * groups.count + b] = groups.meet[std::size_t{b} * groups.count + a] = 1;
    };
    for (std::uint32_t g = 0; g < groups.count; ++g) meet(g, g);
    for (const auto& [i, j] : map_.warp.pairs) meet(groups.of[i], groups.of[j]);
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < map_.image.size(); ++v)
      if (std::abs(map_.image.raw()[v] - pin.image) < std::abs(map_.image.raw()[nearest] - pin.image))
        nearest = v;
    const auto influence = influence_of(nearest);
    groups.of.push_back(
        static_cast<std::uint32_t>(std::max_element(influence.begin(), influence.end()) - influence.begin()));
    return groups;
  }

  /// Normalised (§9 of the design), each face counting by the share of it that is in the region now; infinite
  /// if one turns over that has not been.
  [[nodiscard]] double squared_stretch(const Warp& warp) const {
    IdVector<PatchVertexId, Vec2> image = map_.plane;
    if (warp.steps > 0)
      for (PatchVertexId v : ids<PatchVertexId>(image.size()))
        image[v] = warp(image[v], influence_of(v.value));
    double sum = 0, image_area = 0;
    for (const Face& face : faces_) {
      const auto p = image_of(face.patch_face, image);
      const double area = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
      if (!(area > 0)) return infinite;
      image_area += face.share * area;
      sum += singular_values(face.corners, p).squared_l2_stretch() * face.area;
    }
    return sum * image_area / (surface_area_ * surface_area_);
  }

  const Region& region_;
  const DecalMap& map_;
  std::vector<Vec2> targets_;  ///< The features in the image.
  std::vector<Vec2> from_;     ///< The features in the plane.
  std::vector<Face> faces_;    ///< Those that show some of the region.
  double surface_area_ = 0, image_area_ = 0;
};

/// Solves changed inputs and keeps the one with the least stretch.
class Verifier {
 public:
  Verifier(const SurfaceMesh& surface, const DecalMap& map, const SuggestOptions& options)
      : surface_(surface), map_(map), options_(options) {
    options_.solve.trace = nullptr;
  }

  /// Its L2 stretch, if it is a gain: no less shown, no more turned over.
  [[nodiscard]] std::optional<double> gain(const DecalInput& input) const {
    const auto solved = solve_decal(surface_, input, options_.solve);
    if (!solved) return std::nullopt;
    const MapQuality &before = map_.quality, &after = solved->quality;
    if (after.flipped_plane + after.flipped_image > before.flipped_plane + before.flipped_image ||
        after.coverage < before.coverage - lost_coverage ||
        after.l2_stretch > (1 - options_.least_gain) * before.l2_stretch)
      return std::nullopt;
    return after.l2_stretch;
  }

 private:
  const SurfaceMesh& surface_;
  const DecalMap& map_;
  SuggestOptions options_;
};

/// A feature as it is read back once it has been written down, and the position that is written: a feature is
/// only worth what its rounded place is worth, where the surface is coarse or the decal all but torn.
class Written {
 public:
  Written(const SurfaceMesh& surface, double size)
      : surface_(surface),
        query_(surface),
        per_unit_(std::pow(10, position_digits - std::floor(std::log10(size)))) {}

  [[nodiscard]] Suggestion::Added operator()(const Feature& feature) const {
    Vec3 position = position_of(surface_, feature.surface);
    for (double& x : position) x = rounded(x, per_unit_);
    return {{feature.image, query_.nearest(position), feature.depth}, position, infinite};
  }

 private:
  const SurfaceMesh& surface_;
  SurfaceQuery query_;
  double per_unit_;
};

std::optional<Suggestion::Added> find_further(const SurfaceMesh& surface, const DecalInput& input,
                                              const DecalMap& map, const SuggestOptions& options) {
  const Trial trial(surface, input, map);
  std::vector<Pin> pins = trial.stretched_places(options.places);
  parallel_for(static_cast<int>(pins.size()), [&](int i) {
    const Vec2 on_grid = input.region.frame().to_plane(trial.on_grid(pins[i].image));
    if (input.region.contains(on_grid)) pins[i].image = on_grid;
    trial.relax(pins[i]);
  });
  std::sort(pins.begin(), pins.end(), [](const Pin& a, const Pin& b) { return a.stretch < b.stretch; });
  const Verifier verifier(surface, map, options);
  const Written written(surface, trial.surface_size());
  std::optional<Suggestion::Added> best;
  std::size_t gains = 0;
  for (const Pin& pin : pins) {
    const auto feature = trial.feature_at(pin);
    if (!feature) continue;
    Suggestion::Added added = written(*feature);
    DecalInput changed = input;
    changed.features.push_back(added.feature);
    const auto stretch = verifier.gain(changed);
    if (!stretch) continue;
    added.l2_stretch = *stretch;
    if (!best || added.l2_stretch < best->l2_stretch) best = added;
    if (++gains == options.gains) break;
  }
  return best;
}

std::optional<Suggestion::LeftOut> find_one_too_many(const SurfaceMesh& surface, const DecalInput& input,
                                                     const DecalMap& map, const SuggestOptions& options) {
  const Verifier verifier(surface, map, options);
  std::optional<Suggestion::LeftOut> best;
  for (std::size_t k = 0; k < input.features.size(); ++k) {
    DecalInput changed = input;
    changed.features.erase(changed.features.begin() + static_cast<std::ptrdiff_t>(k));
    const auto stretch = verifier.gain(changed);
    if (stretch && (!best || *stretch < best->l2_stretch)) best = {k, *stretch};
  }
  return best;
}

}  // namespace

Suggestion suggest_feature(const SurfaceMesh& surface, const DecalInput& input, const DecalMap& map,
                           const SuggestOptions& options) {
  Suggestion suggestion = {map.quality.l2_stretch, {}, {}};
  if (options.solve.method == Method::applique) suggestion.add = find_further(surface, input, map, options);
  suggestion.leave_out = find_one_too_many(surface, input, map, options);
  return suggestion;
}

}  // namespace applique
