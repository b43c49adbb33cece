#include "uv_conflict.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bake_plan.h"
#include "edit.h"
#include "instances.h"
#include "unwrap.h"
#include "uv_coverage.h"
#include "uv_raster.h"

namespace applique {
namespace {

/// The triangles that show some of a baked decal, each once, under the lowest of its sheets.
std::vector<SeparatedTriangle> touched_triangles(const SolvedJob& job, std::size_t decal_index) {
  const SolvedDecal& decal = job.decals[decal_index];
  const DecalMap& map = decal.map;
  std::map<FaceId, PatchFaceId> lowest;
  for (const PatchFaceId f : ids<PatchFaceId>(map.patch.faces.size())) {
    const FaceId face = map.patch.faces[f].mesh_face;
    if (map.textured[f] == 0 || !face.valid()) continue;
    const auto [place, fresh] = lowest.try_emplace(face, f);
    if (!fresh && map.sheet[f] < map.sheet[place->second]) place->second = f;
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<PatchFaceId>> faces;
  for (const auto& [face, f] : lowest) {
    const auto& source = decal.surface->source(face);
    faces[{source.part, source.triangle}].push_back(f);
  }
  std::vector<SeparatedTriangle> list;
  for (auto& [source, parts] : faces)
    list.push_back({source.first, source.second, decal_index, std::move(parts)});
  return list;
}

bool writes(const DecalJob& decal, MaterialSlot slot) {
  return std::any_of(decal.layers.begin(), decal.layers.end(),
                     [&](const DecalLayer& layer) { return layer.slot == slot; });
}

/// Some slots of a group that show textures of one size through the same coordinates.
struct TextureSpace {
  std::vector<MaterialSlot> slots;
  UvMapping mapping;
  std::array<int, 2> texture = {0, 0};
  std::array<WrapMode, 2> wrap = {WrapMode::repeat, WrapMode::repeat};
  std::map<std::uint32_t, std::vector<std::array<double, 2>>> uvs;  ///< By part; empty: none.

  [[nodiscard]] std::array<std::array<double, 2>, 3> corners(const Model& model, std::uint32_t part,
                                                             std::uint32_t triangle) const {
    const auto& t = model.parts[part].triangles[triangle];
    const auto& list = uvs.at(part);
    return {list[t[0]], list[t[1]], list[t[2]]};
  }

  /// The same of the part that stands for `part`, in the order of its own corners: mirrored nodes exchange
  /// two.
  [[nodiscard]] std::optional<std::array<std::array<double, 2>, 3>> corners_under(
      const Model& model, const DecalJob& decal, std::uint32_t part, std::uint32_t triangle) const {
    const std::uint32_t standing = part_that_stands_for(model, decal, part);
    const auto found = uvs.find(standing);
    if (found == uvs.end() || found->second.empty()) return std::nullopt;
    auto list = corners(model, standing, triangle);
    if (model.parts[standing].mirrored != model.parts[part].mirrored) std::swap(list[1], list[2]);
    return list;
  }
};

Result<TextureSpace> space_of(const SolvedJob& job, const TextureGroup& group, MaterialSlot slot) {
  TextureSpace space;
  space.slots = {slot};
  APPLIQUE_TRY(space.texture, slot_texture_size(job, group.material, slot));
  if (!group.material) return space;
  const auto& material = job.model.document.json["materials"][*group.material];
  space.mapping = read_uv_mapping(material, slot);
  const MaterialTexture texture = read_texture(job.model.document, material, slot);
  space.wrap = {texture.wrap_u, texture.wrap_v};
  return space;
}

Result<std::vector<TextureSpace>> find_spaces(const SolvedJob& job, const TextureGroup& group) {
  std::vector<TextureSpace> spaces;
  for (const MaterialSlot slot : group.written) {
    APPLIQUE_TRY(TextureSpace space, space_of(job, group, slot));
    const auto same = std::find_if(spaces.begin(), spaces.end(), [&](const TextureSpace& known) {
      return known.mapping == space.mapping && known.texture == space.texture && known.wrap == space.wrap;
    });
    if (same != spaces.end())
      same->slots.push_back(slot);
    else
      spaces.push_back(std::move(space));
  }
  for (TextureSpace& space : spaces)
    for (const std::uint32_t part : group.parts)
      space.uvs[part] = slot_uvs(job.model, job.model.parts[part], space.slots.front());
  return spaces;
}

/// All triangles of the group in a space, or in a coarser one if they go round it very often.
UvCoverage cover(const SolvedJob& job, const TextureGroup& group, const TextureSpace& space) {
  constexpr double most_texels = 1 << 25;  // 4096 x 4096, twice over
  const auto for_each_triangle = [&](const auto& visit) {
    for (const std::uint32_t part : group.parts) {
      if (space.uvs.at(part).empty()) continue;
      for (std::uint32_t t = 0; t < job.model.parts[part].triangles.size(); ++t)
        visit(space.corners(job.model, part, t));
    }
  };
  double texels = 0;
  for_each_triangle([&](const auto& uvs) {
    texels += 0.5 * std::abs(doubled_area(uvs)) * space.texture[0] * space.texture[1];
  });
  const double scale = std::min(1.0, std::sqrt(most_texels / std::max(texels, 1.0)));
  const auto side = [&](int full) { return std::max(1, static_cast<int>(scale * full)); };
  UvCoverage coverage(side(space.texture[0]), side(space.texture[1]), space.wrap[0], space.wrap[1]);
  for_each_triangle([&](const auto& uvs) { coverage.add(uvs); });
  return coverage;
}

/// How a decal's triangles stand in a space.
struct SpaceState {
  std::set<std::size_t> in_conflict;  ///< Of the triangles.
  std::uint64_t covered_texels = 0;
  std::uint64_t shared_texels = 0;  ///< Covered by several triangles of the group.
  double pixels = 0;                ///< Of the decal's image.
  double lost_pixels = 0;           ///< On triangles with texture coordinates that are not fit for a decal.
  bool without_uvs = false;         ///< Some have no texture coordinates.

  [[nodiscard]] std::optional<UvTrouble> trouble() const {
    // Where triangles meet, rounding may give a texel to both; some slivers are in many models.
    constexpr double few_texels = 1e-3;
    constexpr double few_pixels = 1e-2;
    if (without_uvs) return UvTrouble::missing;
    if (static_cast<double>(shared_texels) > few_texels * static_cast<double>(covered_texels))
      return UvTrouble::shared;
    if (lost_pixels > few_pixels * pixels) return UvTrouble::coarse;
    return std::nullopt;
  }
};

SpaceState find_state(const SolvedJob& job, const TextureSpace& space, const UvCoverage& coverage,
                      const std::vector<SeparatedTriangle>& triangles) {
  SpaceState state;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const SeparatedTriangle& t = triangles[i];
    const auto under = space.corners_under(job.model, job.decals[t.decal].job, t.part, t.triangle);
    if (!under) {
      state.without_uvs = true;
      state.in_conflict.insert(i);
      continue;
    }
    const auto& uvs = *under;
    const auto count = coverage.under(uvs);
    state.covered_texels += count.covered;
    state.shared_texels += count.shared;
    if (count.shared > 0) state.in_conflict.insert(i);
    std::array<Texel, 3> texels = {};
    for (std::size_t k = 0; k < 3; ++k)
      texels[k] = {uvs[k][0] * space.texture[0], uvs[k][1] * space.texture[1]};
    const double pixels = pixels_on(job, t);
    state.pixels += pixels;
    if (is_fine_enough(job, t, texels)) continue;
    state.lost_pixels += pixels;
    state.in_conflict.insert(i);
  }
  return state;
}

/// The pixels along which the decal crosses seams of the space.
double seam_pixels_in(const SolvedJob& job, const TextureSpace& space, std::size_t decal_index) {
  return seam_pixels(job, decal_index,
                     [&](std::uint32_t part, std::uint32_t triangle) -> std::optional<std::array<Texel, 3>> {
                       auto corners =
                           space.corners_under(job.model, job.decals[decal_index].job, part, triangle);
                       if (!corners) return std::nullopt;
                       for (Texel& corner : *corners)
                         for (std::size_t c = 0; c < 2; ++c) corner[c] *= space.texture[c];
                       return corners;
                     });
}

/// Meshes with decals for all of their instances as well as for some.
std::set<std::size_t> find_mixed_meshes(const SolvedJob& job) {
  std::map<std::size_t, std::set<Instance>> kinds;
  for (std::size_t d = 0; d < job.decals.size(); ++d)
    if (job.decals[d].job.output == DecalOutput::bake)
      for (const SeparatedTriangle& t : touched_triangles(job, d))
        kinds[job.model.parts[t.part].mesh].insert(job.decals[d].job.instance);
  std::set<std::size_t> mixed;
  for (const auto& [mesh, instances] : kinds)
    if (instances.size() > 1) mixed.insert(mesh);
  return mixed;
}

UvConflict outcome_of(const SolvedJob& job, const UvFinding& finding) {
  const UvConflict wish = job.decals[finding.decal].job.uv_conflict;
  if (wish == UvConflict::share && finding.trouble == UvTrouble::missing) return UvConflict::error;
  if (wish == UvConflict::separate && finding.mixed_instances) return UvConflict::error;
  return wish;
}

std::string mesh_name(const SolvedJob& job, const UvFinding& finding) {
  const std::size_t mesh = job.model.parts[finding.triangles.front().part].mesh;
  const std::string name = job.model.document.json["meshes"][mesh].value("name", std::string());
  return name.empty() ? fmt::format("mesh {}", mesh) : fmt::format("mesh '{}'", name);
}

std::string slot_names(const UvFinding& finding) {
  std::vector<const char*> names;
  for (const MaterialSlot slot : finding.slots) names.push_back(name_of(slot));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string reason_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding) {
  const std::size_t all = finding.triangles.size();
  const std::string part = finding.in_conflict == all ? "" : fmt::format("{} of ", finding.in_conflict);
  const std::string where = fmt::format("{}its {} {} on {}", part, all, all == 1 ? "triangle" : "triangles",
                                        quoted_name(job.model, group.material));
  const char* have = finding.in_conflict == 1 ? "has" : "have";
  switch (finding.trouble) {
    case UvTrouble::missing:
      return fmt::format("{}, of {}, {} no texture coordinates ({})", where, mesh_name(job, finding), have,
                         slot_names(finding));
    case UvTrouble::shared:
      return fmt::format("{} {} texels that are shown by other triangles too ({} of {}; {})", where, have,
                         finding.shared_texels, finding.covered_texels, slot_names(finding));
    case UvTrouble::seams:
      return fmt::format("{} lie on several islands of texture coordinates ({})", where, slot_names(finding));
    case UvTrouble::coarse:
      break;
  }
  return fmt::format("{} {} texture coordinates that are too coarse for it ({})", where, have,
                     slot_names(finding));
}

/// What to do about an error: only what helps.
std::string advice_of(const SolvedJob& job, const UvFinding& finding) {
  const std::string separate =
      finding.mixed_instances
          ? fmt::format("with one \"instance\" for all decals on {} and \"uv_conflict\": \"separate\"",
                        mesh_name(job, finding))
          : "with \"uv_conflict\": \"separate\"";
  std::string advice = separate + " they get texture space of their own";
  if (finding.trouble == UvTrouble::shared) advice += ", with \"share\" it appears on the others as well";
  if (finding.trouble == UvTrouble::coarse) advice += ", with \"share\" its detail is lost there";
  return advice + ", and with \"output\": \"overlay\" it needs none";
}

std::string outcome_sentence(const SolvedJob& job, const UvFinding& finding) {
  switch (finding.outcome) {
    case UvConflict::separate:
      return finding.triangles.size() == 1
                 ? "it gets texture space of its own"
                 : fmt::format("all {} get texture space of their own", finding.triangles.size());
    case UvConflict::share:
      return finding.trouble == UvTrouble::shared ? "the decal appears on the others as well"
                                                  : "its detail is lost there";
    case UvConflict::error:
      break;
  }
  return advice_of(job, finding);
}

std::string message_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding) {
  return fmt::format("decal '{}': {}; {}", job.decals[finding.decal].job.name, reason_of(job, group, finding),
                     outcome_sentence(job, finding));
}

}  // namespace

