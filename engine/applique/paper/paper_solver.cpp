#include "applique/paper/paper_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "applique/base/predicates.h"
#include "applique/base/stage_timer.h"
#include "applique/decal_input.h"
#include "applique/decal_warnings.h"
#include "applique/embed/align.h"
#include "applique/paper/convex_graph.h"
#include "applique/paper/face_regions.h"
#include "applique/paper/forward_warp.h"
#include "applique/paper/graph_paths.h"
#include "applique/paper/initial_map.h"
#include "applique/paper/lscm.h"
#include "applique/paper/paper_seed.h"
#include "applique/paper/patch_update.h"
#include "applique/paper/region_walk.h"
#include "applique/patch/sheets.h"
#include "applique/region/clusters.h"
#include "applique/region/influence.h"

namespace applique {
namespace {

constexpr int solves_per_allowed = 10;        // one strip each, where solve_decal adds many rings
constexpr double smallest_lambda = 1.0 / 64;  // of the way to the final positions
constexpr int most_rollbacks_in_vain = 3;     // in a row

class PaperSolver {
 public:
  PaperSolver(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options)
      : surface_(surface), bridged_(surface), input_(input), options_(options), targets_(targets_of(input)) {}

  Result<DecalMap> run() {
    double total = 0;
    {
      StageTimer timer(total);
      APPLIQUE_CHECK(solve());
    }
    map_.times.total = total;
    return std::move(map_);
  }

 private:
  Result<void> solve() {
    APPLIQUE_CHECK(check_input(surface_, input_, targets_));
    APPLIQUE_CHECK(build_graph());
    APPLIQUE_TRY(PaperSeed seed, build_seed());
    prepare_warp();
    APPLIQUE_CHECK(grow(seed));
    finish(seed);
    return {};
  }

