#pragma once

#include <functional>
#include <vector>

#include "applique/image/image.h"

#include "mesh.h"

namespace applique::assets {

/// sRGB in [0, 1].
using Colour = Vec3;

/// The colour at a surface point; `shade` is the vertices' value there, interpolated.
using ColourField = std::function<Colour(const Vec3& position, const Vec3& normal, double shade)>;

/// An opaque RGB texture of size x size texels for an unwrapped mesh. `shades` has a value per vertex (or is
/// empty: 1 everywhere). Texels outside all charts take the nearest covered texel's colour.
Image paint_texture(const Mesh& mesh, const std::vector<double>& shades, int size, const ColourField& colour);

/// Gradient noise in [-1, 1], smooth, with features about one unit wide. After K. Perlin, 2002.
double noise(const Vec3& p);

/// `octaves` octaves of noise, each half the size and half the strength; about [-1, 1].
double fractal_noise(Vec3 p, int octaves);

}  // namespace applique::assets
