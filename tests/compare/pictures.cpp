#include "compare/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "applique/base/predicates.h"
#include "applique/gpu/renderer.h"
#include "applique/image/decal_image.h"
#include "applique/image/draw.h"

#include "compare/pins.h"
#include "explain/image_view.h"
#include "explain/layout.h"
#include "explain/palette.h"
#include "explain/plane_view.h"
#include "support/shapes.h"

namespace applique::compare {
namespace {

using draw::Rgba;

constexpr Rgba plain = {0.80, 0.79, 0.77};
constexpr int supersampling = 2;      // on top of the renderer's own
constexpr int texture_scale = 2;      // texels a pixel of the image
constexpr double cell = 32;           // of the checker, pixels of the image
constexpr double ring_radius = 13;    // pixels of the image
constexpr double ball_share = 0.016;  // radius, share of the image's width on the surface

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 4> to_factor(const Rgba& colour) {
  return {static_cast<float>(srgb_to_linear(colour.r)), static_cast<float>(srgb_to_linear(colour.g)),
          static_cast<float>(srgb_to_linear(colour.b)), 1.0F};
}

/// Checkered, its four quarters in two tints so that it is seen which way is up.
Rgba checker(Vec2 p) {
  const auto odd = [&](double size) {
    return (static_cast<int>(p.real() / size) + static_cast<int>(p.imag() / size)) % 2 != 0;
  };
  const Rgba& tint = odd(image_size / 2.0) ? palette::green : palette::blue;
  return odd(cell) ? draw::mix(palette::white, tint, 0.08) : draw::mix(palette::white, tint, 0.85);
}

/// The image cut out by its region, the rings on it, on plain ground.
Image draw_texture(const DecalInput& input) {
  constexpr double scale = texture_scale;
  draw::Canvas canvas(image_size * texture_scale, image_size * texture_scale);
  const double size = canvas.width();
  canvas.fill({{0, 0}, {size, 0}, {size, size}, {0, size}}, draw::solid(plain));
  draw::Outline region;
  for (const Pixel& p : input.region.contour()) region.push_back(scale * Vec2(p.x, p.y));
  canvas.fill(region, [&](Vec2 p) { return checker(p / scale); });
  canvas.line(region, 3 * scale, draw::solid(palette::ink), true);
  for (const Feature& feature : input.features) {
    const draw::Outline ring =
        draw::circle(scale * Vec2(feature.image.x, feature.image.y), scale * ring_radius);
    canvas.fill(ring, draw::solid(palette::white));
    canvas.line(ring, 4 * scale, draw::solid(palette::ink), true);
  }
  return canvas.image();
}

/// Area-weighted, by vertex.
IdVector<VertexId, Vec3> normals_of(const SurfaceMesh& mesh) {
  IdVector<VertexId, Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (const FaceId f : ids<FaceId>(mesh.faces.size())) {
    const auto q = mesh.corners(f);
    const Vec3 normal = (q[1] - q[0]).cross(q[2] - q[0]);
    for (const VertexId v : mesh.faces[f]) normals[v] += normal;
  }
  for (Vec3& normal : normals)
    if (normal.norm() > 0) normal.normalize();
  return normals;
}

/// The surface in two parts: what the map covers, with the texture, and the rest without.
class SurfaceDrawing {
 public:
  SurfaceDrawing(const Site& site, const ImageFrame& frame)
      : site_(site), frame_(frame), normals_(normals_of(site.mesh)) {}

  [[nodiscard]] RenderMesh covered(const DecalMap& map, const Image& texture) const {
    RenderMesh mesh = two_sided();
    mesh.base_colour = &texture;
    mesh.wrap_u = mesh.wrap_v = WrapMode::clamp;
    for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
      if (!map.textured[q]) continue;
      const PatchFace& face = map.patch.faces[q];
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (std::size_t k = 0; k < 3; ++k) {
        add(mesh, site_.mesh.faces[face.mesh_face][k]);
        const Pixel p = frame_.to_pixel(map.image[face.vertices[k]]);
        mesh.uvs.push_back({static_cast<float>(p.x / frame_.width), static_cast<float>(p.y / frame_.height)});
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
  }

  [[nodiscard]] RenderMesh rest(const DecalMap& map) const {
    IdVector<FaceId, char> is_covered(site_.mesh.faces.size(), 0);
    for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size()))
      if (map.textured[q]) is_covered[map.patch.faces[q].mesh_face] = 1;
    RenderMesh mesh = two_sided();
    mesh.base_colour_factor = to_factor(plain);
    for (const VertexId v : ids<VertexId>(site_.mesh.positions.size())) add(mesh, v);
    for (const FaceId f : ids<FaceId>(site_.mesh.faces.size())) {
      const auto& v = site_.mesh.faces[f];
      if (!is_covered[f]) mesh.triangles.push_back({v[0].value, v[1].value, v[2].value});
    }
    return mesh;
  }

 private:
  static RenderMesh two_sided() {
    RenderMesh mesh;
    mesh.double_sided = true;
    return mesh;
  }
  void add(RenderMesh& mesh, VertexId v) const {
    mesh.positions.push_back(to_floats(site_.mesh.positions[v]));
    mesh.normals.push_back(to_floats(normals_[v]));
  }

