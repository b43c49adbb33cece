#include "separate_uvs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "binary_edit.h"
#include "edit.h"
#include "geometry.h"
#include "move_triangles.h"
#include "tangent_turns.h"
#include "texel_map.h"
#include "texture_slots.h"
#include "uv_conflict.h"
#include "uv_layout.h"
#include "uv_raster.h"
#include "uv_resample.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Where the triangles of a part went: those that moved, and the primitive that they are now.
struct PartMove {
  std::vector<std::uint32_t> triangles;  ///< In their new order.
  std::size_t primitive = 0;
};

std::string material_name(const Model& model, std::optional<std::size_t> material) {
  if (!material) return "no material";
  const std::string& name = model.materials[*material].name;
  return name.empty() ? fmt::format("material {}", *material) : fmt::format("'{}'", name);
}

Result<void> refuse(const SolvedJob& job, std::size_t decal, const TextureGroup& group,
                    const UvState& state) {
  const std::string reason =
      state.without_uvs ? fmt::format("{} has triangles without texture coordinates",
                                      material_name(job.model, group.material))
      : state.shared_texels > 0
          ? fmt::format("{} of its {} texels of {} are shown by other triangles too", state.shared_texels,
                        state.covered_texels, material_name(job.model, group.material))
          : fmt::format("the texture coordinates of {} are too coarse for it",
                        material_name(job.model, group.material));
  return fail(state.without_uvs ? ErrorCode::uvs_missing : ErrorCode::uvs_shared,
              fmt::format("decal '{}': {}; with \"uv_conflict\": \"separate\" it gets texture space of its "
                          "own, with \"share\" it appears there as well",
                          job.decals[decal].job.name, reason));
}

/// The triangles of a group that are to be separated, each once.
Result<std::vector<SeparatedTriangle>> find_conflicts(const SolvedJob& job, const TextureGroup& group) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, SeparatedTriangle> chosen;
  const std::vector<UvState> states = find_uv_states(job, group);
  for (std::size_t d = 0; d < states.size(); ++d) {
    // Instances of one mesh show the same texels, and with "all" they are to.
    if (!states[d].conflicts() || job.decals[d].job.instance == Instance::all) continue;
    switch (job.decals[d].job.uv_conflict) {
      case UvConflict::share:
        break;
      case UvConflict::error:
        APPLIQUE_CHECK(refuse(job, d, group, states[d]));
        break;
      case UvConflict::separate:
        for (const SeparatedTriangle& t : states[d].triangles) chosen.try_emplace({t.part, t.triangle}, t);
    }
  }
  std::vector<SeparatedTriangle> list;
  for (const auto& [key, t] : chosen) list.push_back(t);
  return list;
}

/// Edits the document for the groups of a job, one after the other.
class Separation {
 public:
  explicit Separation(SolvedJob& job) : job_(job), document_(job.model.document) {}

