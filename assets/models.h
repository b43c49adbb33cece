#pragma once

#include "applique/base/error.h"

#include "mesh.h"
#include "texture.h"

namespace applique::assets {

/// A model ready to be written: unwrapped mesh and base-colour texture.
struct Model {
  Mesh mesh;
  Image texture;
};

/// The bust of bust.h: about 40k triangles, `texture_size` texels a side, in warm marble.
Result<Model> make_bust(int texture_size);

/// The bust's mesh alone, without uvs: closed, one piece.
Mesh make_bust_mesh();

/// The bottle of bottle.h in green glass with a cork, 5k triangles.
Result<Model> make_bottle(int texture_size);

}  // namespace applique::assets
