#include "applique/decal.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "applique/decal_input.h"
#include "applique/decal_solver.h"
#include "applique/finer_surface.h"
#include "applique/paper/paper_solver.h"
#include "applique/rivals/rival_solver.h"

namespace applique {
namespace {

constexpr double bearably_stretched = 2;  // L2, in one sheet: of an image that lies over itself it is more
constexpr double much_stretched = 1.1;    // L2
constexpr double usual_margin = 0.08;     // of a patch's faces
constexpr double nearly_all = 0.99;       // of the region
constexpr double less_area[] = {0.5, 0.25, 0.1};  // of a patch that folds
constexpr double coarsely_stretched = 1.2;        // L2: finer triangles may help
constexpr double many_parts = 2;                  // times a patch's faces: fewer would change little
constexpr double some_gain = 1.005;               // times the worth: less is not worth the parts
constexpr double less_isometry = 0.6;             // where all is much stretched

/// How finely a surface is divided, and for what: the finest takes long.
struct Fineness {
  double share;   ///< Of the region's width: the edges.
  double enough;  ///< Of the region, to be shown: then it is not tried.
};
constexpr Fineness finenesses[] = {{0.5, 0.9999}, {0.25, 0.9999}, {0.125, nearly_all}};

/// Whether a map is injective.
bool is_sound(const DecalMap& map) {
  return folds(map) == 0 && map.quality.doubled < hardly_doubled && map.status != Coverage::not_converged;
}

/// Whether it is shown as far as it goes, too, without much of a stretch: then there is nothing to be sought.
bool is_bearable(const DecalMap& map) {
  return is_sound(map) && map.quality.left_out < hardly_doubled &&
         map.quality.l2_stretch < bearably_stretched;
}

/// Whether less than a share of it is shown, though the surface does not end there.
bool is_in_its_own_way(const DecalMap& map, double share) {
  return map.quality.coverage < share && map.status != Coverage::clipped_by_boundary;
}

/// What is shown of the region, against how much it is stretched there.
double worth(const DecalMap& map) {
  return std::min(map.quality.coverage, 1.0) / map.quality.l2_stretch;
}

/// Whether a map is to be preferred: one without folds or overlaps, then the one of more worth.
bool sounder(const DecalMap& a, const DecalMap& b) {
  if (is_sound(a) != is_sound(b)) return is_sound(a);
  if (folds(a) != folds(b)) return folds(a) < folds(b);
  return worth(a) > worth(b);
}

/// Whether a sound map is much stretched, and there is surface beyond the image that might be instead: more
/// of the patch than its margin, or what the image has no part of its own for.
bool may_stretch_elsewhere(const DecalMap& map) {
  const auto shown =
      std::count_if(map.textured.begin(), map.textured.end(), [](char shows) { return shows != 0; });
  const bool beyond =
      static_cast<double>(shown) < (1 - usual_margin) * static_cast<double>(map.textured.size());
  return is_sound(map) && map.quality.l2_stretch > much_stretched &&
         (beyond || map.quality.coverage < nearly_all);
}

/// The attempts at a decal over one surface, of which the soundest is kept.
class Attempts {
 public:
  Attempts(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options,
           bool unfolds = true)
      : surface_(surface), input_(input), options_(options), unfolds_(unfolds) {}

  /// Makes one after another, each where those before it give reason to.
  void make() {
    // Paths that cross on the surface may mean that the image lies over itself there, or that features were
    // moved past one another in one sheet: what comes out tells.
    const bool over_itself = options_.overlap == Overlap::allow;
    add({over_itself ? Crossings::overlap : Crossings::one_sheet, true, options_.energy});
    if (crossed_ && (best() == nullptr || !is_bearable(*best())))
      add({over_itself ? Crossings::one_sheet : Crossings::overlap, true, options_.energy});
    // Parts that only touch in the plane, not on the surface, or lie over one another because of features
    // that are moved past each other: it may be better without groups.
    const DecalMap* map = best();
    if (map != nullptr && map->groups > 1 &&
        (folds(*map) > 0 || (map->sheets == 1 && map->quality.l2_stretch > much_stretched)))
      add({Crossings::one_sheet, false, options_.energy});
    unfold();
    // All of a long closed surface, flattened, is beyond what numbers can tell apart: less of it is not.
    // Where there are several features, it is they that fold the image.
    map = best();
    if (map != nullptr && input_.features.size() == 1 && folds(*map) > 0) {
      const double area = solvers_.front().patch_area();
      for (const double share : less_area) add({Crossings::one_sheet, true, options_.energy, share * area});
      unfold();
    }
    // Where all is much stretched, lengths that cannot be kept lead the growth less astray when they count
    // less.
    map = best();
    if (map != nullptr && options_.energy != Energy::conformal && may_stretch_elsewhere(*map))
      add({crossed_ && map->sheets > 1 ? Crossings::overlap : Crossings::one_sheet, true,
           Energy{less_isometry * options_.energy.isometry}});
  }

  /// Whether smaller triangles may lead to more, where `enough` of the region need not.
  [[nodiscard]] bool may_gain(double enough) const {
    if (best() == nullptr) return outcome_.error().code == ErrorCode::not_solved;
    return !is_bearable(*best()) || is_in_its_own_way(*best(), enough) ||
           best()->quality.l2_stretch > coarsely_stretched;
  }

  /// Of the soundest's patch; 0 if all have failed.
  [[nodiscard]] std::size_t patch_faces() const { return best() == nullptr ? 0 : best()->patch.faces.size(); }