  Result<void> separate(const TextureGroup& group, std::vector<SeparatedTriangle> triangles) {
    if (!geometry_) {
      APPLIQUE_TRY(const Buffers buffers, read_buffers(job_.model.document));
      APPLIQUE_TRY(geometry_, decode_geometry(job_.model.document, buffers));
    }
    LayoutRequest request;
    request.triangles = std::move(triangles);
    request.texture = group.texture;
    if (!group.has_texture) request.created_size = job_.job.texture_size;
    const std::size_t material = isolate(group, request);
    std::vector<TextureSlots> slots = find_texture_slots(document_.json["materials"][material]);
    APPLIQUE_TRY(std::vector<Image> images, load_slots(slots, request));
    request.grid = grid_for(request, images);
    APPLIQUE_TRY(const UvLayout layout, lay_out_uvs(job_, request));
    warn_of_scale(group, request, layout);
    const std::size_t set = uv_set(group, request, slots, images);
    std::vector<OldCorners> corners;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      APPLIQUE_TRY(auto old, old_corners(slots[s], images[s], request));
      corners.push_back(std::move(old));
    }
    Tangents tangents;
    const bool turned = turns_frames(slots, images, corners, layout);
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (images[s].rgba.empty()) continue;
      std::vector<std::array<FrameTurn, 3>> turns;
      if (turned && slots[s].content == TexelContent::normal) {
        APPLIQUE_TRY(turns, turn_frames(request, layout, corners[s], tangents));
      }
      APPLIQUE_CHECK(resample(slots[s], images[s], group, request, layout, material, set,
                              std::move(corners[s]), std::move(turns)));
    }
    return move(request, layout, material, set, tangents);
  }

  /// Replaces the job's model, and returns the parts that are new.
  Result<std::vector<std::uint32_t>> finish() {
    clean_up();
    const std::vector<ModelPart> old_parts = std::move(job_.model.parts);
    APPLIQUE_TRY(job_.model, decode_model(std::move(document_)));
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> index;  // node and primitive -> part
    for (std::uint32_t p = 0; p < job_.model.parts.size(); ++p)
      index[{job_.model.parts[p].node, job_.model.parts[p].primitive}] = p;
    follow(old_parts, index);
    std::vector<std::uint32_t> separated;
    for (const auto& [part, move] : moves_)
      separated.push_back(index.at({old_parts[part].node, move.primitive}));
    std::sort(separated.begin(), separated.end());
    return separated;
  }

 private:
  using OldCorners = std::vector<std::array<Texel, 3>>;
  /// By triangle of the request and corner; without an entry where a part has no normals. Empty: they stay.
  using Tangents = std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::array<float, 4>, 3>>;

  /// A material for the triangles: what the rest of the parts shows stays as it was.
  std::size_t isolate(const TextureGroup& group, const LayoutRequest& request) {
    std::map<std::uint32_t, std::size_t> taken;
    for (const SeparatedTriangle& t : request.triangles) ++taken[t.part];
    std::vector<PartKey> keys;
    bool rest = false;
    for (const auto& [p, count] : taken) {
      const ModelPart& part = job_.model.parts[p];
      keys.push_back(
          {part.node, document_.json["nodes"][part.node]["mesh"].get<std::size_t>(), part.primitive});
      rest = rest || count < part.triangles.size();
    }
    std::size_t material = isolate_materials(document_, keys).front();
    if (rest && group.material == material) {
      Json copy = document_.json["materials"][material];
      material = document_.json["materials"].size();
      document_.json["materials"].push_back(std::move(copy));
    }
    return material;
  }

  /// The slots' images; empty where one cannot be read, with a warning, unless it is the base colour's.
  Result<std::vector<Image>> load_slots(const std::vector<TextureSlots>& slots,
                                        const LayoutRequest& request) {
    std::vector<Image> images;
    for (const TextureSlots& slot : slots) {
      const auto index = image_of_texture(document_.json["textures"][slot.texture]);
      auto image = index ? load_document_image(document_, *index) : Result<Image>(Image());
      if (!image) {
        if (slot.name == "baseColorTexture") return fail(image.error().code, image.error().message);
        SolvedDecal& decal = job_.decals[request.triangles.front().decal];
        decal.warnings.push_back(
            {"uv_slot_not_resampled",
             fmt::format("decal '{}': the {} under it keeps its old texture coordinates, because {}",
                         decal.job.name, slot.name, image.error().message)});
        image = Image();
      }
      images.push_back(std::move(*image));
    }
    return images;
  }

  /// Charts move by so many texels of the base colour that coarser textures move by whole texels too.
  static int grid_for(const LayoutRequest& request, const std::vector<Image>& images) {
    constexpr int coarsest = 64;
    int grid = 1;
    for (const Image& image : images)
      while (!image.rgba.empty() && grid < coarsest &&
             (grid * image.width < request.texture[0] || grid * image.height < request.texture[1]))
        grid *= 2;
    return grid;
  }

  void warn_of_scale(const TextureGroup& group, const LayoutRequest& request, const UvLayout& layout) {
    if (!group.has_texture || layout.scale == 1) return;
    SolvedDecal& decal = job_.decals[request.triangles.front().decal];
    decal.warnings.push_back(
        {"uv_atlas_coarser",
         fmt::format("decal '{}': the texture of {} repeats so often under it that its own space there has "
                     "{:.2g} times the texels along a line",
                     decal.job.name, material_name(job_.model, group.material), layout.scale)});
  }

  /// The TEXCOORD for the new coordinates: 0, unless something goes on to use the old ones.
  std::size_t uv_set(const TextureGroup& group, const LayoutRequest& request,
                     const std::vector<TextureSlots>& slots, const std::vector<Image>& images) {
    bool used = false;
    for (std::size_t s = 0; s < slots.size(); ++s) used = used || images[s].rgba.empty();
    std::size_t sets = 0;
    for (const SeparatedTriangle& t : request.triangles) {
      const ModelPart& part = job_.model.parts[t.part];
      const auto& primitive = job_.model.document.json["meshes"][part.mesh]["primitives"][part.primitive];
      if (const auto* extensions = find(primitive, {"extensions"}))
        for (const auto& item : extensions->items())
          used = used || item.key() != "KHR_draco_mesh_compression";
      std::size_t count = 0;
      while (primitive["attributes"].contains(fmt::format("TEXCOORD_{}", count))) ++count;
      sets = std::max(sets, count);
    }
    // A base-colour texture that the bake makes is shown through the first set.
    return used && group.has_texture ? sets : 0;
  }

  /// Whether directions in some texture would mean something else in the layout.
  static bool turns_frames(const std::vector<TextureSlots>& slots, const std::vector<Image>& images,
                           const std::vector<OldCorners>& corners, const UvLayout& layout) {
    for (std::size_t s = 0; s < slots.size(); ++s)
      if (slots[s].content == TexelContent::normal && !images[s].rgba.empty() &&
          !same_frames(corners[s], layout.corners))
        return true;
    return false;
  }

  /// The turn of each triangle's frame; the new tangents go into `tangents`.
  Result<std::vector<std::array<FrameTurn, 3>>> turn_frames(const LayoutRequest& request,
                                                            const UvLayout& layout, const OldCorners& corners,
                                                            Tangents& tangents) {
    std::map<std::uint32_t, std::vector<std::size_t>> parts;
    for (std::size_t i = 0; i < request.triangles.size(); ++i) parts[request.triangles[i].part].push_back(i);
    std::vector<std::array<FrameTurn, 3>> turns(request.triangles.size());
    for (const auto& [p, members] : parts) {
      APPLIQUE_TRY(TangentFrames frames, read_frames(job_.model.parts[p]));
      for (const std::size_t i : members) {
        frames.triangles.push_back(job_.model.parts[p].triangles[request.triangles[i].triangle]);
        frames.old_corners.push_back(corners[i]);
        frames.new_corners.push_back(layout.corners[i]);
      }
      const bool mirrored = job_.model.parts[p].mirrored;
      if (mirrored) turn_over(frames);
      TangentTurns turned = turn_tangents(frames);
      for (std::size_t j = 0; j < members.size(); ++j) {
        if (mirrored) {
          std::swap(turned.turns[j][1], turned.turns[j][2]);
          std::swap(turned.tangents[j][1], turned.tangents[j][2]);
        }
        turns[members[j]] = turned.turns[j];
        if (!frames.normals.empty())
          tangents[{p, request.triangles[members[j]].triangle}] = turned.tangents[j];
      }
    }
    return turns;
  }

  Result<TangentFrames> read_frames(const ModelPart& part) {
    const auto& entry = geometry_->meshes[part.mesh].primitives[part.primitive];
    const std::string where = fmt::format("mesh {}, primitive {}", part.mesh, part.primitive);
    const auto read = [&](const char* name, int components) -> Result<std::vector<double>> {
      const auto attribute = entry.attributes.find(name);
      if (attribute == entry.attributes.end()) return std::vector<double>();
      APPLIQUE_TRY(auto values,
                   read_accessor(*geometry_, attribute->second, components, where + ", " + name));
      values.resize(part.positions.size() * static_cast<std::size_t>(components), 0);
      return values;
    };
    TangentFrames frames;
    APPLIQUE_TRY(const auto positions, read("POSITION", 3));
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
      frames.positions.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
    APPLIQUE_TRY(const auto normals, read("NORMAL", 3));
    for (std::size_t i = 0; i + 2 < normals.size(); i += 3)
      frames.normals.emplace_back(normals[i], normals[i + 1], normals[i + 2]);
    if (normals.empty()) return frames;  // without normals, tangents do not count
    APPLIQUE_TRY(const auto tangents, read("TANGENT", 4));
    for (std::size_t i = 0; i + 3 < tangents.size(); i += 4)
      frames.tangents.push_back({tangents[i], tangents[i + 1], tangents[i + 2], tangents[i + 3]});
    return frames;
  }

  /// The decoder exchanged two corners where the node mirrors: back to the file's order.
  static void turn_over(TangentFrames& frames) {
    for (auto& triangle : frames.triangles) std::swap(triangle[1], triangle[2]);
    for (auto* corners : {&frames.old_corners, &frames.new_corners})
      for (auto& corner : *corners) std::swap(corner[1], corner[2]);
  }

  Result<std::vector<std::array<Texel, 3>>> old_corners(const TextureSlots& slot, const Image& image,
                                                        const LayoutRequest& request) {
    std::map<std::uint32_t, std::vector<double>> uvs;
    std::vector<std::array<Texel, 3>> list;
    for (const SeparatedTriangle& t : request.triangles) {
      const ModelPart& part = job_.model.parts[t.part];
      const auto [values, fresh] = uvs.try_emplace(t.part);
      if (fresh) {
        const auto& entry = geometry_->meshes[part.mesh].primitives[part.primitive];
        const auto attribute = entry.attributes.find(fmt::format("TEXCOORD_{}", slot.mapping.set));
        if (attribute != entry.attributes.end()) {
          APPLIQUE_TRY(values->second, read_accessor(*geometry_, attribute->second, 2,
                                                     fmt::format("mesh {}, primitive {}, {}", part.mesh,
                                                                 part.primitive, attribute->first)));
        }
        // Where there are no coordinates, all are 0.
        values->second.resize(2 * part.positions.size(), 0);
      }
      std::array<Texel, 3> corners = {};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t vertex = part.triangles[t.triangle][k];
        const auto uv = slot.mapping.apply({values->second[2 * vertex], values->second[2 * vertex + 1]});
        corners[k] = {uv[0] * image.width, uv[1] * image.height};
      }
      list.push_back(corners);
    }
    return list;
  }

  Result<void> resample(const TextureSlots& slot, const Image& image, const TextureGroup& group,
                        const LayoutRequest& request, const UvLayout& layout, std::size_t material,
                        std::size_t set, OldCorners corners, std::vector<std::array<FrameTurn, 3>> turns) {
    Resampling resampling;
    resampling.old_corners = std::move(corners);
    resampling.turns = std::move(turns);
    resampling.texture = &image;
    const auto& texture = document_.json["textures"][slot.texture];
    const auto [wrap_u, wrap_v] = read_wrap_modes(document_, texture);
    resampling.wrap_u = wrap_u;
    resampling.wrap_v = wrap_v;
    resampling.nearest = is_nearest(texture);
    resampling.content = slot.content;
    resampling.layout = &layout;
    const UvMapping base = group.material
                               ? read_uv_mapping(job_.model.document.json["materials"][*group.material])
                               : UvMapping();
    const bool is_base = slot.name == "baseColorTexture";
    if (slot.mapping == base)
      resampling.reference = {static_cast<double>(request.texture[0]) / image.width,
                              static_cast<double>(request.texture[1]) / image.height};
    resampling.size = is_base ? layout.size : slot_size(resampling, layout);
    APPLIQUE_TRY(const auto png, encode_png(resample_texture(resampling)));
    for (const SlotPointer& pointer : slot.slots) show_whole(material, pointer, set);
    set_slot_images(document_, material, slot.slots, png, slot.name);
    clamp(document_.json["materials"][material][slot.slots.front()]["index"].get<std::size_t>());
    return {};
  }

  /// Nothing of an atlas lies beyond its border, and textures of any size can be clamped.
  void clamp(std::size_t texture) {
    constexpr int to_edge = 33071;
    if (!document_.json.contains("samplers")) document_.json["samplers"] = Json::array();
    auto& textures = document_.json["textures"];
    auto& samplers = document_.json["samplers"];
    const auto old = index_of(textures[texture], "sampler");
    Json sampler = old ? samplers[*old] : Json::object();
    sampler["wrapS"] = to_edge;
    sampler["wrapT"] = to_edge;
    const bool alone = old && std::count_if(textures.begin(), textures.end(), [&](const Json& other) {
                                return index_of(other, "sampler") == old;
                              }) == 1;
    const auto same = std::find(samplers.begin(), samplers.end(), sampler);
    if (alone) {
      samplers[*old] = std::move(sampler);
    } else if (same != samplers.end()) {
      textures[texture]["sampler"] = same - samplers.begin();
    } else {
      textures[texture]["sampler"] = samplers.size();
      samplers.push_back(std::move(sampler));
    }
  }

  [[nodiscard]] bool is_nearest(const Json& texture) const {
    constexpr std::size_t nearest = 9728;
    const auto sampler = index_of(texture, "sampler");
    return sampler && index_of(document_.json["samplers"][*sampler], "magFilter") == nearest;
  }

  /// The size at which no detail of the slot's texture is lost.
  static std::array<int, 2> slot_size(const Resampling& resampling, const UvLayout& layout) {
    constexpr double largest = 8192;
    std::array<double, 2> density = {1, 1};  // texels by texel of the base colour
    if (resampling.reference[0] > 0) {
      for (std::size_t c = 0; c < 2; ++c) density[c] = 1 / (resampling.reference[c] * layout.scale);
    } else {
      constexpr double most = 8;
      density.fill(std::clamp(usual_stretch(layout.corners, resampling.old_corners) / layout.fineness,
                              1 / most, most));
    }
    std::array<int, 2> size = {};
    for (std::size_t c = 0; c < 2; ++c)
      size[c] = static_cast<int>(std::clamp(std::round(layout.size[c] * density[c]), 1.0, largest));
    return size;
  }

  /// The reference shows the new coordinates, untransformed.
  void show_whole(std::size_t material, const SlotPointer& slot, std::size_t set) {
    auto& reference = document_.json["materials"][material][slot];
    reference.erase("texCoord");
    if (set != 0) reference["texCoord"] = set;
    if (!reference.contains("extensions")) return;
    reference["extensions"].erase("KHR_texture_transform");
    if (reference["extensions"].empty()) reference.erase("extensions");
  }

  Result<void> move(const LayoutRequest& request, const UvLayout& layout, std::size_t material,
                    std::size_t set, const Tangents& tangents) {
    std::map<std::uint32_t, MovedTriangles> parts;
    for (std::size_t i = 0; i < request.triangles.size(); ++i) {
      const SeparatedTriangle& t = request.triangles[i];
      MovedTriangles& moved = parts[t.part];
      moved.triangles.push_back(t.triangle);
      std::array<std::array<float, 2>, 3> uvs = {};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto uv = layout.uv(layout.corners[i][k]);
        uvs[k] = {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
      }
      moved.uvs.push_back(uvs);
      if (const auto turned = tangents.find({t.part, t.triangle}); turned != tangents.end())
        moved.tangents.push_back(turned->second);
    }
    for (auto& [p, moved] : parts) {
      const ModelPart& part = job_.model.parts[p];
      moved.part = p;
      moved.material = material;
      moved.rest_material = part.material;
      moved.uv_set = set;
      const std::size_t mesh = document_.json["nodes"][part.node]["mesh"].get<std::size_t>();
      const Json old = document_.json["meshes"][mesh]["primitives"][part.primitive];
      const auto accessors = accessors_of(old);
      old_accessors_.insert(old_accessors_.end(), accessors.begin(), accessors.end());
      if (const auto* draco = find(old, {"extensions", "KHR_draco_mesh_compression"}))
        if (const auto view = index_of(*draco, "bufferView")) old_views_.insert(*view);
      APPLIQUE_TRY(const std::size_t primitive, move_triangles(document_, job_.model, *geometry_, moved));
      moves_[p] = {std::move(moved.triangles), primitive};
    }
    return {};
  }

  void clean_up() {
    for (auto view = old_views_.rbegin(); view != old_views_.rend(); ++view)
      if (count_view_uses(document_, *view) == 0) remove_buffer_view(document_, *view);
    remove_unused_accessors(document_, std::move(old_accessors_));
    if (old_views_.empty() || document_.json["meshes"].dump().find("KHR_draco") != std::string::npos) return;
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      if (!document_.json.contains(list)) continue;
      auto& names = document_.json[list];
      names.erase(std::remove(names.begin(), names.end(), "KHR_draco_mesh_compression"), names.end());
      if (names.empty()) document_.json.erase(list);
    }
  }

  /// Leads the sources of the decals' surfaces to the new parts.
  void follow(const std::vector<ModelPart>& old_parts,
              const std::map<std::pair<std::size_t, std::size_t>, std::uint32_t>& index) {
    std::vector<std::vector<ModelSurface::Source>> places(old_parts.size());
    for (std::uint32_t p = 0; p < old_parts.size(); ++p) {
      const ModelPart& part = old_parts[p];
      const auto move = moves_.find(p);
      std::vector<std::uint32_t> rank(part.triangles.size(), ~0U);
      if (move != moves_.end())
        for (std::uint32_t i = 0; i < move->second.triangles.size(); ++i) rank[move->second.triangles[i]] = i;
      std::uint32_t kept = 0;
      for (const std::uint32_t moved : rank) {
        const std::size_t primitive = moved == ~0U ? part.primitive : move->second.primitive;
        places[p].push_back({index.at({part.node, primitive}), moved == ~0U ? kept++ : moved});
      }
    }
    std::map<const ModelSurface*, std::shared_ptr<const ModelSurface>> surfaces;
    for (SolvedDecal& decal : job_.decals) {
      auto& followed = surfaces[decal.surface.get()];
      if (!followed) {
        auto copy = std::make_shared<ModelSurface>(*decal.surface);
        for (auto& source : copy->sources) source = places[source.part][source.triangle];
        followed = std::move(copy);
      }
      decal.surface = followed;
    }
  }

  SolvedJob& job_;
  Document document_;
  std::optional<tinygltf::Model> geometry_;
  std::map<std::uint32_t, PartMove> moves_;  ///< By old part.
  std::vector<std::size_t> old_accessors_;   ///< Of the primitives that changed.
  std::set<std::size_t> old_views_;          ///< Their Draco data.
};

}  // namespace

Result<std::vector<std::uint32_t>> separate_uvs(SolvedJob& job) {
  APPLIQUE_TRY(const auto groups, find_texture_groups(job));
  std::optional<Separation> separation;
  for (const TextureGroup& group : groups) {
    APPLIQUE_TRY(auto triangles, find_conflicts(job, group));
    if (triangles.empty()) continue;
    if (!separation) separation.emplace(job);
    APPLIQUE_CHECK(separation->separate(group, std::move(triangles)));
  }
  if (!separation) return std::vector<std::uint32_t>();
  return separation->finish();
}

}  // namespace applique
