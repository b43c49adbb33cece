#include "applique/transfer/divide.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "applique/transfer/raster.h"

namespace applique {
namespace {

constexpr double part_texels = 2048;
constexpr int most_cuts = 64;          // a side
constexpr double mostly_shown = 0.25;  // of the face's rectangle

double area_of(const TexelBounds& bounds) {
  return (bounds.upper[0] - bounds.lower[0]) * (bounds.upper[1] - bounds.lower[1]);
}

/// Into how many parts the sides of a face are to be cut; 1: it stays as it is.
int cuts_of(const TransferFace& face, const std::optional<TexelBounds>& shown) {
  if (face.linear || !shown) return 1;
  const auto& t = face.texel;
  const auto [left, right] = std::minmax({t[0][0], t[1][0], t[2][0]});
  const auto [top, bottom] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const double texels = 0.5 * std::abs(doubled_area(t));
  if (!(texels > 4 * part_texels) || area_of(*shown) < mostly_shown * (right - left) * (bottom - top))
    return 1;
  int cuts = 1;
  while (cuts < most_cuts && texels > cuts * cuts * part_texels) cuts *= 2;
  return cuts;
}

/// The parts of a face, without their image points.
void add_parts(const TransferFace& face, int cuts, std::vector<TransferFace>& parts) {
  const auto part = [&](const std::array<std::array<int, 2>, 3>& corners) {
    TransferFace& made = parts.emplace_back(face);
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = static_cast<double>(corners[k][0]) / cuts,
                   v = static_cast<double>(corners[k][1]) / cuts;
      const auto mix = [&](const auto& a, const auto& b, const auto& c) {
        return (1 - u - v) * a + u * b + v * c;
      };
      for (std::size_t c = 0; c < 2; ++c)
        made.texel[k][c] = mix(face.texel[0][c], face.texel[1][c], face.texel[2][c]);
      made.plane[k] = mix(face.plane[0], face.plane[1], face.plane[2]);
      made.along[k] = mix(face.along[0], face.along[1], face.along[2]);
    }
  };
  for (int j = 0; j < cuts; ++j)
    for (int i = 0; i + j < cuts; ++i) {
      part({{{i, j}, {i + 1, j}, {i, j + 1}}});
      if (i + j + 1 < cuts) part({{{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}});
    }
}

}  // namespace

std::optional<Transfer> divide_faces(const Transfer& transfer) {
  if (transfer.warp == nullptr || transfer.warp->steps == 0 || transfer.warp->groups > 1) return std::nullopt;
  const auto shown = shown_parts(transfer);
  std::vector<TransferFace> whole, parts;
  for (std::size_t i = 0; i < transfer.faces.size(); ++i) {
    const TransferFace& face = transfer.faces[i];
    const int cuts = cuts_of(face, shown[i]);
    if (cuts > 1)
      add_parts(face, cuts, parts);
    else
      whole.push_back(face);
  }
  if (parts.empty()) return std::nullopt;
  std::vector<Vec2> corners;
  for (const TransferFace& part : parts) corners.insert(corners.end(), part.plane.begin(), part.plane.end());
  const std::vector<Vec2> images = warp_all(*transfer.warp, corners);
  for (std::size_t i = 0; i < parts.size(); ++i)
    std::copy_n(images.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, parts[i].image.begin());
  Transfer divided = transfer;
  divided.faces = std::move(whole);
  divided.faces.insert(divided.faces.end(), parts.begin(), parts.end());
  return divided;
}

}  // namespace applique
