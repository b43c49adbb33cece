#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/decal.h"
#include "applique/transfer/seams.h"
#include "applique/transfer/transfer.h"

#include "material.h"
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

/// Where several nodes show the mesh that a baked decal lies on: whether it is seen there only, or on all of
/// them.
enum class Instance { only_this, all };

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

/// What a decal does to one texture of the materials under it.
struct DecalLayer {
  std::string name = "baseColor";  ///< As "layers" calls it: "roughness".
  MaterialSlot slot = MaterialSlot::base_color;
  std::array<bool, 4> channels = {true, true, true, true};  ///< Of the texture, that it writes.
  bool scalar = false;          ///< The image's red goes into all of the channels.
  std::filesystem::path image;  ///< In the decal image's frame; empty: `value`, or the decal's image.
  std::optional<std::array<double, 3>> value;  ///< As the texture stores it, 0..1: colours are sRGB.
  double opacity = 1;                          ///< 0..1; that of the decal comes on top.
  BlendMode blend = BlendMode::normal;
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
  std::filesystem::path mask;        ///< Takes the place of the image's alpha; empty: none.
  std::vector<DecalLayer>
      layers;          ///< At most one for a texture's channel; the base colour's first, if there.
  double opacity = 1;  ///< 0..1.
  DecalOutput output = DecalOutput::bake;
  Instance instance = Instance::only_this;  ///< Of a baked decal.
  UvConflict uv_conflict = UvConflict::separate;
  std::optional<double> offset;  ///< Of an overlay, scene units, >= 0; left out: default_offset().
  Method method = Method::applique;
  PlanarLimits planar;                ///< Of Method::planar.
  Parents parents = Parents::upwind;  ///< Of Method::expmap.
  Energy energy = Energy::isometric;
  bool guide = true;  ///< As SolveOptions::guide.
  Overlap overlap = Overlap::stop;
};

/// As jobs call it: "color-burn".
const char* name_of(BlendMode mode);

/// How messages call a decal's layer and its mask: "decal 'crest': layer \"normal\"", "decal 'crest': mask".
std::string label_of(const DecalJob& decal, const DecalLayer& layer);
std::string mask_label_of(const DecalJob& decal);

/// When triangles under a decal that crosses UV seams are laid out anew, in one piece or in few.
enum class Unwrap {
  never,
  unseen,  ///< Where what the model's textures show there stays as it is.
  always,
};

/// A job file, version 1.
struct Job {
  std::filesystem::path path;   ///< The job file itself.
  std::filesystem::path model;  ///< Absolute, or relative to the working folder.
  int texture_size = 2048;      ///< Texels a side of base colours that the job creates.
  std::uint32_t gutter = 16;    ///< As Transfer::gutter.
  Unwrap unwrap = Unwrap::unseen;
  SeamFit seams = SeamFit::exact;  ///< Of seams that are left.
  std::optional<int>
      resolution;  ///< Texels a side of other textures that it creates; none: the base colour's.
  std::vector<DecalJob> decals;  ///< At least one; later ones lie over earlier ones.
};

/// The files that a job reads: itself, its model (not those that the model names) and its decals' images.
std::vector<std::filesystem::path> inputs_of(const Job& job);

/// Reads and validates a job file. Errors: file_unreadable, json_invalid (line and column), schema_violation
/// (JSON pointer, what was found, what was expected; also two decals with one name, options of a method that
/// the decal does not use, a decal without a layer, and an overlay without a base colour).
Result<Job> load_job(const std::filesystem::path& path);

}  // namespace applique