  /// Whether the others, over another surface, have led to more.
  [[nodiscard]] bool is_outdone_by(const Attempts& others) const {
    if (others.is_unsolved()) return false;
    if (is_unsolved()) return folds(*others.best()) == 0;
    if (is_sound(*others.best()) && is_sound(*best()))
      return worth(*others.best()) > some_gain * worth(*best());
    return sounder(*others.best(), *best());
  }

  /// The soundest; or the last error, if all have failed.
  Result<DecalMap> finish() {
    if (solvers_.empty()) return tl::unexpected(outcome_.error());
    // Why it cannot lie over itself, as its features ask, says more than a map that folds instead.
    if (is_unsolved()) return tl::unexpected(unmet_.error());
    DecalSolver& solver = solvers_.front();
    APPLIQUE_CHECK(check_coverage(input_, solver.map().quality.coverage));
    if (options_.trace != nullptr) *options_.trace = std::move(solver.trace());
    return solver.finish();
  }

 private:
  void add(const Attempt& attempt) {
    DecalSolver solver(surface_, input_, options_, attempt);
    outcome_ = solver.run();
    crossed_ = crossed_ || solver.crossed();
    if (outcome_)
      solvers_.push_back(std::move(solver));
    else if (outcome_.error().code == ErrorCode::not_solved)
      unmet_ = outcome_;
    rank();
  }

  /// Unfolds those that fold, the soundest first, until one is bearable. Over parts of triangles this takes
  /// long, and finer ones do without.
  void unfold() {
    if (!unfolds_) return;
    for (DecalSolver& solver : solvers_) {
      if (folds(solver.map()) > 0) solver.unfold();
      if (is_bearable(solver.map())) break;
    }
    rank();
  }

  /// The soundest first; sounder() does not order more than that.
  void rank() {
    for (std::size_t k = 1; k < solvers_.size(); ++k)
      if (sounder(solvers_[k].map(), solvers_[0].map())) std::swap(solvers_[k], solvers_[0]);
  }

  /// None while all have failed.
  [[nodiscard]] const DecalMap* best() const { return solvers_.empty() ? nullptr : &solvers_.front().map(); }
  [[nodiscard]] bool is_unsolved() const { return best() == nullptr || (folds(*best()) > 0 && !unmet_); }

  const SurfaceMesh& surface_;
  const DecalInput& input_;
  const SolveOptions& options_;
  bool unfolds_;
  std::vector<DecalSolver> solvers_;  ///< That have not failed, the soundest first.
  Result<void> outcome_;              ///< Of the last.
  Result<void> unmet_;                ///< Of the last that was not solved.
  bool crossed_ = false;              ///< Whether the seed's paths crossed in any of them.
};

/// The attempts over a divided surface.
class DividedAttempts {
 public:
  DividedAttempts(std::shared_ptr<const DividedSurface> divided, const DecalInput& input,
                  const SolveOptions& options)
      : divided_(std::move(divided)), input_(input), attempts_(divided_->mesh, input_, options, false) {
    for (Feature& feature : input_.features) feature.surface = divided_->to_part(feature.surface);
    attempts_.make();
  }

  [[nodiscard]] const Attempts& attempts() const { return attempts_; }

  Result<DecalMap> finish() {
    auto map = attempts_.finish();
    if (map) map->divided = divided_;
    return map;
  }

 private:
  std::shared_ptr<const DividedSurface> divided_;
  DecalInput input_;  ///< Its features are on the parts.
  Attempts attempts_;
};

}  // namespace

std::vector<double> DecalMap::influence_at(const std::array<PatchVertexId, 3>& corners,
                                           const std::array<double, 3>& barycentric) const {
  std::vector<double> at(groups, 0);
  for (int k = 0; k < 3; ++k)
    for (std::uint32_t g = 0; g < groups; ++g)
      at[g] += barycentric[k] * influence[corners[k].value * groups + g];
  return at;
}

const char* name_of(Method method) {
  switch (method) {
    case Method::applique:
      return "applique";
    case Method::paper:
      return "paper";
    case Method::planar:
      return "planar";
    case Method::expmap:
      return "expmap";
    case Method::stroke:
      return "stroke";
  }
  return "";
}

Result<DecalMap> solve_decal(const SurfaceMesh& surface, const DecalInput& input,
                             const SolveOptions& options) {
  if (is_rival(options.method)) return solve_decal_as_rival(surface, input, options);
  if (options.method == Method::paper) return solve_decal_as_paper(surface, input, options);
  APPLIQUE_CHECK(check_input(surface, input, targets_of(input), options.overlap));
  Attempts attempts(surface, input, options);
  attempts.make();
  // Paths and turns that share a coarse model's triangles may have their own in a finer one.
  const Attempts* best = &attempts;
  std::unique_ptr<DividedAttempts> best_divided;
  const double least_parts = many_parts * static_cast<double>(attempts.patch_faces());
  for (const auto& [share, enough] : finenesses) {
    if (!options.divide || !best->may_gain(enough) || least_parts > Division::most_parts) break;
    auto finer = finer_surface(surface, input, share);
    if (finer == nullptr ||
        static_cast<double>(finer->mesh.faces.size() - surface.faces.size()) < least_parts)
      continue;
    auto tried = std::make_unique<DividedAttempts>(std::move(finer), input, options);
    if (!best->is_outdone_by(tried->attempts())) continue;
    best_divided = std::move(tried);
    best = &best_divided->attempts();
  }
  return best_divided != nullptr ? best_divided->finish() : attempts.finish();
}

}  // namespace applique
