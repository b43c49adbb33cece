#pragma once

#include "applique/image/image.h"

#include "mesh.h"

namespace applique::assets {

struct View {
  double azimuth;    ///< Degrees around y; 0 looks from +z.
  double elevation;  ///< Degrees.
  Vec3 target;
  double height;  ///< Scene units that fit the picture's height.
};

/// The mesh by parallel projection with simple light, for a quick look; `texture` may be null.
Image preview(const Mesh& mesh, const Image* texture, const View& view, int width, int height);

}  // namespace applique::assets