  const Site& site_;
  ImageFrame frame_;
  IdVector<VertexId, Vec3> normals_;
};

RenderMesh ball(const Vec3& centre, double radius) {
  static const shapes::Soup unit = shapes::sphere(2, 1);
  RenderMesh mesh;
  mesh.base_colour_factor = to_factor(palette::vermilion);
  for (const Vec3& p : unit.positions) {
    mesh.positions.push_back(to_floats(centre + radius * p));
    mesh.normals.push_back(to_floats(p));
  }
  mesh.triangles = unit.triangles;
  return mesh;
}

/// A face's L2 stretch by the same code as the map's: the face as a patch of its own.
double stretch_of(const SurfaceMesh& surface, const Region& region, const DecalMap& map, PatchFaceId q) {
  Patch patch;
  IdVector<PatchVertexId, Vec2> image;
  PatchFace face = map.patch.faces[q];
  for (PatchVertexId& v : face.vertices) {
    patch.vertices.push_back(map.patch.vertices[v]);
    v = image.push_back(map.image[v]);
  }
  patch.faces.push_back(face);
  const MapQuality quality =
      measure_quality(surface, patch, image, image, IdVector<PatchFaceId, char>(1, 1), Warp(), region);
  return quality.raw_l2_stretch * map.quality.l2_stretch / map.quality.raw_l2_stretch;
}

Rgba colour_of_stretch(double stretch) {
  if (!(stretch > 0)) return palette::white;  // touches the region in a line
  const double octaves = std::clamp(std::log2(stretch), -1.0, 1.0);
  return draw::mix(palette::white, octaves > 0 ? palette::vermilion : palette::blue, std::abs(octaves));
}

/// Puts `picture` into `sheet` with its corner at x, y.
void paste(const Image& picture, int x, int y, Image& sheet) {
  for (int row = 0; row < picture.height; ++row)
    std::copy_n(picture.pixel(0, row), 4 * picture.width, sheet.pixel(x, y + row));
}

Image tile(const std::vector<Image>& pictures, int columns, int rows) {
  const int width = pictures.front().width, height = pictures.front().height;
  constexpr std::uint16_t full = 65535;
  Image sheet = make_image(columns * width, rows * height, {full, full, full, full});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int k = static_cast<int>(i);
    paste(pictures[i], k % columns * width, k / columns * height, sheet);
  }
  return sheet;
}

bool is_turned_over(const DecalMap& map, PatchFaceId q) {
  const auto& v = map.patch.faces[q].vertices;
  return orientation(map.image[v[0]], map.image[v[1]], map.image[v[2]]) <= 0;
}

/// From above and a little from the right.
Camera camera_on_map(const Site& site, const DecalMap& map) {
  std::vector<Vec3> points;
  Vec3 normal = Vec3::Zero();
  for (const PatchFaceId q : ids<PatchFaceId>(map.patch.faces.size())) {
    if (!map.textured[q]) continue;
    const auto corners = site.mesh.corners(map.patch.faces[q].mesh_face);
    normal += (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    points.insert(points.end(), corners.begin(), corners.end());
  }
  normal.normalize();
  const Vec3 up = (site.up - normal * normal.dot(site.up)).normalized();
  return frame_points(points, normal + 0.35 * up + 0.3 * up.cross(normal), up, 1);
}

}  // namespace

CaseView view_case(const Site& site, const DecalInput& input, const DecalMap& map) {
  return {camera_on_map(site, map), draw_texture(input)};
}

Result<Image> picture_of_model(const Device& device, const Site& site, const DecalInput& input,
                               const DecalMap& map, const CaseView& view) {
  const SurfaceDrawing drawing(site, input.region.frame());
  std::vector<RenderMesh> meshes = {drawing.covered(map, view.texture), drawing.rest(map)};
  for (const Feature& feature : input.features)
    meshes.push_back(ball(position_of(site.mesh, feature.surface), ball_share * site.width));
  RenderOptions options;
  options.width = options.height = supersampling * picture_size;
  options.background_top = options.background_bottom = {1, 1, 1};
  APPLIQUE_TRY(const Image large, render(device, meshes, view.camera, options));
  draw::Canvas canvas(picture_size, picture_size);
  const double size = picture_size;
  canvas.fill({{0, 0}, {size, 0}, {size, size}, {0, size}}, [&](Vec2 p) {
    return sample_image(large, {supersampling * p.real(), supersampling * p.imag()}, supersampling);
  });
  return canvas.image();
}

Image picture_of_coordinates(const Site& site, const DecalInput& input, const DecalMap& map) {
  draw::Canvas canvas(picture_size, picture_size);
  const Box box{0, Vec2(picture_size, picture_size)};
  canvas.fill(box.outline(), draw::solid(palette::white));
  const ImageFrame& frame = input.region.frame();
  const double side = frame.width / frame.pixels_per_unit();
  const std::vector<Vec2> whole = {Vec2(-side / 2, -side / 2), Vec2(side / 2, side / 2)};
  const PlaneView view = fit(whole, box);
  draw_patch(
      canvas, map.patch, map.image, view,
      [&](PatchFaceId q) {
        if (!map.textured[q]) return Rgba{1, 1, 1, 0};
        return is_turned_over(map, q) ? palette::ink
                                      : colour_of_stretch(stretch_of(site.mesh, input.region, map, q));
      },
      0.35);
  canvas.line(view(input.region.polygon()), 2, draw::solid(palette::ink), true);
  for (const Feature& feature : input.features) {
    const Vec2 target = frame.to_plane(feature.image);
    const auto reached = image_of(map, feature.surface, target);
    canvas.line(draw::circle(view(target), 6), 2.5, draw::solid(palette::ink), true);
    if (!reached) continue;
    canvas.line({view(target), view(*reached)}, 2.5, draw::solid(palette::ink));
    canvas.fill(draw::circle(view(*reached), 4), draw::solid(palette::orange));
  }
  return canvas.image();
}

Image stack(const std::vector<Image>& pictures) {
  return tile(pictures, 1, static_cast<int>(pictures.size()));
}

Image join(const std::vector<Image>& pictures) {
  return tile(pictures, static_cast<int>(pictures.size()), 1);
}

}  // namespace applique::compare
