#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/embed/disc_geometry.h"
#include "applique/embed/untangle.h"

namespace applique {

/// A map that is linear in each triangle and carries the features exactly.
struct Unfolded {
  std::vector<Vec2> image;  ///< By vertex.
  std::size_t flips = 0;    ///< Triangles that are turned over all the same.
};

/// The last rung of the ladder (§4.3 of the design): where the embedding or the warp has turned triangles of
/// the image over, the vertices round them are moved until none is, and no further than it takes. `image` is
/// where the map so far has the vertices, `scale` plane units per unit of the disc. Costs little more than
/// one pass over the faces and the vertices round those that are turned over.
Unfolded unfold_image(const DiscGeometry& disc, double scale, std::vector<Vec2> image,
                      std::span<const PlacedPoint> features);

}  // namespace applique
