#include "bake_job.h"

#include <algorithm>
#include <future>
#include <utility>

#include <fmt/format.h>

#include "bake_plan.h"
#include "decal_layers.h"
#include "edit.h"
#include "overlay.h"
#include "overlay_mesh.h"
#include "separate_uvs.h"

namespace applique {
namespace {

constexpr double transferred = 0.6;  // share of the work, for the progress bar

/// A target on its way: the texture, and what each of its decals does to it.
struct TargetWork {
  BakeTarget target;
  Image texture;
  TextureReport report;
  std::vector<Transfer> transfers;  ///< By BakeTarget::shares.
};

std::string material_name(const Document& document, std::size_t material) {
  const std::string name = document.json.at("materials").at(material).value("name", std::string());
  return name.empty() ? fmt::format("material {}", material) : name;
}

Result<std::vector<TargetWork>> prepare(const SolvedJob& job, const Document& document,
                                        std::vector<BakeTarget> targets) {
  std::vector<std::future<Result<Image>>> textures;
  textures.reserve(targets.size());
  for (const BakeTarget& target : targets)
    textures.push_back(
        std::async(std::launch::async, [&job, &target] { return initial_texture(job, target); }));
  std::vector<TargetWork> list;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    TargetWork work;
    APPLIQUE_TRY(work.texture, textures[i].get());
    work.report.material = material_name(document, targets[i].isolated);
    work.report.slot = name_of(targets[i].slot);
    work.report.width = work.texture.width;
    work.report.height = work.texture.height;
    work.report.created = !has_texture(job.model, targets[i]);
    work.target = std::move(targets[i]);
    list.push_back(std::move(work));
  }
  return list;
}

void warn_of_overlap(SolvedDecal& decal, const TargetWork& work, const TransferResult& result) {
  // Where triangles meet, rounding may give a texel to both: not worth a word.
  constexpr double smallest_share = 1e-3;
  if (static_cast<double>(result.shared_texels) <=
      smallest_share * static_cast<double>(result.covered_texels))
    return;
  decal.warnings.push_back(
      {"uv_overlap",
       fmt::format("decal '{}': {} texels of '{}' are shown by other surface too, where the decal appears "
                   "as well; \"uv_conflict\": \"separate\" gives it texture space of its own there",
                   decal.job.name, result.shared_texels, work.report.material)});
}

void warn_of_tint(SolvedDecal& decal, const SolvedJob& job, const TargetWork& work) {
  const auto& factor = job.model.materials[*work.target.material].base_colour_factor;
  if (factor[0] == 1 && factor[1] == 1 && factor[2] == 1) return;
  decal.warnings.push_back(
      {"base_color_factor_tints",
       fmt::format(
           "decal '{}': the material '{}' multiplies its texture, and so the decal, by the colour ({:.3g}, "
           "{:.3g}, {:.3g})",
           decal.job.name, work.report.material, factor[0], factor[1], factor[2])});
}

/// Factors of a texture that was there before: they stay, and so change what the decal brings.
void warn_of_factors(SolvedDecal& decal, const SolvedJob& job, const TargetWork& work) {
  if (work.report.created) return;
  if (work.target.slot == MaterialSlot::base_color) return warn_of_tint(decal, job, work);
  const auto& material = job.model.document.json.at("materials").at(*work.target.material);
  const auto warn = [&](const char* what, std::initializer_list<const char*> path) {
    const auto* factor = find(material, path);
    if (factor == nullptr || *factor == 1 || *factor == std::vector<double>{1, 1, 1}) return;
    decal.warnings.push_back(
        {"factor_scales",
         fmt::format("decal '{}': the material '{}' multiplies its {}, and so the decal's, by {}",
                     decal.job.name, work.report.material, what, factor->dump())});
  };
  switch (work.target.slot) {
    case MaterialSlot::metallic_roughness:
      warn("roughness", {"pbrMetallicRoughness", "roughnessFactor"});
      warn("metallic", {"pbrMetallicRoughness", "metallicFactor"});
      break;
    case MaterialSlot::normal:
      warn("relief", {"normalTexture", "scale"});
      break;
    case MaterialSlot::occlusion:
      warn("occlusion", {"occlusionTexture", "strength"});
      break;
    default:
      // Without a factor, nothing of the texture is seen.
      if (find(material, {"emissiveFactor"}) == nullptr)
        decal.warnings.push_back(
            {"factor_scales", fmt::format("decal '{}': the material '{}' multiplies its emissive texture, "
                                          "and so the decal's, by 0, its emissiveFactor",
                                          decal.job.name, work.report.material)});
      warn("emissive texture", {"emissiveFactor"});
  }
}

void warn_of_density(SolvedDecal& decal, const std::optional<TexelDensity>& density) {
  constexpr double lowest = 0.5;
  if (!density || density->texels_per_pixel >= lowest) return;
  decal.warnings.push_back(
      {"low_texel_density",
       fmt::format("decal '{}': the texture has {:.2g} texels for each pixel of the image, so "
                   "detail is lost; a larger texture, or \"output\": \"overlay\", keeps it",
                   decal.job.name, density->texels_per_pixel)});
}

void warn_of_motion(SolvedDecal& decal, const SolvedJob& job) {
  const auto& json = job.model.document.json;
  for (const PatchFace& face : decal.map.patch.faces) {
    if (!face.mesh_face.valid()) continue;
    const auto node = job.model.parts[decal.surface->source(face.mesh_face).part].node;
    if (!json.at("nodes").at(node).contains("skin") && !json.contains("animations")) continue;
    decal.warnings.push_back(
        {"overlay_static",
         fmt::format("decal '{}': the overlay lies on the model at rest and does not follow its "
                     "animation; bake the decal if the model moves",
                     decal.job.name)});
    return;
  }
}

/// Transfers every decal into its textures, in the order of the job.
Result<void> transfer_all(SolvedJob& job, std::vector<TargetWork>& works, GpuBaker& baker, BakedJob& baked,
                          const StageCallback& on_stage) {
  std::vector<DecalLayers> layers(job.decals.begin(), job.decals.end());
  std::vector<std::vector<const Transfer*>> transfers(job.decals.size());  // One layer's, for the density.
  for (TargetWork& work : works) {
    for (const BakeShare& share : work.target.shares)
      work.transfers.push_back(
          lay_out_transfer(job, work.target, share, work.texture.width, work.texture.height));
    for (std::size_t i = 0; i < work.transfers.size(); ++i)
      if (work.target.shares[i].layer == 0)
        transfers[work.target.shares[i].decal].push_back(&work.transfers[i]);
  }
  for (std::size_t w = 0; w < works.size(); ++w) {
    TargetWork& work = works[w];
    on_stage("baking into " + work.report.material,
             transferred * static_cast<double>(w) / static_cast<double>(works.size()));
    for (std::size_t i = 0; i < work.transfers.size(); ++i) {
      const auto [d, layer] = work.target.shares[i];
      SolvedDecal& decal = job.decals[d];
      const Stopwatch watch;
      APPLIQUE_TRY(work.transfers[i].image, layers[d].image(layer));
      APPLIQUE_TRY(const TransferResult result, baker.transfer->run(work.transfers[i], work.texture));
      decal.times.add("transfer", watch.seconds());
      work.report.covered_texels += result.covered_texels;
      work.report.gutter_texels += result.gutter_texels;
      work.report.shared_texels += result.shared_texels;
      if (layer == 0) warn_of_overlap(decal, work, result);
      const bool again = i > 0 && work.target.shares[i - 1].decal == d;  // another layer of the texture
      if (!again) warn_of_factors(decal, job, work);
    }
  }
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    baked.densities.push_back(texel_density(job.decals[d], transfers[d]));
    warn_of_density(job.decals[d], baked.densities[d]);
  }
  return {};
}

