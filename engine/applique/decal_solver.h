#pragma once

#include <limits>
#include <memory>

#include "applique/base/error.h"
#include "applique/decal.h"
#include "applique/patch/seed.h"

namespace applique {

/// What is taken for granted in an attempt at a decal.
struct Attempt {
  Crossings crossings;  ///< What paths are that cross on the surface.
  bool grouping;        ///< Whether features may move the image in groups.
  Energy energy;        ///< Of the grown patch.
  double most_area = std::numeric_limits<double>::infinity();  ///< Of the patch, scene units squared.
};

/// One attempt at a decal, with all that it takes: the seed, the growth, the embeddings and warps on the way.
/// `surface`, `input` and `options` must outlive it.
class DecalSolver {
 public:
  DecalSolver(const SurfaceMesh& surface, const DecalInput& input, const SolveOptions& options,
              Attempt attempt);
  ~DecalSolver();
  DecalSolver(DecalSolver&&) noexcept;
  DecalSolver& operator=(DecalSolver&&) noexcept;

  /// Grows a patch from the seed until it covers the region (§2 to §4.2, §6 of the design), and maps it. The
  /// input has been checked. Errors: features_disconnected, features_mirrored, not_solved, size_missing.
  Result<void> run();
  /// Where the embedding or the warp has turned triangles over: a map that turns none over and is linear in
  /// each of them takes the warp's place, if there is one. The last rung of the ladder (§4.3 of the design).
  void unfold();
  /// The map with its warnings, among them which features force it to fold; the end of the solver. Error:
  /// features_mirrored, of a map that folds because all of it would have to be turned over.
  Result<DecalMap> finish();

  /// As it is; without warnings.
  [[nodiscard]] const DecalMap& map() const;
  /// Of the patch, scene units squared.
  [[nodiscard]] double patch_area() const;
  /// Whether the seed's paths crossed, be it in one sheet.
  [[nodiscard]] bool crossed() const;
  /// What happened, if the options ask for a trace.
  [[nodiscard]] SolveTrace& trace();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// Triangles that a map turns over.
std::uint32_t folds(const DecalMap& map);

}  // namespace applique
