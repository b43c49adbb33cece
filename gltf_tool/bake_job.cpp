#include "bake_job.h"

#include <algorithm>
#include <future>
#include <utility>

#include <fmt/format.h>

#include "attach_overlay.h"
#include "bake_plan.h"
#include "bake_seams.h"
#include "decal_layers.h"
#include "edit.h"
#include "material_warnings.h"
#include "overlay.h"
#include "overlay_layers.h"
#include "overlay_layout.h"
#include "separate_uvs.h"
#include "write_tangents.h"

namespace applique {
namespace {

constexpr double transferred = 0.6;  // share of the work, for the progress bar

/// A target on its way: the texture, and what each of its decals does to it.
struct TargetWork {
  BakeTarget target;
  Image texture;
  TextureReport report;
  std::vector<BakeTransfer> transfers;  ///< By BakeTarget::shares.
};

std::string material_name(const Document& document, std::size_t material) {
  const std::string name = document.json.at("materials").at(material).value("name", std::string());
  return name.empty() ? fmt::format("material {}", material) : name;
}

Result<std::vector<TargetWork>> prepare(const SolvedJob& job, const Document& document,
                                        std::vector<BakeTarget> targets, const TextureEncoding& encoding) {
  std::vector<std::future<Result<Image>>> textures;
  textures.reserve(targets.size());
  for (const BakeTarget& target : targets)
    textures.push_back(
        std::async(std::launch::async, [&job, &target] { return initial_texture(job, target); }));
  std::vector<TargetWork> list;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    TargetWork work;
    APPLIQUE_TRY(work.texture, textures[i].get());
    work.texture.bits = working_bits(encoding, work.texture.bits);
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
                   "as well{}",
                   decal.job.name, result.shared_texels, work.report.material,
                   decal.job.uv_conflict == UvConflict::separate
                       ? ""
                       : "; \"uv_conflict\": \"separate\" gives it texture space of its own there")});
}

void warn_of_density(SolvedDecal& decal, const std::optional<TexelDensity>& density) {
  constexpr double lowest = 0.5 - 1e-6;  // Half a texel, as rounding has it, is enough.
  if (!density || density->texels_per_pixel >= lowest) return;
  decal.warnings.push_back(
      {"low_texel_density",
       fmt::format("decal '{}': the texture has {:.2g} texels for each pixel of the image, so "
                   "detail is lost; a larger texture, or \"output\": \"overlay\", keeps it",
                   decal.job.name, density->texels_per_pixel)});
}

void warn_of_motion(SolvedDecal& decal, const Document& document, const OverlayMesh& overlay) {
  if (overlay.node || !document.json.contains("animations")) return;
  decal.warnings.push_back(
      {"overlay_static",
       fmt::format(
           "decal '{}': a node under it is flat at rest (its transform has no inverse), so the overlay "
           "there stays at the rest pose and does not follow the model's animation; bake the decal",
           decal.job.name)});
}

/// The seams of one slot's textures, and these as they were before the decals.
struct SlotSeams {
  std::vector<TargetWork*> works;
  std::vector<Image> before;
  std::vector<Seam> seams;
};

std::vector<SlotSeams> seams_by_slot(const SolvedJob& job, std::vector<TargetWork>& works) {
  std::vector<SlotSeams> slots;
  for (const MaterialSlot slot : all_slots) {
    SlotSeams of_slot;
    std::vector<SizedTarget> targets;
    for (TargetWork& work : works) {
      if (work.target.slot != slot) continue;
      of_slot.works.push_back(&work);
      targets.push_back({&work.target, work.texture.width, work.texture.height});
    }
    of_slot.seams = find_seams(job, targets);
    if (of_slot.seams.empty()) continue;
    for (const TargetWork* work : of_slot.works) of_slot.before.push_back(work->texture);
    slots.push_back(std::move(of_slot));
  }
  return slots;
}