Result<void> store_textures(const std::vector<TargetWork>& works, Document& document) {
  std::vector<std::future<Result<std::vector<std::uint8_t>>>> encoded;
  encoded.reserve(works.size());
  for (const TargetWork& work : works)
    encoded.push_back(std::async(std::launch::async, [&work] { return encode_png(work.texture); }));
  for (std::size_t i = 0; i < works.size(); ++i) {
    APPLIQUE_TRY(const auto png, encoded[i].get());
    set_slot_image(document, works[i].target.isolated, works[i].target.slot, png);
  }
  return {};
}

Result<void> add_overlays(SolvedJob& job, Document& document) {
  for (SolvedDecal& decal : job.decals) {
    if (decal.job.output != DecalOutput::overlay) continue;
    const Stopwatch watch;
    const OverlayMesh mesh =
        build_overlay_mesh(job.model, decal, decal.job.offset.value_or(default_offset(job.model)));
    if (mesh.triangles.empty())
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': none of the image lies on the surface", decal.job.name));
    APPLIQUE_TRY(const auto png, encode_png(overlay_image(decal)));
    add_overlay(document, decal.job.name, mesh, png);
    decal.times.add("overlay", watch.seconds());
    warn_of_motion(decal, job);
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<GpuBaker>> create_baker(Device device) {
  auto baker = std::make_unique<GpuBaker>(GpuBaker{std::move(device), std::nullopt});
  APPLIQUE_TRY(baker->transfer, GpuTransfer::create(baker->device));
  return baker;
}

Result<BakedJob> bake_job(SolvedJob& job, GpuBaker& baker, const StageCallback& on_stage) {
  BakedJob baked;
  Stopwatch watch;
  const auto show = [&](const std::string& stage, double done) {
    if (on_stage) on_stage(stage, done);
  };
  show("preparing the textures", 0);
  APPLIQUE_TRY(const auto separated, separate_uvs(job));
  baked.times.add("separate_uvs", watch.lap());
  baked.document = job.model.document;
  APPLIQUE_TRY(auto targets, plan_bake(job, baked.document));
  APPLIQUE_TRY(auto works, prepare(job, baked.document, std::move(targets)));
  baked.times.add("load_textures", watch.lap());
  APPLIQUE_CHECK(transfer_all(job, works, baker, baked, show));
  baked.times.add("transfer", watch.lap());
  show("encoding the textures", transferred);
  APPLIQUE_CHECK(store_textures(works, baked.document));
  baked.times.add("encode_textures", watch.lap());
  APPLIQUE_CHECK(add_overlays(job, baked.document));
  baked.times.add("overlay", watch.lap());
  for (TargetWork& work : works) {
    for (const std::uint32_t part : work.target.parts)
      if (std::binary_search(separated.begin(), separated.end(), part))
        work.report.separated_triangles += job.model.parts[part].triangles.size();
    baked.textures.push_back(work.report);
  }
  return baked;
}

}  // namespace applique
