#pragma once

#include <array>
#include <vector>

#include "applique/base/error.h"

#include "model.h"
#include "overlay_layout.h"
#include "solve_job.h"

namespace applique {

/// What an overlay's material is made of.
struct OverlayLayers {
  /// The base colour's first, with the alpha of all. In the frame of the decal's image, of its size or a
  /// single texel.
  std::vector<OverlayPicture> pictures;
  double metallic = 0;                         ///< 1 beside a picture that has it.
  double roughness = 1;                        ///< Likewise.
  std::array<double, 3> emissive = {0, 0, 0};  ///< Linear light; likewise.
};

/// The layers of a decal as an overlay shows them. The alpha is that of the decal's image or mask, cut by the
/// region, times the base colour's own and both their opacities. It covers what the surface's material is
/// like altogether, so the other layers have none: where they let the ground through (their opacity, their
/// own alpha, their blend mode) they are composited here over what the materials under the decal make of the
/// slot, if that is one value for all of them: one from factors. Over a texture, or over several values,
/// they lie on the plain material that an overlay without layers has: flat, matt, no metal, dark.
///
/// Layers of one value become factors (an occlusion of one value, which glTF has no factor for, one texel).
///
/// Adds warnings to the decal: blend_ignored for a blend mode of the base colour, or of a layer over a ground
/// that is not one value; overlay_ground_unknown for a layer that lets such a ground through; and those of
/// DecalLayers. Errors: those of DecalLayers. The decal has a base colour.
Result<OverlayLayers> make_overlay_layers(const Model& model, SolvedDecal& decal);

}  // namespace applique