void join_slot(const SlotSeams& slot, SeamFit fit) {
  std::vector<SeamTexture> textures;
  for (std::size_t i = 0; i < slot.works.size(); ++i) {
    TargetWork& work = *slot.works[i];
    const Transfer& transfer = work.transfers.front();
    SeamTexture texture{&work.texture, &slot.before[i], transfer.wrap_u, transfer.wrap_v, {}};
    for (const Transfer& layer : work.transfers)
      for (std::size_t c = 0; c < 4; ++c) texture.channels[c] |= layer.channels[c];
    textures.push_back(texture);
  }
  join_seams(slot.seams, textures, encoding_of(slot.works.front()->target.slot), fit);
}

/// Transfers every decal into its textures, in the order of the job.
Result<void> transfer_all(SolvedJob& job, std::vector<TargetWork>& works, GpuBaker& baker, BakedJob& baked,
                          const StageCallback& on_stage) {
  std::vector<DecalLayers> layers(job.decals.begin(), job.decals.end());
  std::vector<std::vector<const BakeTransfer*>> transfers(
      job.decals.size());  // One layer's, for the density.
  for (TargetWork& work : works) {
    for (const BakeShare& share : work.target.shares)
      work.transfers.push_back(
          lay_out_transfer(job, work.target, share, work.texture.width, work.texture.height));
    for (std::size_t i = 0; i < work.transfers.size(); ++i)
      if (work.target.shares[i].layer == 0)
        transfers[work.target.shares[i].decal].push_back(&work.transfers[i]);
  }
  const std::vector<SlotSeams> seams = seams_by_slot(job, works);
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
    }
  }
  for (std::size_t d = 0; d < layers.size(); ++d) {
    if (job.decals[d].job.output != DecalOutput::bake) continue;
    APPLIQUE_TRY(const auto warnings, layers[d].warnings());
    job.decals[d].warnings.insert(job.decals[d].warnings.end(), warnings.begin(), warnings.end());
  }
  const Stopwatch watch;
  for (const SlotSeams& slot : seams) join_slot(slot, job.job.seams);
  baked.times.add("seams", watch.seconds());
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    baked.densities.push_back(texel_density(job.decals[d], transfers[d]));
    warn_of_density(job.decals[d], baked.densities[d]);
  }
  return {};
}

/// Tells that a texture ("the baseColor texture of 'skin'") is not stored in the wanted format.
void warn_of_format(BakedJob& baked, const std::string& texture, const EncodedTexture& encoded) {
  if (!encoded.why_png.empty()) baked.warnings.push_back(png_warning(texture, encoded));
}

Result<void> store_textures(std::vector<TargetWork>& works, const TextureEncoding& encoding,
                            BakedJob& baked) {
  std::vector<std::future<Result<EncodedTexture>>> textures;
  textures.reserve(works.size());
  for (const TargetWork& work : works)
    textures.push_back(
        std::async(std::launch::async, [&] { return encode_texture(work.texture, encoding); }));
  for (std::size_t i = 0; i < works.size(); ++i) {
    APPLIQUE_TRY(const EncodedTexture encoded, textures[i].get());
    set_slot_image(baked.document, works[i].target.isolated, works[i].target.slot, encoded.bytes);
    works[i].report.format = name_of(encoded.format);
    warn_of_format(baked,
                   fmt::format("the {} texture of '{}'", works[i].report.slot, works[i].report.material),
                   encoded);
  }
  return {};
}

/// Draws and encodes the pictures of an overlay.
Result<OverlayMaterial> make_material(const SolvedDecal& decal, const OverlayLayers& layers,
                                      const OverlayChart& chart, const TextureEncoding& encoding,
                                      BakedJob& baked) {
  OverlayMaterial material;
  material.metallic = layers.metallic;
  material.roughness = layers.roughness;
  material.emissive = layers.emissive;
  for (const DecalLayer& layer : decal.job.layers) material.layers.push_back(layer.name);
  const std::vector<OverlayPicture> pictures = draw_pictures(chart, layers.pictures);
  std::vector<std::future<Result<EncodedTexture>>> textures;
  textures.reserve(pictures.size());
  for (const OverlayPicture& picture : pictures)
    textures.push_back(
        std::async(std::launch::async, [&] { return encode_texture(picture.image, encoding); }));
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const MaterialSlot slot = pictures[i].slot;
    APPLIQUE_TRY(EncodedTexture encoded, textures[i].get());
    warn_of_format(baked, fmt::format("the {} texture of the overlay '{}'", name_of(slot), decal.job.name),
                   encoded);
    material.textures[slot] = std::move(encoded.bytes);
  }
  return material;
}

