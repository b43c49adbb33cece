#include "applique/rivals/rival_solver.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "applique/base/stage_timer.h"
#include "applique/decal_input.h"
#include "applique/decal_warnings.h"
#include "applique/rivals/exponential_map.h"
#include "applique/rivals/planar_map.h"
#include "applique/rivals/stroke_map.h"

namespace applique {
namespace {

constexpr double missed_px = 1;
constexpr double whole = 0.999;  // of the region: what a map covers that does not meet itself

Result<RivalMap> map_surface(const SurfaceMesh& surface, const RivalTask& task, const SolveOptions& options) {
  switch (options.method) {
    case Method::planar:
      return project_planar(surface, task, options.planar);
    case Method::expmap:
      return map_exponential(surface, task, options.parents);
    default:
      return map_along_stroke(surface, task);
  }
}

class RivalSolver {
 public:
  RivalSolver(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options)
      : surface_(surface), input_(input), options_(options) {}

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
    const std::vector<Vec2> targets = targets_of(input_);
    APPLIQUE_CHECK(check_input(surface_, input_, targets));
    {
      StageTimer stage(map_.times.graph);
      map_.graph = build_feature_graph(input_.region, targets);
    }
    {
      StageTimer stage(map_.times.embed);
      APPLIQUE_TRY(const RivalTask task, make_task(surface_, input_));
      APPLIQUE_TRY(rival_, map_surface(surface_, task, options_));
      map_.solves = 1;
    }
    StageTimer stage(map_.times.quality);
    take_faces();
    measure(targets);
    if (options_.trace != nullptr) *options_.trace = {rival_.lines, {only_step()}};
    return check_coverage(input_, map_.quality.coverage);
  }

  /// Makes a patch of the faces whose image meets the region.
  void take_faces() {
    for (const FaceId f : rival_.faces) {
      const auto& [a, b, c] = surface_.faces[f];
      if (input_.region.meets_triangle(rival_.image.at(a), rival_.image.at(b), rival_.image.at(c)))
        take_face(f);
    }
    for (PatchFace& face : map_.patch.faces)
      for (int k = 0; k < 3; ++k) {
        const auto across = patch_faces_.find(surface_.neighbours[face.mesh_face][k]);
        if (across != patch_faces_.end()) face.neighbours[k] = across->second;
      }
    const std::size_t faces = map_.patch.faces.size();
    map_.plane = map_.image;
    map_.linear.resize(faces, true);
    map_.textured.resize(faces, true);
    map_.depth.resize(faces, 0);
    map_.sheet.resize(faces, 0);
    map_.influence.assign(map_.patch.vertices.size(), 1);
  }

  void take_face(FaceId f) {
    PatchFace face{f, {}, {}};
    for (int k = 0; k < 3; ++k) {
      const VertexId v = surface_.faces[f][k];
      const auto [entry, fresh] = patch_vertices_.try_emplace(v);
      if (fresh) {
        entry->second = map_.patch.vertices.push_back(v);
        map_.image.push_back(rival_.image.at(v));
      }
      face.vertices[k] = entry->second;
    }
    patch_faces_[f] = map_.patch.faces.push_back(face);
  }

  void measure(const std::vector<Vec2>& targets) {
    map_.quality = measure_quality(surface_, map_.patch, map_.plane, map_.image, map_.textured, map_.warp,
                                   input_.region);
    for (std::size_t k = 0; k < targets.size(); ++k)
      map_.quality.feature_residual.push_back(std::abs(rival_.features[k] - targets[k]) *
                                              input_.region.frame().pixels_per_unit());
    map_.status = coverage();
    map_.warnings = quality_warnings(input_.name, map_, options_);
    warn_of_missed_features();
  }

  /// Why the map ends where it ends inside the region.
  [[nodiscard]] Coverage coverage() const {
    Coverage worst = Coverage::covered;
    bool closed = true;
    for (const PatchFace& face : map_.patch.faces)
      for (int k = 0; k < 3; ++k) {
        if (face.neighbours[k].valid()) continue;
        closed = false;
        const Vec2 a = map_.image[face.vertices[(k + 1) % 3]], b = map_.image[face.vertices[(k + 2) % 3]];
        if (input_.region.meets_segment(a, b))
          worst =
              std::max(worst, surface_.neighbours[face.mesh_face][k].valid() ? Coverage::clipped_by_limits
                                                                             : Coverage::clipped_by_boundary);
      }
    // Without an end, what is not covered lies beyond where the map comes round to itself.
    if (worst == Coverage::covered && map_.quality.coverage < whole)
      return closed ? Coverage::clipped_closed : Coverage::clipped_by_cover;
    return worst;
  }

  void warn_of_missed_features() {
    const auto& residual = map_.quality.feature_residual;
    const auto worst = std::max_element(residual.begin(), residual.end());
    if (*worst <= missed_px) return;
    map_.warnings.push_back(
        {"features_missed",
         fmt::format(
             "decal '{}': \"{}\" meets one feature only and misses the others by up to {:.1f} px ({}); "
             "the default method meets all",
             input_.name, name_of(options_.method), *worst,
             feature_name(input_, static_cast<std::size_t>(worst - residual.begin())))});
  }

  /// All there is to trace: the patch as it is found.
  [[nodiscard]] SolveTrace::Step only_step() const {
    SolveTrace::Step step;
    step.patch = map_.patch;
    step.plane = map_.plane;
    step.image = map_.image;
    for (const Vec2 z : map_.image) step.inside.push_back(input_.region.contains(z));
    step.features = rival_.features;
    step.contour = input_.region.polygon();
    return step;
  }

  const SurfaceMesh& surface_;
  const DecalInput& input_;
  const SolveOptions& options_;
  RivalMap rival_;
  std::unordered_map<VertexId, PatchVertexId> patch_vertices_;
  std::unordered_map<FaceId, PatchFaceId> patch_faces_;
  DecalMap map_;
};

}  // namespace

bool is_rival(Method method) {
  return method == Method::planar || method == Method::expmap || method == Method::stroke;
}

Result<DecalMap> solve_decal_as_rival(const SurfaceMesh& surface, const DecalInput& input,
                                      const SolveOptions& options) {
  return RivalSolver(surface, input, options).run();
}

}  // namespace applique
