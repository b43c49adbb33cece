#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "applique/base/error.h"
#include "applique/base/types.h"
#include "applique/image/decal_image.h"
#include "applique/image/image.h"
#include "applique/warp/warp.h"

namespace applique {

/// A point of a texture, in texels: origin at its top-left corner, v down, the first texel's centre (0.5,
/// 0.5). Not yet wrapped: may lie outside the texture.
using Texel = std::array<double, 2>;

/// Twice the signed area of a triangle.
inline double doubled_area(const std::array<Texel, 3>& t) {
  return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]);
}

enum class WrapMode : std::uint32_t { repeat, clamp, mirror };
/// What a texel's values are: a colour (sRGB, composited in linear light), numbers as they are (roughness,
/// occlusion, …), or a tangent-space normal.
enum class Encoding : std::uint32_t { colour, data, normal };

/// The modes of W3C Compositing and Blending Level 1, and two more: `add` saturates at 1, `erase` takes away
/// alpha. Normals know two, normal and add (shaders/compositing.h has both sorts).
enum class BlendMode : std::uint32_t {
  normal,
  multiply,
  screen,
  overlay,
  darken,
  lighten,
  color_dodge,
  color_burn,
  hard_light,
  soft_light,
  difference,
  exclusion,
  hue,
  saturation,
  color,
  luminosity,
  add,
  erase
};

/// One patch triangle laid out in a texture. What is written at a texel depends on the exact map there: its
/// barycentrics in `texel` give a plane point from `plane`, which the warp carries to the image; where
/// `linear`, interpolating `image` does as well (to 0.02 px).
struct TransferFace {
  std::array<Texel, 3> texel;  ///< Either orientation.
  std::array<Vec2, 3> plane;
  std::array<Vec2, 3> image;  ///< The warp's image of `plane`, plane units (ImageFrame makes them pixels).
  /// For normals: by corner, the direction of the image's x in the texture's tangent frame (+x its tangent,
  /// +y its bitangent), of any length, and whether the image's y is a quarter turn clockwise from there.
  std::array<Vec2, 3> along = {1, 1, 1};
  bool reversed = false;
  bool linear = true;
  std::uint32_t sheet = 0;  ///< Rank by depth among the patch faces over one surface face: larger is above.
};

/// One decal's share of one texture. Its sheets are composited one after the other, the lowest first: a lower
/// one shows where an upper one is transparent. A sheet has no gutter where another sheet's faces go on.
struct Transfer {
  std::vector<TransferFace> faces;
  std::vector<std::array<Texel, 3>> foreign;  ///< UV triangles that use the texture and are not in `faces`.
  /// The same, of triangles that are to show what the faces' texels show: they keep no gutter out.
  std::vector<std::array<Texel, 3>> copies;
  const Warp* warp = nullptr;
  /// By face, corner and group of the warp, [(3 * face + corner) * groups + group]: what the warp is to be
  /// told at a place in the face, interpolated linearly. Empty when the warp has one group.
  std::vector<double> influence;
  const DecalImage* image = nullptr;
  double opacity = 1;
  BlendMode blend = BlendMode::normal;
  Encoding encoding = Encoding::colour;                     ///< Of the texture and of the image.
  std::array<bool, 4> channels = {true, true, true, true};  ///< Which of the texture's are written.
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  std::uint32_t gutter =
      16;  ///< Texels around the UV islands that are filled by extending the nearest face, <= 255.
  bool opaque = true;  ///< The material ignores the texture's alpha: colours blend as over opaque texels.
};

/// What a transfer did, and, when asked for, the image point of each covered texel. A texel counts once for
/// every sheet that has it.
struct TransferResult {
  std::uint64_t covered_texels = 0;  ///< Texels whose centre lies in a face.
  std::uint64_t gutter_texels = 0;   ///< Texels outside every island that were filled.
  std::uint64_t shared_texels = 0;   ///< Covered texels that a foreign triangle covers too (UV overlap).
  struct Sample {
    std::uint32_t x, y;  ///< The texel, wrapped.
    std::uint32_t sheet;
    Pixel image;
  };
  std::vector<Sample> samples;  ///< From the lowest sheet up, each row by row; empty unless asked for.
};

/// The double-precision CPU twin of GpuTransfer: composites the decal into `texture`, in place. Texels that
/// it does not change keep their value bit for bit.
TransferResult transfer_on_cpu(const Transfer& transfer, Image& texture, bool keep_samples = false);

}  // namespace applique