std::string quoted_name(const Model& model, std::optional<std::size_t> material) {
  if (!material) return "no material";
  const std::string& name = model.materials[*material].name;
  return name.empty() ? fmt::format("material {}", *material) : fmt::format("'{}'", name);
}

Result<std::vector<TextureGroup>> find_texture_groups(const SolvedJob& job) {
  struct Touch {
    bool every_node = true;
    std::set<MaterialSlot> written;
  };
  std::map<std::uint32_t, Touch> touched;
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    const DecalJob& decal = job.decals[d].job;
    if (decal.output != DecalOutput::bake) continue;
    for (const SeparatedTriangle& t : touched_triangles(job, d)) {
      Touch& touch = touched[part_that_stands_for(job.model, decal, t.part)];
      touch.every_node = touch.every_node && decal.instance == Instance::all;
      for (const DecalLayer& layer : decal.layers) touch.written.insert(layer.slot);
    }
  }
  std::vector<PartKey> keys;
  for (const auto& [p, touch] : touched) {
    const ModelPart& part = job.model.parts[p];
    keys.push_back({part.node, part.mesh, part.primitive, touch.every_node});
  }
  const std::vector<std::size_t> ranks = instance_ranks(keys);
  std::map<std::pair<std::optional<std::size_t>, std::size_t>, TextureGroup> groups;
  std::size_t i = 0;
  for (const auto& [p, touch] : touched) {
    const auto material = job.model.parts[p].material;
    TextureGroup& group = groups[{material, ranks[i++]}];
    group.material = material;
    group.parts.push_back(p);
    group.written.insert(touch.written.begin(), touch.written.end());
  }
  std::vector<TextureGroup> list;
  for (auto& [key, group] : groups) {
    group.texture = {job.job.texture_size, job.job.texture_size};
    const auto image = group.material ? job.model.materials[*group.material].image : std::nullopt;
    group.has_texture = image.has_value();
    // One that cannot be read matters only to a decal that is baked into it, and is told there.
    if (image)
      if (const auto size = document_image_size(job.model.document, *image)) group.texture = *size;
    list.push_back(std::move(group));
  }
  return list;
}

