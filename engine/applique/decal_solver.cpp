#include "applique/decal_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "applique/base/stage_timer.h"
#include "applique/decal_input.h"
#include "applique/decal_warnings.h"
#include "applique/embed/align.h"
#include "applique/embed/self_overlap.h"
#include "applique/features_at_fault.h"
#include "applique/linear_faces.h"
#include "applique/lone_alignment.h"
#include "applique/patch/patch_influence.h"
#include "applique/patch/sheets.h"
#include "applique/patch/show_once.h"
#include "applique/region/clusters.h"
#include "applique/region/influence.h"
#include "applique/unfold.h"
#include "applique/warp/build_warp.h"

namespace applique {
namespace {

constexpr std::uint32_t most_sheets = 16;
constexpr double most_patch_cover = 1.3;      // of the region, by a patch that is to lie over itself
constexpr double most_patch_area = 4;         // of a patch that may cover more, times the region's
constexpr double linear_tolerance_px = 0.02;  // §5.1 of the design
constexpr double few_changes = 0.03;          // of a patch's faces
constexpr int trial_solves = 6;               // after them, groups stay
constexpr int most_refreshes = 8;             // of the vertices' influence
constexpr int growing_refreshes = 2;          // of it while the patch is to change
constexpr double refreshed = 1e-5;            // of the region's diameter: what a last refresh moves
constexpr double little_scaled = 1.25;        // by features
constexpr double little_turned = 0.26;        // by features, radians
constexpr double little_shifted = 0.05;       // by features, of the region's diameter
constexpr double hardly_any = 0.005;          // of a patch's faces
constexpr int most_refinements = 2;           // after the first of the final patch
constexpr int free_weighings = 8;             // of a patch's faces
constexpr double little_regard = 0.1;         // for the surface beyond the image
constexpr double met_px = 0.01;               // what a feature is off at most
constexpr double whole = 0.99999;             // of the region

/// Whether the features ask for little enough for the embedding to give it. One that is bent far to meet them
/// bends at the features alone, where the warp does so smoothly.
bool ask_little(const WarpStress& stress, double diameter) {
  const auto little = [](const auto& asked) {
    return std::abs(std::log(asked.scale)) < std::log(little_scaled) && std::abs(asked.turn) < little_turned;
  };
  return std::all_of(stress.pairs.begin(), stress.pairs.end(), little) &&
         std::all_of(stress.features.begin(), stress.features.end(), [&](const FeatureStress& asked) {
           return little(asked) && asked.shift < little_shifted * diameter;
         });
}

}  // namespace

std::uint32_t folds(const DecalMap& map) {
  return map.quality.flipped_plane + map.quality.flipped_image;
}

/// The state that the growth's iterations share.
class DecalSolver::Work {
 public:
  Work(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options, Attempt attempt)
      : surface_(surface),
        input_(input),
        options_(options),
        attempt_(attempt),
        bridged_(surface),
        targets_(targets_of(input)) {}

  Result<void> run() {
    StageTimer timer(map_.times.total);
    {
      StageTimer stage(map_.times.graph);
      map_.graph = build_feature_graph(input_.region, targets_);
    }
    APPLIQUE_TRY(seed_, make_seed());
    for (const Vec2 z : seed_->image) points_.push_back({Vec2(), z});
    growth_.emplace(seed_->disc, seed_->feature_faces, input_.region, seed_->sheets);
    growth_->set_most_area(attempt_.most_area);
    APPLIQUE_CHECK(grow(seed_->disc, *growth_));
    StageTimer stage(map_.times.quality);
    describe(seed_->disc, *growth_);
    return check_met();
  }

  void unfold() {
    StageTimer timer(map_.times.total);
    StageTimer stage(map_.times.quality);
    const ImmersedDisc& disc = seed_->disc;
    const std::vector<PlacedPoint> features = placed_features(disc, *growth_, 1);
    Unfolded unfolded = unfold_image(measure_disc(disc), scale_, map_.image.raw(), features);
    if (unfolded.flips > 0) return;
    unfolded_ = folds(map_);
    for (PatchVertexId v : ids<PatchVertexId>(points_.size()))
      points_[v].plane = points_[v].image = unfolded.image[v.value];
    warp_ = {};
    groups_ = {};
    describe(disc, *growth_);
  }

