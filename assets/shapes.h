#pragma once

#include "models.h"

/// Models of simple shapes for the gallery, with the seams and edges that simple shapes have. Texture
/// coordinates are straight: the whole texture lies over the shape once.
namespace applique::assets {

/// A drum about the y axis, without lids: radius 0.5, from y = -0.6 to 0.6; its seam is at the back (-z).
Model make_drum(int texture_size);
/// A point of the drum, `turn` radians from the front (+z) towards +x.
Vec3 drum_point(double turn, double y);

/// Three steps of sharp edges and a slope: treads and risers 0.4 deep and high, 1.6 wide.
Model make_stairs(int texture_size);
/// The point of the stairs at `along` (from the foot of the lowest riser, over the edges, scene units) and x.
Vec3 stairs_point(double along, double x);

}  // namespace applique::assets
