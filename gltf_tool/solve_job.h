#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "applique/base/error.h"
#include "applique/decal.h"
#include "applique/image/image.h"
#include "applique/region/region.h"
#include "applique/suggest.h"

#include "job.h"
#include "model.h"
#include "stopwatch.h"

namespace applique {

/// A decal of a job with everything that its geometry needed and gave.
struct SolvedDecal {
  DecalJob job;
  Image image;
  /// The surface it may use, which decals with the same limits share; its features are on it.
  std::shared_ptr<const ModelSurface> whole_surface;
  /// What its patch is over: the same, or divided where that is too coarse for the decal.
  std::shared_ptr<const ModelSurface> surface;
  Region region;
  std::vector<Feature> features;
  DecalMap map;
  std::optional<Suggestion> suggestion;  ///< Once asked for.
  SolveTrace trace;                      ///< Empty unless it was asked for.
  StageTimes times;
  std::vector<Warning> warnings;
};

/// Where the triangles of a part were before they got texture space of their own.
struct FormerTriangles {
  std::uint32_t part = 0;                             ///< The part that they were of, which kept the others.
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< By triangle: vertices of that part, which has them.
};

struct SolvedJob {
  Job job;
  Model model;
  std::vector<SolvedDecal> decals;                  ///< In the order of the job.
  std::map<std::uint32_t, FormerTriangles> former;  ///< By part; see separate_uvs.
  StageTimes times;
};

/// Told the name of each stage as it begins, and the share of the work that lies behind, 0..1.
using StageCallback = std::function<void(const std::string& stage, double done)>;

/// The geometry of a job, which `bake` and `check` share: loads the model and the images, cuts out the
/// regions, puts the features on the surface and solves the decals one after another, with a trace if wanted.
/// Errors: those of load_model, read_image, alpha_outline, Region::from_contour, resolve_place and
/// solve_decal, each naming the decal; feature_place_invalid for a node or material that the model does not
/// have (names the near ones); size_missing.
Result<SolvedJob> solve_job(const Job& job, const StageCallback& on_stage = {}, bool traced = false);

/// Looks for what would lower each decal's stretch: takes as long as to solve it once for each of its
/// features and some times more.
void suggest_features(SolvedJob& solved, const StageCallback& on_stage = {});

/// The indices of the elements of `array` ("nodes", "materials") that the references name; a name may stand
/// for several. `owner` begins the sentence of an error. Errors: feature_place_invalid.
Result<std::vector<std::size_t>> resolve_references(const std::vector<Reference>& references,
                                                    const Document& document, const std::string& array,
                                                    const std::string& owner);

}  // namespace applique