Result<std::vector<UvFinding>> find_uv_conflicts(const SolvedJob& job, const TextureGroup& group) {
  APPLIQUE_TRY(const std::vector<TextureSpace> spaces, find_spaces(job, group));
  std::vector<UvCoverage> coverages;
  coverages.reserve(spaces.size());
  for (const TextureSpace& space : spaces) coverages.push_back(cover(job, group, space));
  const std::set<std::size_t> mixed = find_mixed_meshes(job);
  std::vector<UvFinding> findings;
  for (std::size_t d = 0; d < job.decals.size(); ++d) {
    const DecalJob& decal = job.decals[d].job;
    if (decal.output != DecalOutput::bake) continue;
    UvFinding finding;
    finding.decal = d;
    for (const SeparatedTriangle& t : touched_triangles(job, d))
      if (std::binary_search(group.parts.begin(), group.parts.end(),
                             part_that_stands_for(job.model, decal, t.part))) {
        finding.triangles.push_back(t);
        finding.mixed_instances = finding.mixed_instances || mixed.contains(job.model.parts[t.part].mesh);
      }
    std::optional<UvTrouble> worst;
    std::optional<bool> unwrapped;
    std::set<std::size_t> in_conflict;
    for (std::size_t s = 0; s < spaces.size(); ++s) {
      std::vector<MaterialSlot> slots;
      std::copy_if(spaces[s].slots.begin(), spaces[s].slots.end(), std::back_inserter(slots),
                   [&](MaterialSlot slot) { return writes(decal, slot); });
      if (slots.empty() || finding.triangles.empty()) continue;
      const SpaceState state = find_state(job, spaces[s], coverages[s], finding.triangles);
      auto trouble = state.trouble();
      if (job.job.unwrap != Unwrap::never && decal.uv_conflict == UvConflict::separate &&
          !finding.mixed_instances) {
        // Not for a seam in another place; but where triangles are separated anyway, for no more of them.
        constexpr double far_less = 0.5;
        const double crossed = seam_pixels_in(job, spaces[s], d);
        if (crossed > 0 && !unwrapped)
          unwrapped = job.job.unwrap == Unwrap::always ||
                      unwraps_unseen(job, group, finding.triangles, (trouble ? 1 : far_less) * crossed);
        if (crossed > 0 && *unwrapped && !trouble) {
          trouble = UvTrouble::seams;
          for (std::size_t i = 0; i < finding.triangles.size(); ++i) in_conflict.insert(i);
        }
      }
      if (!trouble) continue;
      worst = std::min(worst.value_or(*trouble), *trouble);
      finding.slots.insert(finding.slots.end(), slots.begin(), slots.end());
      in_conflict.insert(state.in_conflict.begin(), state.in_conflict.end());
      if (finding.slots.size() > slots.size() && state.shared_texels <= finding.shared_texels) continue;
      finding.covered_texels = state.covered_texels;
      finding.shared_texels = state.shared_texels;
    }
    if (!worst) continue;
    std::sort(finding.slots.begin(), finding.slots.end());
    finding.trouble = *worst;
    for (SeparatedTriangle& t : finding.triangles) t.unwrap = unwrapped.value_or(false);
    finding.in_conflict = in_conflict.size();
    finding.outcome = outcome_of(job, finding);
    findings.push_back(std::move(finding));
  }
  return findings;
}

