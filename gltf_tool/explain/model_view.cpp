#include "explain/model_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "applique/gpu/renderer.h"
#include "applique/image/decal_image.h"
#include "applique/surface/surface_query.h"

#include "decal_view.h"
#include "explain/palette.h"
#include "overlay_mesh.h"

namespace applique {
namespace {

using draw::Rgba;

constexpr int supersampling = 2;  // on top of the renderer's own
constexpr double view_margin = 0.15;
constexpr Rgba plain = {0.80, 0.80, 0.81};

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::array<float, 4> to_factor(const Rgba& colour) {
  return {static_cast<float>(srgb_to_linear(colour.r)), static_cast<float>(srgb_to_linear(colour.g)),
          static_cast<float>(srgb_to_linear(colour.b)), 1.0F};
}

/// The parts with the triangles cut as in the decal's surface; by part, the triangles that the surface's
/// faces are.
std::vector<std::vector<FaceId>> cut_as_in_surface(std::vector<ModelPart>& parts,
                                                   const ModelSurface& surface) {
  std::vector<std::vector<FaceId>> faces;
  for (const ModelPart& part : parts) faces.emplace_back(part.triangles.size());
  std::vector<std::vector<std::array<std::uint32_t, 3>>> whole;
  for (const ModelPart& part : parts) whole.push_back(part.triangles);
  for (const FaceId f : ids<FaceId>(surface.mesh.faces.size())) {
    const std::uint32_t p = surface.source(f).part, t = surface.source(f).triangle;
    ModelPart& part = parts[p];
    if (surface.is_whole(f)) {
      faces[p][t] = f;
      continue;
    }
    std::array<std::uint32_t, 3> triangle = {};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = static_cast<std::uint32_t>(part.positions.size());
      const auto at_corners = [&](const std::vector<Vec3>& values) {
        return blend(surface.corners_in_source(f)[k], [&](std::size_t i) { return values[whole[p][t][i]]; });
      };
      part.positions.push_back(at_corners(part.positions));
      part.normals.push_back(at_corners(part.normals).normalized());
    }
    if (!faces[p][t].valid()) {  // The first takes the place of the whole.
      part.triangles[t] = triangle;
      faces[p][t] = f;
    } else {
      part.triangles.push_back(triangle);
      faces[p].push_back(f);
    }
  }
  return faces;
}

/// The model's parts without their textures, a mesh for each colour that occurs on them.
std::vector<RenderMesh> tinted_parts(const Model& model, const SolvedDecal& decal,
                                     std::span<const SurfaceTint> tints) {
  std::vector<ModelPart> parts = model.parts;
  const auto faces = cut_as_in_surface(parts, *decal.surface);
  IdVector<FaceId, std::size_t> tint_of(decal.surface->mesh.faces.size(), 0);  // 0: plain
  for (std::size_t t = 0; t < tints.size(); ++t)
    for (const FaceId f : tints[t].faces) tint_of[f] = t + 1;
  std::vector<RenderMesh> meshes;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const ModelPart& part = parts[p];
    RenderMesh mesh;
    for (const Vec3& position : part.positions) mesh.positions.push_back(to_floats(position));
    if (!part.flat)
      for (const Vec3& normal : part.normals) mesh.normals.push_back(to_floats(normal));
    mesh.double_sided = true;
    for (std::size_t t = 0; t <= tints.size(); ++t) {
      mesh.triangles.clear();
      for (std::size_t i = 0; i < part.triangles.size(); ++i)
        if ((faces[p][i].valid() ? tint_of[faces[p][i]] : 0) == t)
          mesh.triangles.push_back(part.triangles[i]);
      mesh.base_colour_factor = to_factor(t == 0 ? plain : tints[t - 1].colour);
      if (!mesh.triangles.empty()) meshes.push_back(mesh);
    }
  }
  return meshes;
}

/// A six-sided tube along each piece of the lines; at joints the pieces overlap.
RenderMesh tubes(const SurfaceLines& lines, double radius) {
  constexpr std::uint32_t sides = 6;
  RenderMesh mesh;
  mesh.base_colour_factor = to_factor(lines.colour);
  const auto add_ring = [&](const Vec3& centre, const Vec3& u, const Vec3& v) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
      mesh.positions.push_back(to_floats(centre + radius * out));
      mesh.normals.push_back(to_floats(out));
    }
  };
  for (const std::vector<Vec3>& line : lines.lines)
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Vec3 along = line[i + 1] - line[i];
      if (!(along.norm() > 0)) continue;
      const Vec3 u = along.unitOrthogonal(), v = along.normalized().cross(u);
      const Vec3 overlap = 0.5 * radius * along.normalized();
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      add_ring(line[i] - overlap, u, v);
      add_ring(line[i + 1] + overlap, u, v);
      for (std::uint32_t k = 0; k < sides; ++k) {
        const std::uint32_t a = first + k, b = first + (k + 1) % sides;
        mesh.triangles.push_back({a, b, b + sides});
        mesh.triangles.push_back({a, b + sides, a + sides});
      }
    }
  return mesh;
}

