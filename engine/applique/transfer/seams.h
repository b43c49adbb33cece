#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "applique/image/image.h"
#include "applique/transfer/transfer.h"

namespace applique {

/// A texture on the two sides of seams.
struct SeamTexture {
  Image* image = nullptr;
  const Image* before =
      nullptr;  ///< As it was before the decals: only texels that differ from it may change.
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  std::array<bool, 4> channels = {true, true, true, true};  ///< Which may change.
};

/// An edge of the surface where two triangles lie side by side but not their texture coordinates.
struct Seam {
  struct Side {
    std::uint32_t texture;  ///< Index of a SeamTexture.
    std::array<Texel, 2> ends;
    Texel apex;  ///< The triangle's other corner: texels on its side show, those beyond are gutter.
    /// Of normals, by end: where the frame's +x and +y, in which the texture has them, point in a plane that
    /// both sides share (x along the seam, say).
    std::array<std::array<Vec2, 2>, 2> axes = {{{Vec2(1, 0), Vec2(0, 1)}, {Vec2(1, 0), Vec2(0, 1)}}};
  };
  std::array<Side, 2>
      sides;  ///< The first ends of both are one point of the surface, the second ones another.
};

/// What a bilinear filter shows on either side of a seam, at places half a texel apart.
struct SeamSample {
  std::array<std::array<double, 4>, 2>
      colours;   ///< By side, 0 to 1: filtered in linear light, and encoded again. Of normals, x and y are in
                 ///< the plane that both sides share.
  bool changed;  ///< All texels that take part are other than before.
};
std::vector<SeamSample> sample_seams(std::span<const Seam> seams, std::span<const SeamTexture> textures,
                                     Encoding encoding);

/// How much the image's detail may give way to agreement across a seam. To agree everywhere, two sides whose
/// texels are out of step have to be smooth along the seam, which smears what crosses it.
enum class SeamFit {
  sharp,  ///< A texel changes by up to 3/255 where it shows, by up to 16/255 out in the gutter.
  exact,  ///< By as much as it takes: both sides come within 2/255 where all texels that take part may
          ///< change.
};

/// Brings what a bilinear filter shows on both sides of the seams together, by the smallest changes (least
/// squares) of the texels near them that the decals have changed. Normals are what agrees, not their texels,
/// which are in frames of their own.
void join_seams(std::span<const Seam> seams, std::span<const SeamTexture> textures, Encoding encoding,
                SeamFit fit = SeamFit::sharp);

}  // namespace applique