  Result<void> build_graph() {
    StageTimer stage(map_.times.graph);
    if (targets_.size() < 2)
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': the paper's method warps by pairs of features, and there is one "
                              "only; pin a second one",
                              input_.name));
    map_.graph = build_feature_graph(input_.region, targets_);
    if (!map_.graph.artificial.empty()) {
      const auto [i, j] = map_.graph.artificial[0];
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': the contour lies between {} and {}, and no others join them: {}",
                              input_.name, feature_name(input_, i), feature_name(input_, j),
                              ask_for_feature(input_, place_that_joins(targets_[i], targets_[j]))));
    }
    graph_ = build_convex_graph(targets_, map_.graph);
    return {};
  }

  /// Among places of the region, the one that sees both points by the shortest way; if none does, the one
  /// that `a` sees and that is nearest to b.
  [[nodiscard]] Vec2 place_that_joins(Vec2 a, Vec2 b) const {
    constexpr int places = 64;
    const Region& region = input_.region;
    std::pair<bool, double> best = {true, std::numeric_limits<double>::infinity()};
    Vec2 found = a;
    for (int y = 0; y <= places; ++y)
      for (int x = 0; x <= places; ++x) {
        const Vec2 z(2.0 * x / places - 1, 2.0 * y / places - 1);
        if (!region.contains(z) || !region.contains_segment(a, z)) continue;
        const std::pair<bool, double> score = {!region.contains_segment(z, b),
                                               std::abs(z - b) + std::abs(z - a)};
        if (score >= best) continue;
        best = score;
        found = z;
      }
    return found;
  }

  Result<PaperSeed> build_seed() {
    StageTimer stage(map_.times.seed);
    APPLIQUE_TRY(features_, snap_features(surface_, input_, map_.warnings));
    APPLIQUE_TRY(const GraphPaths paths, trace_graph_paths(surface_, input_, features_, graph_));
    APPLIQUE_TRY(const auto regions, find_face_regions(surface_, input_, features_, graph_, paths));
    APPLIQUE_TRY(PaperSeed seed, build_paper_seed(bridged_, input_, features_, graph_, paths, regions));
    plane_ = map_seed(seed, features_, graph_, paths);
    if (options_.trace != nullptr) {
      *options_.trace = {};
      for (const std::vector<VertexId>& path : paths) {
        std::vector<Vec3>& line = options_.trace->paths.emplace_back();
        for (VertexId v : path) line.push_back(surface_.positions[v]);
      }
    }
    return seed;
  }

  /// What stays the same of the warp from one embedding to the next.
  void prepare_warp() {
    StageTimer stage(map_.times.warp);
    const std::vector<std::uint32_t> group = cluster_features(input_.region, targets_, map_.graph);
    field_.emplace(input_.region, targets_, map_.graph, group);
    region_.image = &field_->triangulation();
    warp_ = {targets_, {}, map_.graph.visible, field_->groups(), group};
    for (std::uint32_t point = 0; point < region_.image->points.size(); ++point) {
      const std::span<const double> at = field_->at_point(point);
      influence_.insert(influence_.end(), at.begin(), at.end());
    }
    // The pins of the embedding: the two features that are furthest apart in the image.
    for (std::uint32_t i = 0; i < targets_.size(); ++i)
      for (std::uint32_t j = i + 1; j < targets_.size(); ++j)
        if (std::abs(targets_[j] - targets_[i]) > std::abs(targets_[pins_[1]] - targets_[pins_[0]]))
          pins_ = {i, j};
  }

  /// The flow chart, Fig. 19, from the seed's initial map in `plane_` on.
  Result<void> grow(PaperSeed& seed) {
    std::uint32_t sheets = 1;
    for (const PatchFace& face : seed.disc.faces())
      sheets = std::max(sheets, seed.disc.cover(face.mesh_face));
    cover_limit_ = sheets;
    PatchUpdate update(seed.disc, seed.features, input_.region, cover_limit_);
    std::optional<std::uint32_t> first = 0;
    int in_vain = 0;
    while (true) {
      const std::vector<Vec2> previous = plane_;
      APPLIQUE_TRY(const std::vector<Vec2> final, embed(seed));
      // (a) and (b): the largest part of the way that leaves the patch in one piece.
      double lambda = 1;
      APPLIQUE_CHECK(warp_and_locate(seed, final, first));
      while (!located_.missed.empty() && lambda > smallest_lambda) {
        lambda /= 2;
        std::vector<Vec2> between = previous;
        for (std::size_t v = 0; v < between.size(); ++v) between[v] += lambda * (final[v] - previous[v]);
        APPLIQUE_CHECK(warp_and_locate(seed, between, first));
      }
      if (located_.missed.empty()) {
        in_vain = 0;
      } else {
        lambda = 0;
        APPLIQUE_CHECK(warp_and_locate(seed, previous, std::nullopt));
        if (++in_vain == most_rollbacks_in_vain) give_up_rollback(first);
      }
      record(seed, lambda);
      if (map_.solves >= solves_per_allowed * options_.max_solves) break;

      StageTimer stage(map_.times.grow);
      const std::size_t removed = update.remove_outside(located_);                     // (c), (d)
      const std::size_t added = lambda == 1 ? update.add_strip(located_, plane_)       // (e)
                                            : update.widen_bridges(located_, plane_);  // (f)
      if (lambda == 1 && removed + added == 0) break;
      update.compact(plane_);
      APPLIQUE_ASSERT(!checks_patch(options_) || seed.disc.broken_invariant().empty());
    }
    return {};
  }

  void give_up_rollback(std::optional<std::uint32_t>& first) {
    first.reset();
    map_.warnings.push_back(
        {"rollback_in_vain",
         fmt::format("decal '{}': the patch falls apart between the features even next to its last place; "
                     "it is kept together by not removing what joins them",
                     input_.name)});
  }

  /// The final positions of the patch, aligned with the image.
  Result<std::vector<Vec2>> embed(const PaperSeed& seed) {
    StageTimer stage(map_.times.embed);
    ++map_.solves;
    std::vector<Vec2> plane = solve_lscm(measure_disc(seed.disc), plane_,
                                         {seed.features[pins_[0]].value, seed.features[pins_[1]].value})
                                  .plane;
    if (!std::all_of(plane.begin(), plane.end(), [](Vec2 z) { return std::isfinite(std::norm(z)); }))
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': the conformal embedding has no solution", input_.name));
    if (is_mirrored(features_in(seed, plane), targets_)) return fail_mirrored(surface_, input_);
    return plane;
  }

  [[nodiscard]] static std::vector<Vec2> features_in(const PaperSeed& seed, const std::vector<Vec2>& plane) {
    std::vector<Vec2> places;
    for (PatchVertexId v : seed.features) places.push_back(plane[v.value]);
    return places;
  }

  /// Takes `plane`, aligned, as the patch's positions: plane_, warp_, warped_ and located_.
  Result<void> warp_and_locate(const PaperSeed& seed, std::vector<Vec2> plane,
                               std::optional<std::uint32_t> first) {
    const Similarity align = fit_similarity(features_in(seed, plane), targets_);
    for (Vec2& z : plane) z = align(z);
    plane_ = std::move(plane);
    warp_.to = features_in(seed, plane_);
    if (const std::size_t pair = colliding_pair(warp_); pair < warp_.pairs.size()) {
      const auto [i, j] = warp_.pairs[pair];
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': {} and {} come to one place on their straight way to the surface, "
                              "where the paper's warp is not defined: {}",
                              input_.name, feature_name(input_, i), feature_name(input_, j),
                              ask_for_feature(input_, 0.5 * (targets_[i] + targets_[j]))));
    }
    {
      StageTimer stage(map_.times.warp);
      region_.plane = warp_forward(warp_, region_.image->points, influence_);
      for (std::size_t k = 0; k < targets_.size(); ++k)
        region_.plane[region_.image->features[k]] = warp_.to[k];  // exactly
    }
    StageTimer stage(map_.times.grow);
    located_ = locate_patch(seed.disc, seed.features, plane_, region_, first);
    return {};
  }

  void record(const PaperSeed& seed, double lambda) {
    if (options_.trace == nullptr) return;
    SolveTrace::Step step;
    step.patch = patch_of(seed.disc);
    step.plane = IdVector<PatchVertexId, Vec2>(plane_);
    step.image = located_.image;
    step.inside = located_.inside;
    step.features = warp_.to;
    // The polygon's vertices are the first points of the triangulation.
    const auto corners = static_cast<std::ptrdiff_t>(input_.region.polygon().size());
    step.contour.assign(region_.plane.begin(), region_.plane.begin() + corners);
    step.lambda = lambda;
    options_.trace->steps.push_back(std::move(step));
  }

  [[nodiscard]] static Patch patch_of(const ImmersedDisc& disc) {
    Patch patch;
    for (const PatchFace& face : disc.faces()) patch.faces.push_back(face);
    for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count()))
      patch.vertices.push_back(disc.mesh_vertex(v));
    return patch;
  }

  void finish(const PaperSeed& seed) {
    StageTimer stage(map_.times.quality);
    map_.patch = patch_of(seed.disc);
    map_.plane = IdVector<PatchVertexId, Vec2>(plane_);
    map_.image = located_.image;
    const std::size_t faces = map_.patch.faces.size();
    map_.linear.resize(faces, true);
    order_sheets(seed);
    map_.influence.assign(map_.patch.vertices.size(), 1);
    std::uint32_t flipped = 0;
    for (const PatchFace& face : map_.patch.faces) {
      const auto& v = face.vertices;
      const Vec2 a = map_.image[v[0]], b = map_.image[v[1]], c = map_.image[v[2]];
      const bool textured = input_.region.meets_triangle(a, b, c);
      map_.textured.push_back(textured);
      flipped += textured && orientation(a, b, c) <= 0 ? 1 : 0;
    }
    map_.quality = measure_quality(surface_, map_.patch, map_.plane, map_.image, map_.textured, map_.warp,
                                   input_.region);
    map_.quality.flipped_image = flipped;  // the faces are all there is of the map
    for (std::size_t k = 0; k < targets_.size(); ++k)
      map_.quality.feature_residual.push_back(std::abs(image_of_feature(seed, k) - targets_[k]) *
                                              input_.region.frame().pixels_per_unit());
    map_.status = coverage(seed);
    for (Warning& warning : quality_warnings(input_.name, map_, options_))
      map_.warnings.push_back(std::move(warning));
  }

  void order_sheets(const PaperSeed& seed) {
    std::vector<DepthFeature> features;
    for (std::size_t k = 0; k < targets_.size(); ++k)
      features.push_back({targets_[k], seed.disc.fan(seed.features[k]).front(), input_.features[k].depth});
    SheetOrder order = applique::order_sheets(map_.patch, map_.image, features, map_.graph.tree);
    map_.sheets = order.sheets;
    map_.depth = std::move(order.depth);
    map_.sheet = std::move(order.sheet);
  }

  /// Where the feature's own place, which may be off its vertex, has come to.
  [[nodiscard]] Vec2 image_of_feature(const PaperSeed& seed, std::size_t k) const {
    const SurfacePoint& place = input_.features[k].surface;
    for (PatchFaceId q : seed.disc.fan(seed.features[k])) {
      const PatchFace& face = seed.disc.faces()[q];
      if (face.mesh_face != place.face) continue;
      Vec2 image = 0;
      for (int c = 0; c < 3; ++c) image += place.barycentric[c] * map_.image[face.vertices[c]];
      return image;
    }
    return map_.image[seed.features[k]];
  }

  [[nodiscard]] Coverage coverage(const PaperSeed& seed) const {
    ImmersedDisc disc = seed.disc;
    PatchPoints points;
    for (PatchVertexId v : ids<PatchVertexId>(disc.vertex_count()))
      points.push_back({map_.plane[v], map_.image[v]});
    return Growth(disc, {}, input_.region, cover_limit_).coverage(points);
  }

  const SurfaceMesh& surface_;
  BridgedSurface bridged_;
  const DecalInput& input_;
  const SolveOptions& options_;
  std::vector<Vec2> targets_;  ///< Features in the image, plane units.
  std::vector<VertexFeature> features_;
  ConvexGraph graph_;
  std::optional<InfluenceField> field_;  ///< Of the groups, in the image.
  std::vector<double> influence_;        ///< [point of its triangulation * groups + group]
  std::array<std::uint32_t, 2> pins_ = {0, 0};
  std::uint32_t cover_limit_ = 1;
  ForwardWarp warp_;
  std::vector<Vec2> plane_;  ///< By patch vertex.
  WarpedRegion region_;
  LocatedPatch located_;
  DecalMap map_;
};

}  // namespace

Result<DecalMap> solve_decal_as_paper(const SurfaceMesh& surface, const DecalInput& input,
                                      const SolveOptions& options) {
  return PaperSolver(surface, input, options).run();
}

}  // namespace applique