  Result<DecalMap> finish() {
    if (folds(map_) > 0) {
      const std::vector<Vec2> features = feature_places(seed_->disc, *growth_, map_.plane.raw());
      if (all_turned(features, map_.graph.triangles)) return fail_mirrored(surface_, input_);
      at_fault_ = features_at_fault(surface_, input_.region, map_, features, targets_, groups_);
    }
    warn();
    return std::move(map_);
  }

  [[nodiscard]] const DecalMap& map() const { return map_; }
  [[nodiscard]] double patch_area() const { return growth_->area(); }
  [[nodiscard]] bool crossed() const { return crossed_; }
  [[nodiscard]] SolveTrace& trace() { return trace_; }

 private:
  Result<Seed> make_seed() {
    StageTimer stage(map_.times.seed);
    std::vector<SeedFeature> features;
    for (std::size_t k = 0; k < targets_.size(); ++k)
      features.push_back({input_.features[k].surface, targets_[k]});
    map_.graph.tree = faithful_tree(surface_, features, map_.graph);
    auto seed = build_seed(bridged_, features, map_.graph.tree, attempt_.crossings);
    if (seed) crossed_ = seed->crossed;
    if (seed && options_.trace != nullptr) trace_.paths = seed->paths;
    if (seed) return std::move(*seed);
    const auto [i, j] = seed.error().pair;
    if (seed.error().crowded) {
      crossed_ = true;
      return fail(
          ErrorCode::not_solved,
          fmt::format("decal '{}': the way from {} to {} is crowded with other parts of the image; divide "
                      "the model more finely there, or move them apart",
                      input_.name, feature_name(input_, i), feature_name(input_, j)));
    }
    return fail(ErrorCode::features_disconnected,
                fmt::format("decal '{}': no way along the surface from {} to {}{}", input_.name,
                            feature_name(input_, i), feature_name(input_, j), weld_note(surface_)));
  }

  /// Embeds, aligns and warps the disc as it is: points_ and warp_.
  Result<void> parameterize(const ImmersedDisc& disc, const Growth& growth, const EmbedOptions& options) {
    ++map_.solves;
    std::vector<Vec2> features, plane;
    const bool guided = options_.guide && !options.rough && groups_.count == 1 &&
                        ask_little(map_.stress, input_.region.diameter());
    {
      StageTimer stage(map_.times.embed);
      // The last embedding, undone to the surface's scale, is where an isometric one may start from.
      std::vector<Vec2> start;
      for (const PatchPoint& point : points_) start.push_back(point.plane / scale_);
      const std::vector<PlacedPoint> guide =
          guided ? placed_features(disc, growth, scale_) : std::vector<PlacedPoint>();
      if (!options.rough) weigh(growth);
      Embedding embedding =
          embed_disc(measure_disc(disc), {options.energy, options.rough, guide, weights_}, start);
      rung_ = embedding.rung;
      plane = std::move(embedding.plane);
      features = feature_places(disc, growth, plane);
      for (std::size_t v = 0; v < plane.size(); ++v) points_[PatchVertexId(v)].plane = plane[v];
      if (!guided) choose_groups(disc, growth, features);
      APPLIQUE_CHECK(align(disc, growth, features, plane));
    }
    StageTimer stage(map_.times.warp);
    for (std::size_t v = 0; v < plane.size(); ++v) points_[PatchVertexId(v)].plane = plane[v];
    warp_points(disc, growth, plane, features);
    // Of an embedding that is drawn to the features they ask the same, and leave nothing to the warp.
    if (!guided)
      map_.stress =
          measure_stress(features, targets_, warp_pairs(map_.graph, targets_.size(), groups_), warp_);
    return {};
  }

  /// Triangles count in full where the image shows them, and in the end from when it first does: a set that
  /// only grows settles.
  void weigh(const Growth& growth) {
    const IdVector<PatchFaceId, char> shown = growth.shown(points_);
    if (++weighed_ <= free_weighings) weights_.clear();
    weights_.resize(shown.size(), little_regard);
    for (PatchFaceId q : ids<PatchFaceId>(shown.size()))
      if (shown[q]) weights_[q.value] = 1;
  }

