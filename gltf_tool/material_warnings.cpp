#include "material_warnings.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "instances.h"
#include "material.h"

namespace applique {
namespace {

using Json = Document::Json;

/// What a baked decal meets in one material under it.
class MaterialCheck {
 public:
  MaterialCheck(SolvedDecal& decal, const Model& model, std::size_t material)
      : decal_(&decal),
        model_(&model),
        json_(&model.document.json.at("materials").at(material)),
        material_(&model.materials[material]),
        name_(material_->name.empty() ? fmt::format("material {}", material) : material_->name) {}

  void run() {
    std::set<MaterialSlot> slots;
    for (const DecalLayer& layer : decal_->job.layers) slots.insert(layer.slot);
    for (const MaterialSlot slot : slots)
      if (read_texture(model_->document, *json_, slot).image) warn_of_factors(slot);
    warn_of_unlit();
    warn_of_specular_glossiness(slots);
  }

 private:
  void add(const char* code, const std::string& sentence) {
    decal_->warnings.push_back(
        {code, fmt::format("decal '{}': the material '{}' {}", decal_->job.name, name_, sentence)});
  }

  /// Factors of a texture that is there stay, and so change what the decal brings.
  void warn_of_factors(MaterialSlot slot) {
    switch (slot) {
      case MaterialSlot::base_color:
        warn_of_tint();
        warn_of_fading();
        break;
      case MaterialSlot::metallic_roughness:
        warn_of_factor("roughness", {"pbrMetallicRoughness", "roughnessFactor"});
        warn_of_factor("metallic", {"pbrMetallicRoughness", "metallicFactor"});
        break;
      case MaterialSlot::normal:
        warn_of_factor("relief", {"normalTexture", "scale"});
        break;
      case MaterialSlot::occlusion:
        warn_of_factor("occlusion", {"occlusionTexture", "strength"});
        break;
      case MaterialSlot::emissive:
        // Without a factor, nothing of the texture is seen.
        if (find(*json_, {"emissiveFactor"}) == nullptr)
          add("factor_scales",
              "multiplies its emissive texture, and so the decal's, by 0, its emissiveFactor");
        warn_of_factor("emissive texture", {"emissiveFactor"});
    }
  }

  void warn_of_factor(const char* what, std::initializer_list<const char*> path) {
    const auto* factor = find(*json_, path);
    if (factor == nullptr || *factor == 1 || *factor == std::vector<double>{1, 1, 1}) return;
    add("factor_scales", fmt::format("multiplies its {}, and so the decal's, by {}", what, factor->dump()));
  }

  void warn_of_tint() {
    const auto& factor = material_->base_colour_factor;
    if (factor[0] == 1 && factor[1] == 1 && factor[2] == 1) return;
    add("base_color_factor_tints",
        fmt::format("multiplies its texture, and so the decal, by the colour ({:.3g}, {:.3g}, {:.3g})",
                    factor[0], factor[1], factor[2]));
  }

  void warn_of_fading() {
    const double alpha = material_->base_colour_factor[3];
    constexpr const char* advice =
        "raise the alpha of its baseColorFactor, or make the decal \"output\": \"overlay\"";
    if (material_->alpha_mode == "BLEND" && alpha < 1)
      add("base_color_factor_fades",
          fmt::format("is transparent (BLEND), and multiplies its texture's alpha, and so the decal's, by "
                      "{:.3g}; {}",
                      alpha, advice));
    if (material_->alpha_mode == "MASK" && alpha < material_->alpha_cutoff)
      add("base_color_factor_fades",
          fmt::format("multiplies its texture's alpha, and so the decal's, by {:.3g}, less than its "
                      "alphaCutoff (MASK) of {:.3g}, so that nothing of it is seen; {}",
                      alpha, material_->alpha_cutoff, advice));
  }

  void warn_of_unlit() {
    if (find(*json_, {"extensions", "KHR_materials_unlit"}) == nullptr) return;
    std::vector<std::string> layers;
    for (const DecalLayer& layer : decal_->job.layers)
      if (layer.slot != MaterialSlot::base_color) layers.push_back(layer.name);
    if (layers.empty()) return;
    add("unlit_layers",
        fmt::format("is unlit (KHR_materials_unlit) and shows its base colour only, so that the decal's {} "
                    "{} no effect on it",
                    fmt::join(layers, ", "), layers.size() == 1 ? "has" : "have"));
  }

  void warn_of_specular_glossiness(const std::set<MaterialSlot>& slots) {
    if (find(*json_, {"extensions", "KHR_materials_pbrSpecularGlossiness"}) == nullptr) return;
    if (!slots.contains(MaterialSlot::base_color) && !slots.contains(MaterialSlot::metallic_roughness))
      return;
    add("specular_glossiness",
        "has KHR_materials_pbrSpecularGlossiness: viewers that know it show its diffuse texture in place of "
        "the base colour, without the decal; convert the model, for instance with `gltf-transform "
        "metalrough`, or make the decal \"output\": \"overlay\"");
  }

  SolvedDecal* decal_;
  const Model* model_;
  const Json* json_;
  const ModelMaterial* material_;
  std::string name_;
};

void warn_of_vertex_colours(SolvedDecal& decal, const Model& model) {
  if (!has_vertex_colours(decal, model)) return;
  decal.warnings.push_back(
      {"vertex_colors_tint",
       fmt::format(
           "decal '{}': the model's vertex colours (COLOR_0) multiply the texture under it, and so the "
           "decal; make them white there, or the decal \"output\": \"overlay\"",
           decal.job.name)});
}

/// Variants that show another material under the decal, and so the surface without it.
void warn_of_variants(SolvedDecal& decal, const Model& model) {
  const std::vector<std::string> names = variants_without(decal, model);
  if (names.empty()) return;
  decal.warnings.push_back(
      {"variants_without_decal",
       fmt::format(
           "decal '{}': the material variants {} show other materials under it, without the decal; an "
           "\"output\": \"overlay\" is seen in all",
           decal.job.name, fmt::join(names, ", "))});
}

}  // namespace

void warn_of_materials(SolvedJob& job) {
  for (SolvedDecal& decal : job.decals) {
    if (decal.job.output != DecalOutput::bake) continue;
    for (const auto& material : materials_under(decal, job.model))
      if (material) MaterialCheck(decal, job.model, *material).run();
    warn_of_vertex_colours(decal, job.model);
    warn_of_variants(decal, job.model);
  }
}

}  // namespace applique
