#pragma once

#include <vector>

#include "applique/gpu/camera.h"
#include "applique/gpu/device.h"
#include "applique/image/image.h"

#include "compare/comparison.h"

/// What a method did to a case: the image on the surface, and the texture coordinates (Figs. 21 and 22 of the
/// paper).
namespace applique::compare {

constexpr int picture_size = 300;  ///< Pixels, width and height.

/// What all methods' pictures of a case have in common.
struct CaseView {
  Camera camera;
  Image texture;  ///< A checkered image, cut out by the region, with a ring round each pin.
};

/// Looks at the map from above and a little from the right.
CaseView view_case(const Site& site, const DecalInput& input, const DecalMap& map);

/// The image on the surface, and a ball on the surface where each pin is: where the map meets its pins, balls
/// sit in their rings. Faces show the map linearly. Errors: device_failed.
Result<Image> picture_of_model(const Device& device, const Site& site, const DecalInput& input,
                               const DecalMap& map, const CaseView& view);

/// The patch's faces in the image. Colours are the face's L2 stretch, normalised by the map's areas: white 1,
/// vermilion 2 and more (the image is drawn out there), blue 1/2 and less; black is turned over. Each pin is
/// a ring, from which a line leads to where the map has it.
Image picture_of_coordinates(const Site& site, const DecalInput& input, const DecalMap& map);

/// Pictures of one size from above to below, or from left to right.
Image stack(const std::vector<Image>& pictures);
Image join(const std::vector<Image>& pictures);

}  // namespace applique::compare
