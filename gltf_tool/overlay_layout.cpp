#include "overlay_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "applique/base/parallel.h"

#include "compositing.h"
#include "instances.h"

namespace applique {
namespace {

constexpr double margin = 16;  // texels: the picture ends in nothing up to mip level 4

Eigen::Vector2d in_pixels(const ImageFrame& frame, Vec2 place) {
  const Pixel pixel = frame.to_pixel(place);
  return {pixel.x, pixel.y};
}

/// A chart of the plane's part under the image.
OverlayChart bent_chart(const SolvedDecal& decal, const DecalMesh& divided) {
  Eigen::AlignedBox2d box;
  for (const DecalMesh::Origin& origin : divided.origins) {
    Vec2 place = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (origin.weights[k] != 0) place += origin.weights[k] * decal.map.plane[origin.vertices[k]];
    box.extend(in_pixels(decal.region.frame(), place));
  }
  // Finer than the image, so that bending it costs no detail, within reason.
  constexpr double finer = 2, large = 2048, largest = 8192;
  const double longest = box.sizes().maxCoeff();
  OverlayChart chart = {.frame = decal.region.frame(), .warp = &decal.map.warp};
  chart.density = std::min({finer, std::max(1.0, large / longest), largest / longest});
  chart.origin = box.min().array() - margin / chart.density;
  const Eigen::Vector2d texels = chart.density * box.sizes();
  chart.width = static_cast<int>(std::ceil(texels.x() + 2 * margin));
  chart.height = static_cast<int>(std::ceil(texels.y() + 2 * margin));
  return chart;
}

/// The image itself, with a margin.
OverlayChart straight_chart(const ImageFrame& frame, double border) {
  return {.frame = frame,
          .origin = {-border, -border},
          .width = static_cast<int>(frame.width + 2 * border),
          .height = static_cast<int>(frame.height + 2 * border)};
}

/// The image at a place in pixels, bilinear; outside it is transparent, with the colours of its border.
std::array<std::uint16_t, 4> sample(const Image& image, const Eigen::Vector2d& place) {
  const double left = std::floor(place.x() - 0.5), top = std::floor(place.y() - 0.5);
  const double across = place.x() - 0.5 - left, down = place.y() - 0.5 - top;
  Eigen::Vector3d colour = Eigen::Vector3d::Zero(), plain = Eigen::Vector3d::Zero();
  double alpha = 0;
  for (int k = 0; k < 4; ++k) {
    const double weight = (k % 2 == 0 ? 1 - across : across) * (k / 2 == 0 ? 1 - down : down);
    const double x = left + k % 2, y = top + k / 2;  // NOLINT(bugprone-integer-division)
    const double near_x = std::clamp(x, 0.0, image.width - 1.0);
    const double near_y = std::clamp(y, 0.0, image.height - 1.0);
    const std::uint16_t* pixel = image.pixel(static_cast<int>(near_x), static_cast<int>(near_y));
    const double shown = x == near_x && y == near_y ? weight * pixel[3] : 0;
    const Eigen::Vector3d rgb(pixel[0], pixel[1], pixel[2]);
    plain += weight * rgb;
    colour += shown * rgb;
    alpha += shown;
  }
  colour = alpha > 0 ? Eigen::Vector3d(colour / alpha) : plain;
  const auto stored = [](double value) { return static_cast<std::uint16_t>(std::lround(value)); };
  return {stored(colour.x()), stored(colour.y()), stored(colour.z()), stored(alpha)};
}

/// Where the image is at the centres of a row of the chart's texels, in pixels, and at one more.
std::vector<Eigen::Vector2d> places_of_row(const OverlayChart& chart, std::size_t y) {
  std::vector<Eigen::Vector2d> places;
  for (int x = 0; x <= chart.width; ++x) {
    const Eigen::Vector2d place =
        chart.origin + Eigen::Vector2d(x + 0.5, static_cast<double>(y) + 0.5) / chart.density;
    places.push_back(
        chart.warp == nullptr
            ? place
            : in_pixels(chart.frame, (*chart.warp)(chart.frame.to_plane({place.x(), place.y()}))));
  }
  return places;
}

/// Turns a stored normal from the image's frame into the picture's; the image moves by so much from texel to
/// texel.
void turn_normal(const Eigen::Vector2d& by_x, const Eigen::Vector2d& by_y, std::uint16_t* texel) {
  // Along the image's x, with y up in both: the first column of the inverse Jacobian.
  const double turn = by_x.x() * by_y.y() - by_x.y() * by_y.x() < 0 ? -1 : 1;
  const double x = turn * by_y.y(), y = turn * by_x.y(), length = std::hypot(x, y);
  if (length == 0) return;
  const compositing::vec2 along(x / length, y / length), across(-turn * along.y, turn * along.x);
  const compositing::vec4 own(texel[0] / 65535.0, texel[1] / 65535.0, texel[2] / 65535.0, 1);
  const compositing::vec4 turned =
      compositing::composite_normal(compositing::blend_normal, own, own, along, across);
  for (int c = 0; c < 3; ++c) texel[c] = static_cast<std::uint16_t>(std::lround(65535 * turned[c]));
}

/// Whether an image is its own picture.
bool shows_itself(const OverlayChart& chart, const OverlayPicture& picture) {
  const auto& [slot, image] = picture;
  const bool constant = slot != MaterialSlot::base_color && image.width == 1 && image.height == 1;
  return constant || (chart.warp == nullptr && image.width == chart.width && image.height == chart.height);
}

/// Texture coordinates of whole faces: their vertices' places in the chart.
void lay_into(DecalMesh& mesh, const ImageFrame& frame, const IdVector<PatchVertexId, Vec2>& places,
              const OverlayChart& chart) {
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    const Eigen::Vector2d texel =
        chart.density * (in_pixels(frame, places[mesh.origins[i].vertices[0]]) - chart.origin);
    mesh.uvs[i] = {texel.x() / chart.width, texel.y() / chart.height};
  }
}

}  // namespace

