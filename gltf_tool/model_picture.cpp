#include "model_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "applique/gpu/renderer.h"

#include "decal_view.h"
#include "material.h"

namespace applique {
namespace {

std::array<float, 3> to_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// The image in a slot of the part's material, if the part can show it: it has one set of texture coordinates
/// here, the base colour's.
std::optional<std::size_t> shown_image(const Model& model, const ModelPart& part, MaterialSlot slot) {
  if (!part.material || part.uvs.empty()) return std::nullopt;
  const auto& material = model.document.json.at("materials").at(*part.material);
  if (read_uv_mapping(material, slot) != read_uv_mapping(material)) return std::nullopt;
  return read_texture(model.document, material, slot).image;
}

constexpr std::array shown_slots = {MaterialSlot::base_color, MaterialSlot::metallic_roughness,
                                    MaterialSlot::normal, MaterialSlot::emissive};

/// The images that the parts show, decoded side by side. Without its base colour a part would not be itself;
/// what else cannot be read is left out, and so is what is not there, of which a loaded model warns.
Result<std::map<std::size_t, Image>> load_images(const Model& model) {
  std::map<std::size_t, std::future<Result<Image>>> loading;
  std::set<std::size_t> needed;
  for (const ModelPart& part : model.parts)
    for (const MaterialSlot slot : shown_slots) {
      const auto image = shown_image(model, part, slot);
      if (image && slot == MaterialSlot::base_color) needed.insert(*image);
      if (image && !loading.contains(*image))
        loading[*image] =
            std::async(std::launch::async, [&model, image] { return load_model_image(model, *image); });
    }
  std::map<std::size_t, Image> images;
  for (auto& [index, loaded] : loading) {
    auto image = loaded.get();
    if (!image && (!needed.contains(index) || missing_file(model.document, index))) continue;
    APPLIQUE_TRY(images[index], std::move(image));
  }
  return images;
}

AlphaMode alpha_mode_of(const std::string& name) {
  if (name == "MASK") return AlphaMode::mask;
  return name == "BLEND" ? AlphaMode::blend : AlphaMode::opaque;
}

RenderMesh mesh_of(const Model& model, const ModelPart& part, const std::map<std::size_t, Image>& images) {
  RenderMesh mesh;
  for (const Vec3& position : part.positions) mesh.positions.push_back(to_floats(position));
  if (!part.flat)
    for (const Vec3& normal : part.normals) mesh.normals.push_back(to_floats(normal));
  for (const auto& uv : part.uvs) mesh.uvs.push_back({static_cast<float>(uv[0]), static_cast<float>(uv[1])});
  mesh.triangles = part.triangles;
  mesh.metallic = mesh.roughness = 1;  // glTF's defaults.
  if (!part.material) return mesh;
  const ModelMaterial& material = model.materials[*part.material];
  for (std::size_t c = 0; c < 4; ++c)
    mesh.base_colour_factor[c] = static_cast<float>(material.base_colour_factor[c]);
  const auto texture = [&](MaterialSlot slot) -> const Image* {
    const auto image = shown_image(model, part, slot);
    return image && images.contains(*image) ? &images.at(*image) : nullptr;
  };
  mesh.base_colour = texture(MaterialSlot::base_color);
  mesh.normal = texture(MaterialSlot::normal);
  mesh.metallic_roughness = texture(MaterialSlot::metallic_roughness);
  mesh.emissive = texture(MaterialSlot::emissive);
  const auto& json = model.document.json.at("materials").at(*part.material);
  const auto number = [&](std::initializer_list<const char*> path) {
    const auto* value = find(json, path);
    return value != nullptr && value->is_number() ? value->get<float>() : 1.0F;
  };
  mesh.metallic = number({"pbrMetallicRoughness", "metallicFactor"});
  mesh.roughness = number({"pbrMetallicRoughness", "roughnessFactor"});
  mesh.normal_scale = number({"normalTexture", "scale"});
  if (const auto* factor = find(json, {"emissiveFactor"}))
    mesh.emissive_factor = factor->get<std::array<float, 3>>();
  mesh.alpha_mode = alpha_mode_of(material.alpha_mode);
  mesh.alpha_cutoff = static_cast<float>(material.alpha_cutoff);
  mesh.double_sided = material.double_sided;
  mesh.wrap_u = material.wrap_u;
  mesh.wrap_v = material.wrap_v;
  return mesh;
}

}  // namespace

Camera camera_on_decal(const SolvedDecal& decal, PictureSize size) {
  const DecalView view = view_of_decal(decal);
  return frame_points(view.points, view.towards_viewer, view.up,
                      static_cast<double>(size.width) / size.height);
}

Camera camera_around_model(const Model& model, double azimuth, double elevation, double zoom,
                           PictureSize size) {
  // orbit() fits a sphere into the picture's height; an upright picture is narrower than high.
  const double aspect = static_cast<double>(size.width) / size.height;
  const double radius = 0.5 * model.diagonal() / std::min(1.0, aspect);
  return orbit(0.5 * (model.lower + model.upper), radius, azimuth, elevation, zoom);
}

Result<Image> render_model(const Device& device, const Model& model, const Camera& camera, PictureSize size) {
  APPLIQUE_TRY(const auto images, load_images(model));
  std::vector<RenderMesh> meshes;
  for (const ModelPart& part : model.parts) meshes.push_back(mesh_of(model, part, images));
  RenderOptions options;
  options.width = size.width;
  options.height = size.height;
  return render(device, meshes, camera, options);
}

}  // namespace applique