  /// Whether the image shows other triangles, more than a few, than those that counted in the last embedding.
  [[nodiscard]] bool shows_others(const Growth& growth) const {
    const IdVector<PatchFaceId, char> shown = growth.shown(points_);
    std::size_t others = 0;
    for (PatchFaceId q : ids<PatchFaceId>(shown.size()))
      others += q.value >= weights_.size() || (shown[q] != 0) != (weights_[q.value] == 1);
    return static_cast<double>(others) > hardly_any * static_cast<double>(shown.size());
  }

  /// The features in the disc's triangles, and their places in the image at `scale` plane units to one.
  [[nodiscard]] std::vector<PlacedPoint> placed_features(const ImmersedDisc& disc, const Growth& growth,
                                                         double scale) const {
    std::vector<PlacedPoint> features;
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      const auto& v = disc.faces()[growth.feature_faces()[k]].vertices;
      features.push_back(
          {{static_cast<int>(v[0].value), static_cast<int>(v[1].value), static_cast<int>(v[2].value)},
           input_.features[k].surface.barycentric,
           targets_[k] / scale});
    }
    return features;
  }

  Result<void> align(const ImmersedDisc& disc, const Growth& growth, std::vector<Vec2>& features,
                     std::vector<Vec2>& plane) {
    Similarity similarity;
    // Places of several turns fall together when all is to be one sheet.
    if (crossed_ && attempt_.crossings == Crossings::one_sheet && coincide(features))
      return fail(
          ErrorCode::not_solved,
          fmt::format("decal '{}': features of several turns come to lie over one another; divide the model "
                      "more finely there, or move them apart",
                      input_.name));
    if (features.size() == 1) {
      APPLIQUE_TRY(similarity, lone_alignment(surface_, input_, disc, growth.feature_faces()[0], features[0],
                                              targets_[0], plane));
    } else {
      // Where the image lies over itself only the graph's triangles tell.
      mirrored_ = (groups_.count == 1 || !map_.graph.triangles.empty()) &&
                  is_mirrored(features, targets_, map_.graph.triangles);
      similarity = groups_.count > 1 ? fit_by_edges(features, targets_, map_.graph.tree)
                                     : fit_similarity(features, targets_);
    }
    scale_ = std::abs(similarity.scale);
    for (Vec2& z : features) z = similarity(z);
    for (Vec2& z : plane) z = similarity(z);
    return {};
  }

  /// Features of several turns may have one triangle of the patch between them: no warp parts these. Nor does
  /// one part places that all but coincide on the surface and lie far apart in the image.
  [[nodiscard]] Result<void> check_met() const {
    const std::vector<double>& residual = map_.quality.feature_residual;
    std::vector<std::string> missed;
    for (std::size_t k = 0; k < residual.size(); ++k)
      if (!(residual[k] < met_px)) missed.push_back(feature_name(input_, k));
    if (missed.empty()) return {};
    return fail(ErrorCode::not_solved,
                fmt::format("decal '{}': {} cannot be met: too near on the surface to other features, or to "
                            "parts of the image "
                            "that lie over one another there; move {} apart, or divide the model more finely",
                            input_.name, fmt::join(missed, ", "), missed.size() > 1 ? "them" : "it"));
  }

