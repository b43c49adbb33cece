#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/decal.h"
#include "applique/transfer/transfer.h"

#include "place.h"

namespace applique {

/// Which part of the image is stuck on: what "region" of the job file says.
struct ContourRegion {
  std::vector<Pixel> contour;  ///< At least three corners of one simple polygon.
};
struct AlphaRegion {
  double threshold = 0.5;  ///< Pixels with more alpha (0..1) belong to the region.
};
struct RectangleRegion {};  ///< The whole image.
/// Alpha at 0.5 if the image has transparency, else the rectangle.
struct AutomaticRegion {};
using RegionChoice = std::variant<AutomaticRegion, ContourRegion, AlphaRegion, RectangleRegion>;

enum class DecalOutput { bake, overlay };

/// What becomes of a baked decal on triangles whose texels other triangles show too, or that have none.
enum class UvConflict {
  separate,  ///< The triangles get texture space of their own.
  error,     ///< The job fails.
  share,     ///< The decal appears on the other triangles as well.
};

/// A pin as the job file states it.
struct JobFeature {
  Pixel image;
  Place place;
  double depth = 0;  ///< Larger where the decal is to lie on top of itself.
};

/// One entry of "decals".
struct DecalJob {
  std::string name;             ///< Unique in the job.
  std::filesystem::path image;  ///< Absolute, or relative to the working folder.
  bool mirrored = false;        ///< Left and right of the image are swapped.
  RegionChoice region;
  std::vector<JobFeature> features;  ///< At least one.
  std::vector<Reference> nodes;      ///< The decal keeps to these; empty: all.
  std::vector<Reference> materials;  ///< The decal keeps to these; empty: all.
  std::optional<double> size;        ///< The image's width in scene units, > 0; for a lone feature.
  std::optional<Vec3> up;            ///< Scene direction, not 0; for a lone feature.
  double opacity = 1;                ///< 0..1.
  BlendMode blend = BlendMode::normal;
  DecalOutput output = DecalOutput::bake;
  UvConflict uv_conflict = UvConflict::separate;
  std::optional<double> offset;  ///< Of an overlay, scene units, >= 0; left out: default_offset().
  Method method = Method::applique;
  PlanarLimits planar;                ///< Of Method::planar.
  Parents parents = Parents::upwind;  ///< Of Method::expmap.
  Energy energy = Energy::isometric;
  bool guide = false;  ///< As SolveOptions::guide.
  Overlap overlap = Overlap::stop;
};

/// A job file, version 1.
struct Job {
  std::filesystem::path path;    ///< The job file itself.
  std::filesystem::path model;   ///< Absolute, or relative to the working folder.
  int texture_size = 2048;       ///< Texels a side of textures that the job creates.
  std::vector<DecalJob> decals;  ///< At least one; later ones lie over earlier ones.
};

/// Reads and validates a job file. Errors: file_unreadable, json_invalid (line and column), schema_violation
/// (JSON pointer, what was found, what was expected; also two decals with one name, and options of a method
/// that the decal does not use).
Result<Job> load_job(const std::filesystem::path& path);

}  // namespace applique