Result<void> add_overlays(SolvedJob& job, const TextureEncoding& encoding, BakedJob& baked) {
  for (SolvedDecal& decal : job.decals) {
    if (decal.job.output != DecalOutput::overlay) continue;
    const Stopwatch watch;
    const auto [mesh, chart, divided_skin] =
        lay_out_overlay(job.model, decal, decal.job.offset.value_or(default_offset(job.model)));
    if (mesh.triangles.empty())
      return fail(ErrorCode::not_solved,
                  fmt::format("decal '{}': none of the image lies on the surface", decal.job.name));
    APPLIQUE_TRY(auto overlays, attach_overlay(job.model, decal, mesh));
    APPLIQUE_TRY(const OverlayLayers layers, make_overlay_layers(job.model, decal));
    APPLIQUE_TRY(const OverlayMaterial shown, make_material(decal, layers, chart, encoding, baked));
    const std::size_t material = add_overlay_material(baked.document, decal.job.name, shown);
    for (OverlayMesh& overlay : overlays) {
      if (shown.textures.contains(MaterialSlot::normal)) make_tangents(overlay);
      add_overlay(baked.document, decal.job.name, overlay, material);
      warn_of_motion(decal, baked.document, overlay);
    }
    if (divided_skin)
      decal.warnings.push_back(
          {"overlay_follows_nearly",
           fmt::format(
               "decal '{}': the image overlaps itself on a skin, where an overlay follows the model's "
               "poses exactly only at the corners of its triangles; bake the decal, or give the overlay "
               "a larger \"offset\"",
               decal.job.name)});
    decal.times.add("overlay", watch.seconds());
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<GpuBaker>> create_baker(Device device) {
  auto baker = std::make_unique<GpuBaker>(GpuBaker{std::move(device), std::nullopt});
  APPLIQUE_TRY(baker->transfer, GpuTransfer::create(baker->device));
  return baker;
}

Result<BakedJob> bake_job(SolvedJob& job, GpuBaker& baker, const StageCallback& on_stage,
                          const TextureEncoding& encoding) {
  BakedJob baked;
  Stopwatch watch;
  const auto show = [&](const std::string& stage, double done) {
    if (on_stage) on_stage(stage, done);
  };
  show("preparing the textures", 0);
  warn_of_materials(job);  // as they are in the file
  APPLIQUE_TRY(SeparatedUvs separated, separate_uvs(job, encoding));
  baked.uv_conflicts = std::move(separated.conflicts);
  baked.warnings = std::move(separated.warnings);
  baked.times.add("separate_uvs", watch.lap());
  baked.document = job.model.document;
  APPLIQUE_TRY(auto targets, plan_bake(job, baked.document));
  APPLIQUE_CHECK(write_tangents(job.model, targets, baked.document));
  APPLIQUE_TRY(auto works, prepare(job, baked.document, std::move(targets), encoding));
  for (TargetWork& work : works)
    if (work.target.material && separated.made.contains({*work.target.material, work.target.slot}))
      work.report.created = true;
  baked.times.add("load_textures", watch.lap());
  APPLIQUE_CHECK(transfer_all(job, works, baker, baked, show));
  baked.times.add("transfer", watch.lap());
  show("encoding the textures", transferred);
  APPLIQUE_CHECK(store_textures(works, encoding, baked));
  baked.times.add("encode_textures", watch.lap());
  APPLIQUE_CHECK(add_overlays(job, encoding, baked));
  baked.times.add("overlay", watch.lap());
  for (TargetWork& work : works) {
    for (const std::uint32_t part : work.target.parts)
      if (std::binary_search(separated.parts.begin(), separated.parts.end(), part))
        work.report.separated_triangles += job.model.parts[part].triangles.size();
    baked.textures.push_back(work.report);
  }
  return baked;
}

}  // namespace applique