OverlayLayout lay_out_overlay(const Model& model, const SolvedDecal& decal, double offset) {
  const ImageFrame& frame = decal.region.frame();
  DecalMesh divided = build_overlay_mesh(model, decal, offset);
  const bool on_skin = lies_on_skin(decal, model);
  if (divided.triangles.empty() || decal.map.groups > 1 || !on_skin)
    return {std::move(divided), straight_chart(frame, 0), on_skin};
  DecalMesh whole = build_whole_mesh(model, decal, offset);
  const bool straight = is_linear(model, decal);
  const OverlayChart chart = straight ? straight_chart(frame, margin) : bent_chart(decal, divided);
  lay_into(whole, frame, straight ? decal.map.image : decal.map.plane, chart);
  return {std::move(whole), chart, false};
}

std::vector<OverlayPicture> draw_pictures(const OverlayChart& chart, std::span<const OverlayPicture> images) {
  std::vector<OverlayPicture> pictures;
  bool drawn = false;
  for (const OverlayPicture& image : images) {
    if (shows_itself(chart, image)) {
      pictures.push_back(image);
      continue;
    }
    drawn = true;
    Image picture = make_image(chart.width, chart.height, {0, 0, 0, 65535});
    picture.channels = image.image.channels;
    picture.bits = image.image.bits;
    pictures.push_back({image.slot, std::move(picture)});
  }
  if (!drawn) return pictures;
  const auto draw_row = [&](int y, const auto& here, const auto& below) {
    for (std::size_t i = 0; i < images.size(); ++i) {
      auto& [slot, picture] = pictures[i];
      if (shows_itself(chart, images[i])) continue;
      for (int x = 0; x < chart.width; ++x) {
        const auto k = static_cast<std::size_t>(x);
        std::uint16_t* texel = picture.pixel(x, y);
        std::copy_n(sample(images[i].image, here[k]).begin(), picture.has_alpha() ? 4 : 3, texel);
        if (slot == MaterialSlot::normal && chart.warp != nullptr)
          turn_normal(here[k + 1] - here[k], below[k] - here[k], texel);
      }
    }
  };
  constexpr std::size_t rows_at_once = 32;
  parallel_ranges(static_cast<std::size_t>(chart.height), rows_at_once,
                  [&](std::size_t first, std::size_t last) {
                    auto here = places_of_row(chart, first);
                    for (std::size_t y = first; y < last; ++y) {
                      auto below = places_of_row(chart, y + 1);
                      draw_row(static_cast<int>(y), here, below);
                      here = std::move(below);
                    }
                  });
  return pictures;
}

}  // namespace applique