Result<std::vector<GroupFindings>> find_uv_conflicts(const SolvedJob& job) {
  APPLIQUE_TRY(auto groups, find_texture_groups(job));
  std::vector<GroupFindings> list;
  for (TextureGroup& group : groups) {
    APPLIQUE_TRY(auto findings, find_uv_conflicts(job, group));
    list.push_back({std::move(group), std::move(findings)});
  }
  return list;
}

UvConflictReport report_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding) {
  UvConflictReport report;
  if (group.material) {
    report.material = job.model.materials[*group.material].name;
    if (report.material->empty()) report.material = fmt::format("material {}", *group.material);
  }
  for (const MaterialSlot slot : finding.slots) report.slots.emplace_back(name_of(slot));
  constexpr std::array reasons = {"missing", "shared", "coarse", "seams"};
  report.reason = reasons.at(static_cast<std::size_t>(finding.trouble));
  constexpr std::array outcomes = {"separate", "error", "share"};
  report.outcome = outcomes.at(static_cast<std::size_t>(finding.outcome));
  report.triangles = finding.triangles.size();
  report.in_conflict = finding.in_conflict;
  report.covered_texels = finding.covered_texels;
  report.shared_texels = finding.shared_texels;
  report.message = message_of(job, group, finding);
  return report;
}

Error error_of(const SolvedJob& job, const TextureGroup& group, const UvFinding& finding) {
  return {finding.trouble == UvTrouble::missing ? ErrorCode::uvs_missing : ErrorCode::uvs_shared,
          message_of(job, group, finding)};
}

}  // namespace applique