/// The decal's own mesh with another picture on it.
RenderMesh painted_decal(const Model& model, const SolvedDecal& decal, const Image& painting) {
  const DecalMesh overlay = build_overlay_mesh(model, decal, default_offset(model));
  RenderMesh mesh;
  for (const Vec3& position : overlay.positions) mesh.positions.push_back(to_floats(position));
  for (const Vec3& normal : overlay.normals) mesh.normals.push_back(to_floats(normal));
  for (const auto& uv : overlay.uvs)
    mesh.uvs.push_back({static_cast<float>(uv[0]), static_cast<float>(uv[1])});
  mesh.triangles = overlay.triangles;
  mesh.base_colour = &painting;
  mesh.alpha_mode = AlphaMode::blend;
  mesh.wrap_u = mesh.wrap_v = WrapMode::clamp;
  return mesh;
}

/// Scene units a pixel at the camera's target.
double pixel_size(const Camera& camera, double height) {
  const double half = std::tan(camera.vertical_fov * std::numbers::pi / 360);
  return 2 * half * (camera.eye - camera.target).norm() / height;
}

/// Where the features are in the box's picture; those that the model hides are pale.
void draw_features_on_model(draw::Canvas& canvas, const SolvedDecal& decal, const Camera& camera,
                            const Box& box) {
  const double distance = (camera.eye - camera.target).norm();
  const Eigen::Matrix4d projection =
      view_projection(camera, box.size.real() / box.size.imag(), 0.01 * distance, 10 * distance);
  const SurfaceQuery query(decal.whole_surface->mesh);
  const double tolerance = 2 * pixel_size(camera, box.size.imag());
  constexpr double hidden_alpha = 0.35;
  for (std::size_t k = 0; k < decal.features.size(); ++k) {
    const Vec3 place = position_of(decal.whole_surface->mesh, decal.features[k].surface);
    const Eigen::Vector4d clip = projection * place.homogeneous();
    if (clip.w() <= 0) continue;
    const Vec2 at = box.low + Vec2((0.5 + 0.5 * clip.x() / clip.w()) * box.size.real(),
                                   (0.5 + 0.5 * clip.y() / clip.w()) * box.size.imag());
    const auto hit = query.first_hit(camera.eye, place - camera.eye);
    const bool seen = !hit || (position_of(decal.whole_surface->mesh, *hit) - camera.eye).norm() >
                                  (place - camera.eye).norm() - tolerance;
    draw_feature(canvas, at, k, pen_for(box).mark, draw::with_alpha(palette::ink, seen ? 1 : hidden_alpha));
  }
}

}  // namespace

Camera camera_for_drawing(const SolvedDecal& decal, const Box& box) {
  const DecalView view = view_of_decal(decal);
  return frame_points(view.points, view.towards_viewer, view.up, box.size.real() / box.size.imag(),
                      view_margin);
}

Result<void> draw_model(draw::Canvas& canvas, const Device& device, const Model& model,
                        const SolvedDecal& decal, const ModelDrawing& drawing, const Camera& camera,
                        const Box& box) {
  std::vector<RenderMesh> meshes = tinted_parts(model, decal, drawing.tints);
  if (drawing.painting != nullptr) meshes.push_back(painted_decal(model, decal, *drawing.painting));
  const double pixel = pixel_size(camera, box.size.imag());
  for (const SurfaceLines& lines : drawing.lines)
    if (!lines.lines.empty()) meshes.push_back(tubes(lines, 0.5 * lines.width * pixel));
  RenderOptions options;
  options.width = std::max(1, static_cast<int>(supersampling * box.size.real()));
  options.height = std::max(1, static_cast<int>(supersampling * box.size.imag()));
  options.background_top = options.background_bottom = {1, 1, 1};
  APPLIQUE_TRY(const Image picture, render(device, meshes, camera, options));
  const Vec2 low(std::ceil(box.low.real()), std::ceil(box.low.imag()));
  const Box whole = {low, {std::floor(box.size.real()), std::floor(box.size.imag())}};
  canvas.fill(whole.outline(), [&](Vec2 p) {
    const Vec2 at = static_cast<double>(supersampling) * (p - low);
    return sample_image(picture, {at.real(), at.imag()}, supersampling);
  });
  if (drawing.features) draw_features_on_model(canvas, decal, camera, whole);
  return {};
}

std::vector<std::vector<Vec3>> edges_on_surface(const SolvedDecal& decal, const Patch& patch) {
  std::vector<std::vector<Vec3>> edges;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    const PatchFace& face = patch.faces[q];
    if (!face.mesh_face.valid()) continue;
    const auto corners = decal.surface->mesh.corners(face.mesh_face);
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchFaceId across = face.neighbours[k];
      if (across.valid() && across < q && patch.faces[across].mesh_face.valid()) continue;  // from there
      edges.push_back({corners[(k + 1) % 3], corners[(k + 2) % 3]});
    }
  }
  return edges;
}

std::vector<FaceId> faces_on_surface(const Patch& patch) {
  std::vector<FaceId> faces;
  for (const PatchFace& face : patch.faces)
    if (face.mesh_face.valid()) faces.push_back(face.mesh_face);
  return faces;
}

}  // namespace applique