  static bool coincide(const std::vector<Vec2>& features) {
    double extent = 0, nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < features.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        extent = std::max(extent, std::abs(features[i] - features[j]));
        nearest = std::min(nearest, std::abs(features[i] - features[j]));
      }
    return nearest < 1e-3 * extent;
  }

  /// Features move the image in groups while it lies over itself in the plane (§3.6 of the design; there a
  /// graph that overlaps is enough, but in one sheet that is distortion, which a single group bends with
  /// fewer folds). The first embeddings are of thin patches and may mislead; later on there is no way back,
  /// so that the growth ends.
  void choose_groups(const ImmersedDisc& disc, const Growth& growth, const std::vector<Vec2>& features) {
    if (!attempt_.grouping) return;
    const bool graph = growth.cover_limit() > 1 && graph_overlaps(features, map_.graph);
    if (!graph && !overlaps_in_plane(disc, points_, input_.region)) {
      if (map_.solves <= trial_solves) {
        groups_ = {};
        field_groups_.clear();
      }
      return;
    }
    if (groups_.count > 1 && map_.solves > trial_solves) return;
    if (clusters_.empty()) clusters_ = cluster_features(input_.region, targets_, map_.graph);
    const bool one = std::all_of(clusters_.begin(), clusters_.end(), [](std::uint32_t g) { return g == 0; });
    const auto groups = cut_overlapping_groups(clusters_, features, map_.graph, one && !graph);
    if (groups == field_groups_) return;
    field_groups_ = groups;
    influence_field_.emplace(input_.region, targets_, map_.graph, groups);
    groups_ = groups_of(*influence_field_, groups);
  }

  /// The warp of the embedding, and where it takes the vertices. With groups, a vertex is under the influence
  /// that its place in the image is under, which hangs on where the warp takes it: fixed-point steps from the
  /// last place (§3.7 of the design).
  void warp_points(const ImmersedDisc& disc, const Growth& growth, const std::vector<Vec2>& plane,
                   const std::vector<Vec2>& features) {
    find_influence(disc, growth);
    warp_ = build_warp(features, targets_, map_.graph, probes(features), groups_);
    const int refreshes = groups_.count == 1 ? 0 : settled_ ? most_refreshes : growing_refreshes;
    for (int refresh = 0; refresh <= refreshes; ++refresh) {
      if (refresh > 0) find_influence(disc, growth);
      const std::vector<Vec2> image = warp_all(warp_, plane, influence_);
      double moved = 0;
      for (std::size_t v = 0; v < image.size(); ++v) {
        Vec2& at = points_[PatchVertexId(v)].image;
        moved = std::max(moved, std::abs(image[v] - at));
        at = image[v];
      }
      if (moved < refreshed * input_.region.diameter()) break;
    }
  }

  void find_influence(const ImmersedDisc& disc, const Growth& growth) {
    if (groups_.count > 1)
      influence_ = influence_on_patch(disc, points_, input_.region, *influence_field_, growth.feature_faces(),
                                      groups_.of);
  }

  static Vec2 interpolate(const ImmersedDisc& disc, PatchFaceId q, const SurfacePoint& point,
                          const std::vector<Vec2>& plane) {
    Vec2 z = 0;
    for (int k = 0; k < 3; ++k) z += point.barycentric[k] * plane[disc.faces()[q].vertices[k].value];
    return z;
  }

  /// Where the features are in the plane.
  [[nodiscard]] std::vector<Vec2> feature_places(const ImmersedDisc& disc, const Growth& growth,
                                                 const std::vector<Vec2>& plane) const {
    std::vector<Vec2> places;
    for (std::size_t k = 0; k < targets_.size(); ++k)
      places.push_back(interpolate(disc, growth.feature_faces()[k], input_.features[k].surface, plane));
    return places;
  }

  /// Places between the features, where the warp bends most; with groups, vertices all over the patch.
  [[nodiscard]] std::vector<WarpProbe> probes(const std::vector<Vec2>& features) const {
    std::vector<WarpProbe> probes;
    if (groups_.count > 1) {
      const std::size_t stride = std::max<std::size_t>(1, points_.size() / 64);
      for (std::size_t v = 0; v < points_.size(); v += stride) {
        const auto influence = std::span(influence_).subspan(v * groups_.count, groups_.count);
        probes.push_back({points_[PatchVertexId(v)].plane, {influence.begin(), influence.end()}});
      }
      return probes;
    }
    for (const auto& [i, j] : map_.graph.planar)
      for (const double t : {0.25, 0.5, 0.75})
        probes.push_back({features[i] + t * (features[j] - features[i]), {}});
    const std::vector<Vec2>& polygon = input_.region.polygon();
    const std::size_t stride = std::max<std::size_t>(1, polygon.size() / 16);
    for (std::size_t i = 0; i < polygon.size(); i += stride) probes.push_back({polygon[i], {}});
    return probes;
  }

  /// The loop of §2.6 of the design: parameterize, peel, grow, until the region is covered. The conformal
  /// map, which costs a third of the isometric one, does while the patch is far from its final size. Where
  /// the region would meet itself it may have to go on over itself, one sheet more at a time.
  Result<void> grow(ImmersedDisc& disc, Growth& growth) {
    Energy energy = Energy::conformal;
    bool padded = false;
    int refinements = 0;
    while (true) {
      APPLIQUE_CHECK(parameterize(disc, growth, {energy, !padded}));
      if (options_.trace != nullptr) trace_step(disc, growth);
      StageTimer stage(map_.times.grow);
      if (map_.solves >= options_.max_solves || runs_over_itself(disc)) break;
      auto inside = growth.inside(points_);
      const std::size_t peeled = energy == Energy::conformal && !padded ? growth.peel(points_, inside) : 0;
      // Where the patch lies over itself, or may come to, each face counts. Else it may grow by a share of
      // its own size, which saves embeddings until the prediction fails, after some 70 to 100 rings; and what
      // is still to come of a patch that hardly changes, the margin brings as well.
      const bool exactly = padded || groups_.count > 1 || options_.overlap == Overlap::allow;
      const Growth::Limits limits{.share = exactly ? 0.0 : 1.0};
      const std::size_t added =
          growth.grow(points_, inside, scale_, limits) + growth.fill_pockets(points_, inside, scale_);
      const bool to_the_last = exactly && energy == attempt_.energy;
      const double settled = to_the_last ? 0 : few_changes * static_cast<double>(disc.faces().size());
      if (static_cast<double>(added + peeled) <= settled) {
        // Thin patches mislead: what they say of the features' order counts once the patch is grown.
        if (mirrored_) return fail_mirrored(surface_, input_);
        if (energy != attempt_.energy) {
          energy = attempt_.energy;
        } else if (padded) {
          if (energy == Energy::conformal || !shows_others(growth) || ++refinements > most_refinements) break;
        } else if (!grow_over_itself(disc, growth, inside)) {
          growth.pad(points_);
          padded = settled_ = true;
        }
      }
      growth.compact(points_);
      APPLIQUE_ASSERT(!checks_patch(options_) || disc.broken_invariant().empty());
    }
    growth_status_ = growth.coverage(points_);
    return {};
  }

  /// Whether paths that were taken to lie over one another have led to an image that covers itself in itself,
  /// which no more growth heals.
  [[nodiscard]] bool runs_over_itself(const ImmersedDisc& disc) const {
    if (!crossed_ || attempt_.crossings == Crossings::one_sheet || map_.solves <= trial_solves) return false;
    double area = 0;
    for (const PatchFace& face : disc.faces()) {
      const auto& v = face.vertices;
      const Vec2 a = points_[v[0]].image, b = points_[v[1]].image, c = points_[v[2]].image;
      if (input_.region.contains((a + b + c) / 3.0)) area += 0.5 * std::abs(cross(b - a, c - a));
    }
    return area > most_patch_cover * input_.region.area();
  }

  /// Whether the region stops at itself and may go on, unless the patch has run out of all proportion.
  [[nodiscard]] bool may_cover_more(const ImmersedDisc& disc, const Growth& growth) const {
    if (options_.overlap == Overlap::stop || growth.cover_limit() >= most_sheets ||
        growth.coverage(points_) != Coverage::clipped_by_cover)
      return false;
    double area = 0;
    for (const PatchFace& face : disc.faces()) {
      const auto& v = face.vertices;
      const Vec2 origin = points_[v[0]].plane;
      area += 0.5 * cross(points_[v[1]].plane - origin, points_[v[2]].plane - origin);
    }
    return area < most_patch_area * input_.region.area();
  }

  /// Lets the region go on over itself where it stops at itself and may, one sheet more. Returns whether that
  /// brings any faces. The energy stays what it is: the conformal map of a patch that winds round is far off.
  bool grow_over_itself(const ImmersedDisc& disc, Growth& growth, IdVector<PatchVertexId, char>& inside) {
    if (!may_cover_more(disc, growth)) return false;
    growth.set_cover_limit(growth.cover_limit() + 1);
    return growth.grow(points_, inside, scale_, {}) > 0;
  }

  /// The disc as a patch over the surface alone, without what bridges its holes.
  [[nodiscard]] Patch patch_of(const ImmersedDisc& disc) const {
    Patch patch;
    for (PatchFace face : disc.faces()) {
      if (bridged_.is_bridge(face.mesh_face)) face.mesh_face = FaceId();
      patch.faces.push_back(face);
    }
    for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count())) {
      const VertexId over = disc.mesh_vertex(v);
      patch.vertices.push_back(bridged_.is_bridge(over) ? VertexId() : over);
    }
    return patch;
  }

  void trace_step(const ImmersedDisc& disc, const Growth& growth) {
    SolveTrace::Step step;
    step.patch = patch_of(disc);
    for (const PatchPoint& point : points_) {
      step.plane.push_back(point.plane);
      step.image.push_back(point.image);
    }
    step.inside = growth.inside(points_);
    step.features = feature_places(disc, growth, step.plane.raw());
    step.contour = divided_contour();
    if (warp_.steps > 0) {
      std::vector<double> influence(groups_.count);
      for (Vec2& z : step.contour) {
        if (groups_.count > 1) influence_field_->at(z, influence);
        z = warp_.backward(z, influence);
      }
    }
    trace_.steps.push_back(std::move(step));
  }

  /// The region's polygon with its edges divided finely enough to show how they bend.
  [[nodiscard]] std::vector<Vec2> divided_contour() const {
    const std::vector<Vec2>& polygon = input_.region.polygon();
    std::vector<Vec2> contour;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
      const auto parts = static_cast<int>(1 + std::abs(edge) / (0.01 * input_.region.diameter()));
      for (int k = 0; k < parts; ++k) contour.push_back(polygon[i] + static_cast<double>(k) / parts * edge);
    }
    return contour;
  }

  /// The decal as it is: all of the map but its warnings.
  void describe(const ImmersedDisc& disc, const Growth& growth) {
    map_.patch = patch_of(disc);
    map_.textured.clear();
    map_.plane.clear();
    map_.image.clear();
    IdVector<PatchFaceId, char> shown = growth.shown(points_);
    const double left_out =
        groups_.count == 1 ? show_once(disc, points_, warp_, input_.region, growth.feature_faces(), shown)
                           : 0;
    map_.status =
        left_out > hardly_doubled ? std::max(growth_status_, Coverage::clipped_in_plane) : growth_status_;
    for (PatchFaceId q : ids<PatchFaceId>(shown.size()))
      map_.textured.push_back(map_.patch.faces[q].mesh_face.valid() && shown[q]);
    for (const PatchPoint& point : points_) {
      map_.plane.push_back(point.plane);
      map_.image.push_back(point.image);
    }
    map_.warp = warp_;
    map_.groups = groups_.count;
    map_.feature_groups = groups_.of;
    map_.influence = groups_.count == 1 ? std::vector<double>(map_.patch.vertices.size(), 1) : influence_;
    order_sheets(growth);
    map_.linear = linear_faces(map_, linear_tolerance_px / input_.region.frame().pixels_per_unit(),
                               growth.feature_faces());
    map_.quality = measure_quality(surface_, map_.patch, map_.plane, map_.image, map_.textured, map_.warp,
                                   input_.region, map_.influence);
    map_.quality.left_out = left_out;
    const std::vector<Vec2> places = feature_places(disc, growth, map_.plane.raw());
    for (std::size_t k = 0; k < targets_.size(); ++k) {
      const auto& corners = disc.faces()[growth.feature_faces()[k]].vertices;
      const std::vector<double> influence =
          map_.influence_at(corners, input_.features[k].surface.barycentric);
      map_.quality.feature_residual.push_back(std::abs(map_.warp(places[k], influence) - targets_[k]) *
                                              input_.region.frame().pixels_per_unit());
    }
    // Only beyond the region, then, could the patch have gone on.
    if (map_.quality.coverage > whole && map_.quality.doubled < hardly_doubled &&
        map_.status != Coverage::not_converged)
      map_.status = Coverage::covered;
  }

  void order_sheets(const Growth& growth) {
    std::vector<DepthFeature> features;
    for (std::size_t k = 0; k < targets_.size(); ++k)
      features.push_back({targets_[k], growth.feature_faces()[k], input_.features[k].depth});
    SheetOrder order = applique::order_sheets(map_.patch, map_.image, features, map_.graph.tree);
    map_.sheets = order.sheets;
    map_.depth = std::move(order.depth);
    map_.sheet = std::move(order.sheet);
  }

  void warn() {
    map_.warnings = quality_warnings(input_.name, map_, options_);
    const auto add = [&](const char* code, std::string message) {
      map_.warnings.push_back({code, fmt::format("decal '{}': {}", input_.name, message)});
    };
    if (unfolded_ > 0)
      add("unfolded",
          fmt::format("the exact warp turned {} triangles over; a map that turns none over, and is linear in "
                      "each triangle, took its place",
                      unfolded_));
    if (!at_fault_.empty()) {
      std::vector<std::string> names;
      for (const std::uint32_t k : at_fault_) names.push_back(feature_name(input_, k));
      add("features_fold",
          names.size() > 1
              ? fmt::format("{} force the image to fold: without them it would lie flat; move them, or check "
                            "that they are not swapped",
                            fmt::join(names, " and "))
              : fmt::format("{} forces the image to fold: without it it would lie flat; move it, or check "
                            "its place",
                            names.front()));
    }
    if (rung_ == EmbeddingRung::circle)
      add("embedding_on_circle", "the conformal map folded; a flip-free one took its place");
    for (Warning& warning : stress_warnings(input_, map_)) map_.warnings.push_back(std::move(warning));
  }

  const SurfaceMesh& surface_;
  const DecalInput& input_;
  const SolveOptions& options_;
  Attempt attempt_;
  bool crossed_ = false;
  BridgedSurface bridged_;
  std::vector<Vec2> targets_;  ///< Features in the image, plane units.
  PatchPoints points_;
  Warp warp_;
  bool settled_ = false;  ///< The patch is not going to grow any more.
  Coverage growth_status_ = Coverage::covered;
  bool mirrored_ = false;  ///< By the last embedding, the features run the other way round on the surface.
  std::vector<std::uint32_t> clusters_;  ///< Group by feature, as the image has them; once asked for.
  FeatureGroups groups_;
  std::vector<std::uint32_t> field_groups_;        ///< What influence_field_ was made of, be it one group.
  std::optional<InfluenceField> influence_field_;  ///< Of groups_, while there are several.
  std::vector<double> influence_;                  ///< [vertex * groups + group], while there are several.
  std::vector<double> weights_;  ///< By triangle, in the last embedding; empty: all the same.
  int weighed_ = 0;              ///< How often.
  EmbeddingRung rung_ = EmbeddingRung::conformal;
  std::size_t unfolded_ = 0;             ///< Triangles that were turned over before unfold().
  std::vector<std::uint32_t> at_fault_;  ///< Features that force a fold.
  double scale_ = 1;                     ///< Of the alignment, plane units per scene unit.
  std::optional<Seed> seed_;
  std::optional<Growth> growth_;
  DecalMap map_;
  SolveTrace trace_;
};

DecalSolver::DecalSolver(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options,
                         Attempt attempt)
    : work_(std::make_unique<Work>(surface, input, options, attempt)) {}

DecalSolver::~DecalSolver() = default;
DecalSolver::DecalSolver(DecalSolver&&) noexcept = default;
DecalSolver& DecalSolver::operator=(DecalSolver&&) noexcept = default;

Result<void> DecalSolver::run() {
  return work_->run();
}

void DecalSolver::unfold() {
  work_->unfold();
}

Result<DecalMap> DecalSolver::finish() {
  return work_->finish();
}

const DecalMap& DecalSolver::map() const {
  return work_->map();
}

double DecalSolver::patch_area() const {
  return work_->patch_area();
}

bool DecalSolver::crossed() const {
  return work_->crossed();
}

SolveTrace& DecalSolver::trace() {
  return work_->trace();
}

}  // namespace applique
