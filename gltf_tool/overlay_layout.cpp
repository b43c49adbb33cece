#include "overlay_layout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "applique/base/parallel.h"

namespace applique {
namespace {

bool lies_on_skin(const Model& model, const SolvedDecal& decal) {
  const auto& nodes = model.document.json.at("nodes");
  return std::any_of(decal.map.patch.faces.begin(), decal.map.patch.faces.end(), [&](const PatchFace& face) {
    return face.mesh_face.valid() &&
           nodes.at(model.parts[decal.surface->source(face.mesh_face).part].node).contains("skin");
  });
}

/// The plane's picture: its texel (x, y) shows the place `origin` + (x, y) / density, in pixels of the image
/// before it is bent.
struct Chart {
  Eigen::Vector2d origin;
  double density = 1;  ///< Texels a pixel.
  int width = 0, height = 0;
};

constexpr double margin = 16;  // texels: the picture ends in nothing up to mip level 4

Eigen::Vector2d in_pixels(const ImageFrame& frame, Vec2 place) {
  const Pixel pixel = frame.to_pixel(place);
  return {pixel.x, pixel.y};
}

/// A chart of the plane's part under the image.
Chart find_chart(const SolvedDecal& decal, const DecalMesh& divided) {
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
  Chart chart;
  chart.density = std::min({finer, std::max(1.0, large / longest), largest / longest});
  chart.origin = box.min().array() - margin / chart.density;
  const Eigen::Vector2d texels = chart.density * box.sizes();
  chart.width = static_cast<int>(std::ceil(texels.x() + 2 * margin));
  chart.height = static_cast<int>(std::ceil(texels.y() + 2 * margin));
  return chart;
}

/// The image itself, with a margin.
Chart frame_image(const Image& image) {
  constexpr int border = static_cast<int>(margin);
  return {{-margin, -margin}, 1, image.width + 2 * border, image.height + 2 * border};
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

/// Draws a chart; `to_image` takes its places to those of the image.
template <class ToImage>
Image draw(const Chart& chart, const Image& image, const ToImage& to_image) {
  Image picture = make_image(chart.width, chart.height, {0, 0, 0, 0});
  picture.bits = image.bits;
  parallel_for(chart.height, [&](int y) {
    for (int x = 0; x < chart.width; ++x) {
      const Eigen::Vector2d place = chart.origin + Eigen::Vector2d(x + 0.5, y + 0.5) / chart.density;
      const auto texel = sample(image, to_image(place));
      std::copy(texel.begin(), texel.end(), picture.pixel(x, y));
    }
  });
  return picture;
}

/// Texture coordinates of whole faces: their vertices' places in the chart.
void lay_into(DecalMesh& mesh, const ImageFrame& frame, const IdVector<PatchVertexId, Vec2>& places,
              const Chart& chart) {
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    const Eigen::Vector2d texel =
        chart.density * (in_pixels(frame, places[mesh.origins[i].vertices[0]]) - chart.origin);
    mesh.uvs[i] = {texel.x() / chart.width, texel.y() / chart.height};
  }
}

}  // namespace

OverlayLayout lay_out_overlay(const Model& model, const SolvedDecal& decal, double offset) {
  DecalMesh divided = build_overlay_mesh(model, decal, offset);
  Image image = overlay_image(decal);
  const bool on_skin = lies_on_skin(model, decal);
  if (divided.triangles.empty() || decal.map.groups > 1 || !on_skin)
    return {std::move(divided), std::move(image), on_skin};
  const ImageFrame& frame = decal.region.frame();
  DecalMesh whole = build_whole_mesh(model, decal, offset);
  if (is_linear(model, decal)) {
    const Chart chart = frame_image(image);
    lay_into(whole, frame, decal.map.image, chart);
    return {std::move(whole), draw(chart, image, [](const Eigen::Vector2d& place) { return place; }), false};
  }
  const Chart chart = find_chart(decal, divided);
  lay_into(whole, frame, decal.map.plane, chart);
  return {std::move(whole),
          draw(chart, image,
               [&](const Eigen::Vector2d& place) {
                 return in_pixels(frame, decal.map.warp(frame.to_plane({place.x(), place.y()})));
               }),
          false};
}

}  // namespace applique
