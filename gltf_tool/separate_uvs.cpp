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

#include "bake_plan.h"
#include "binary_edit.h"
#include "edit.h"
#include "geometry.h"
#include "instances.h"
#include "move_triangles.h"
#include "tangent_turns.h"
#include "tangents.h"
#include "texel_map.h"
#include "texture_encoding.h"
#include "texture_slots.h"
#include "uv_conflict.h"
#include "uv_layout.h"
#include "uv_raster.h"
#include "uv_resample.h"
#include "write_tangents.h"

namespace applique {
namespace {

using Json = Document::Json;

/// Where the triangles of a part went: those that moved, and the primitive that they are now.
struct PartMove {
  std::vector<std::uint32_t> triangles;  ///< In their new order.
  std::size_t primitive = 0;
  bool every_node = false;  ///< So did those of all other nodes that show the mesh.
};

/// The triangles of a group that are to be separated, each once in its mesh: of the decals on it, for the one
/// that is to be unwrapped, and the largest.
std::vector<SeparatedTriangle> triangles_to_separate(const SolvedJob& job,
                                                     const std::vector<UvFinding>& findings) {
  std::vector<const UvFinding*> ordered;
  for (const UvFinding& finding : findings)
    if (finding.outcome == UvConflict::separate) ordered.push_back(&finding);
  std::stable_sort(ordered.begin(), ordered.end(), [](const UvFinding* a, const UvFinding* b) {
    return std::pair(a->triangles.front().unwrap, a->triangles.size()) >
           std::pair(b->triangles.front().unwrap, b->triangles.size());
  });
  std::map<std::pair<std::uint32_t, std::uint32_t>, SeparatedTriangle> chosen;
  for (const UvFinding* finding : ordered) {
    const DecalJob& decal = job.decals[finding->decal].job;
    for (const SeparatedTriangle& t : finding->triangles)
      chosen.try_emplace({part_that_stands_for(job.model, decal, t.part), t.triangle}, t);
  }
  std::vector<SeparatedTriangle> list;
  for (const auto& [key, t] : chosen) list.push_back(t);
  return list;
}

/// Edits the document for the groups of a job, one after the other.
class Separation {
 public:
  Separation(SolvedJob& job, const TextureEncoding& encoding)
      : job_(job), encoding_(encoding), document_(job.model.document) {}

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
    const std::set<MaterialSlot> written = slots_written(request);
    const std::vector<BakedSlots> slots = find_slots(material, written);
    APPLIQUE_TRY(std::vector<Image> images, load_slots(slots, request));
    request.grid = grid_for(request, images);
    APPLIQUE_TRY(const UvLayout layout, lay_out_uvs(job_, request));
    warn_of_scale(group, request, layout);
    const std::size_t set = uv_set(request, images);
    std::vector<OldCorners> corners;
    for (std::size_t s = 0; s < slots.size(); ++s)
      corners.push_back(old_corners(slots[s].mapping, images[s], request));
    Tangents tangents;
    const bool anisotropic = is_anisotropic(material);
    if (anisotropic) APPLIQUE_CHECK(keep_tangents(request, layout, material, tangents));
    const bool turned = !anisotropic && turns_frames(slots, images, corners, layout);
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (images[s].rgba.empty()) continue;
      std::vector<std::array<FrameTurn, 3>> turns;
      if (turned && slots[s].content == TexelContent::normal) {
        APPLIQUE_TRY(turns, turn_frames(request, layout, corners[s], tangents));
      }
      APPLIQUE_CHECK(resample(slots[s], images[s], group, request, layout, material, set,
                              std::move(corners[s]), std::move(turns)));
    }
    if (set != 0 && !is_resampled(MaterialSlot::base_color, slots, images))
      APPLIQUE_CHECK(make_textures(group, written, material, layout, set));
    return move(request, layout, material, set, tangents);
  }

  /// Replaces the job's model, and returns the parts that are new.
  Result<SeparatedUvs> finish() {
    clean_up();
    const std::vector<ModelPart> old_parts = std::move(job_.model.parts);
    APPLIQUE_TRY(job_.model, decode_model(std::move(document_)));
    std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> index;  // node and primitive -> part
    for (std::uint32_t p = 0; p < job_.model.parts.size(); ++p)
      index[{job_.model.parts[p].node, job_.model.parts[p].primitive}] = p;
    follow(old_parts, index);
    for (std::uint32_t p = 0; p < old_parts.size(); ++p) {
      const PartMove* move = move_of(old_parts, p);
      if (move == nullptr) continue;
      const ModelPart& old = old_parts[p];
      const std::uint32_t part = index.at({old.node, move->primitive});
      done_.parts.push_back(part);
      if (move->primitive == old.primitive) continue;  // Nothing is left.
      FormerTriangles& former = job_.former[part];
      former.part = index.at({old.node, old.primitive});
      for (const std::uint32_t t : move->triangles) former.corners.push_back(old.triangles[t]);
    }
    std::sort(done_.parts.begin(), done_.parts.end());
    return std::move(done_);
  }

 private:
  using OldCorners = std::vector<std::array<Texel, 3>>;
  /// By triangle of the request and corner; without an entry where a part has no normals. Empty: they stay.
  using Tangents = std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::array<float, 4>, 3>>;

  [[nodiscard]] std::uint32_t standing_for(const SeparatedTriangle& t) const {
    return part_that_stands_for(job_.model, job_.decals[t.decal].job, t.part);
  }

  [[nodiscard]] bool is_on_every_node(const SeparatedTriangle& t) const {
    return job_.decals[t.decal].job.instance == Instance::all;
  }

  /// A material for the triangles: what the rest of the parts shows stays as it was.
  std::size_t isolate(const TextureGroup& group, const LayoutRequest& request) {
    struct Taken {
      std::size_t count = 0;
      bool every_node = false;
    };
    std::map<std::uint32_t, Taken> taken;
    for (const SeparatedTriangle& t : request.triangles) {
      Taken& part = taken[standing_for(t)];
      ++part.count;
      part.every_node = is_on_every_node(t);
    }
    std::vector<PartKey> keys;
    bool rest = false;
    for (const auto& [p, part_taken] : taken) {
      const ModelPart& part = job_.model.parts[p];
      keys.push_back({part.node, document_.json["nodes"][part.node]["mesh"].get<std::size_t>(),
                      part.primitive, part_taken.every_node});
      rest = rest || part_taken.count < part.triangles.size();
    }
    std::size_t material = isolate_materials(document_, keys).front();
    if (rest && group.material == material) {
      Json copy = document_.json["materials"][material];
      material = document_.json["materials"].size();
      document_.json["materials"].push_back(std::move(copy));
    }
    return material;
  }

  /// What the decals over the triangles write.
  [[nodiscard]] std::set<MaterialSlot> slots_written(const LayoutRequest& request) const {
    std::set<MaterialSlot> written;
    for (const SeparatedTriangle& t : request.triangles)
      for (const DecalLayer& layer : job_.decals[t.decal].job.layers) written.insert(layer.slot);
    return written;
  }

  /// Slots that show one texture, all of which a bake goes on to write, or none.
  struct BakedSlots : TextureSlots {
    bool baked = false;
  };

  [[nodiscard]] std::vector<BakedSlots> find_slots(std::size_t material,
                                                   const std::set<MaterialSlot>& written) const {
    std::vector<SlotPointer> baked;
    for (const MaterialSlot slot : written) baked.push_back(pointer_to(slot));
    std::vector<BakedSlots> list;
    for (TextureSlots& slots : find_texture_slots(document_.json["materials"][material])) {
      if (slots.texture >= count_of(document_, "textures")) continue;  // Of an extension that is not checked.
      const auto rest =
          std::stable_partition(slots.slots.begin(), slots.slots.end(), [&](const SlotPointer& pointer) {
            return std::find(baked.begin(), baked.end(), pointer) != baked.end();
          });
      for (const auto& [first, last] : {std::pair(slots.slots.begin(), rest), {rest, slots.slots.end()}}) {
        if (first == last) continue;
        BakedSlots part{slots, first == slots.slots.begin() && rest != slots.slots.begin()};
        part.slots.assign(first, last);
        part.name = part.slots.front().back();
        list.push_back(std::move(part));
      }
    }
    return list;
  }

  /// The slots' images; empty where one cannot be read, with a warning, unless a decal is baked into it.
  Result<std::vector<Image>> load_slots(const std::vector<BakedSlots>& slots, const LayoutRequest& request) {
    std::vector<Image> images;
    for (const BakedSlots& slot : slots) {
      const auto index = image_of_texture(document_.json["textures"][slot.texture]);
      auto image = index ? load_document_image(document_, *index) : Result<Image>(Image());
      if (!image) {
        if (slot.baked) return fail(image.error().code, image.error().message);
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
                     decal.job.name, quoted_name(job_.model, group.material), layout.scale)});
  }

  /// The TEXCOORD for the new coordinates: 0, unless something goes on to use the old ones.
  std::size_t uv_set(const LayoutRequest& request, const std::vector<Image>& images) {
    bool used =
        std::any_of(images.begin(), images.end(), [](const Image& image) { return image.rgba.empty(); });
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
    return used ? sets : 0;
  }

  static bool is_resampled(MaterialSlot slot, const std::vector<BakedSlots>& slots,
                           const std::vector<Image>& images) {
    const SlotPointer pointer = pointer_to(slot);
    for (std::size_t s = 0; s < slots.size(); ++s)
      if (!images[s].rgba.empty() &&
          std::find(slots[s].slots.begin(), slots[s].slots.end(), pointer) != slots[s].slots.end())
        return true;
    return false;
  }

  /// The textures that a bake would make for the slots, through the coordinates of a base colour that is not
  /// there or keeps the old ones.
  Result<void> make_textures(const TextureGroup& group, const std::set<MaterialSlot>& written,
                             std::size_t material, const UvLayout& layout, std::size_t set) {
    for (const MaterialSlot slot : written) {
      if (find_texture_info(document_.json["materials"][material], slot) != nullptr) continue;
      std::array<int, 2> size = layout.size;
      if (job_.job.resolution && slot != MaterialSlot::base_color) size.fill(*job_.job.resolution);
      APPLIQUE_TRY(const auto png, encode_png(texture_of_factors(job_, group.material, slot, size)));
      set_slot_image(document_, material, slot, png);
      show_whole(material, pointer_to(slot), set);
      done_.made.insert({material, slot});
    }
    return {};
  }

  /// Whether directions in some texture would mean something else in the layout.
  static bool turns_frames(const std::vector<BakedSlots>& slots, const std::vector<Image>& images,
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

  /// The direction of an anisotropy is turned by one angle against the tangents: these have to stay.
  [[nodiscard]] bool is_anisotropic(std::size_t material) const {
    return find(document_.json["materials"][material], {"extensions", "KHR_materials_anisotropy"}) != nullptr;
  }

  /// The coordinates that a primitive without tangents gets them from.
  [[nodiscard]] UvMapping tangent_mapping(std::size_t material) const {
    const auto& entry = document_.json["materials"][material];
    const auto* texture = find(entry, {"extensions", "KHR_materials_anisotropy", "anisotropyTexture"});
    if (texture != nullptr && find_texture_info(entry, MaterialSlot::normal) == nullptr)
      return read_texture_mapping(*texture);
    return read_uv_mapping(entry, MaterialSlot::normal);
  }

  /// The tangents that the old coordinates give, where the layout would turn them.
  Result<void> keep_tangents(const LayoutRequest& request, const UvLayout& layout, std::size_t material,
                             Tangents& tangents) {
    const UvMapping mapping = tangent_mapping(material);
    Image square;
    square.width = square.height = 1;
    if (same_frames(old_corners(mapping, square, request), layout.corners)) return {};
    std::map<std::uint32_t, std::vector<std::array<Tangent, 3>>> frames;
    for (const SeparatedTriangle& t : request.triangles) {
      const ModelPart& part = job_.model.parts[t.part];
      const auto [of_part, fresh] = frames.try_emplace(t.part);
      if (fresh && part.tangents.empty()) {
        const auto uvs = uvs_through(job_.model, part, mapping);
        APPLIQUE_TRY(const auto own, in_own_space(part, *geometry_));
        if (own && !uvs.empty()) of_part->second = tangent_frames(*own, uvs);
        if (!own) warn_of_anisotropy(t, material);
      }
      if (of_part->second.empty()) continue;
      std::array<Tangent, 3> corners = of_part->second[t.triangle];
      if (part.mirrored) std::swap(corners[1], corners[2]);
      auto& kept = tangents[{t.part, t.triangle}];
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f along = corners[k].direction.cast<float>();
        kept[k] = {along.x(), along.y(), along.z(), static_cast<float>(corners[k].sign)};
      }
    }
    return {};
  }

  void warn_of_anisotropy(const SeparatedTriangle& t, std::size_t material) {
    SolvedDecal& decal = job_.decals[t.decal];
    decal.warnings.push_back(
        {"anisotropy_turns",
         fmt::format(
             "decal '{}': the anisotropy of '{}' turns under it with the texture coordinates, because "
             "the mesh has neither normals nor tangents; export it with normals",
             decal.job.name, document_.json["materials"][material].value("name", std::string()))});
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

  [[nodiscard]] OldCorners old_corners(const UvMapping& mapping, const Image& image,
                                       const LayoutRequest& request) const {
    OldCorners list;
    for (const auto& texels : texels_through(job_, request.triangles, mapping, {image.width, image.height})) {
      // Where there are no coordinates, all are 0.
      const auto [u, v] = mapping.apply({0, 0});
      const Texel origin = {u * image.width, v * image.height};
      list.push_back(texels.value_or(std::array{origin, origin, origin}));
    }
    return list;
  }

  Result<void> resample(const BakedSlots& slot, const Image& image, const TextureGroup& group,
                        const LayoutRequest& request, const UvLayout& layout, std::size_t material,
                        std::size_t set, OldCorners corners, std::vector<std::array<FrameTurn, 3>> turns) {
    const UvMapping base = group.material
                               ? read_uv_mapping(job_.model.document.json["materials"][*group.material])
                               : UvMapping();
    Resampling resampling =
        plan_resampling(document_, slot, image, std::move(corners), layout, request.texture, base);
    resampling.turns = std::move(turns);
    resampling.bits = working_bits(encoding_, image.bits);
    const Image resampled = resample_texture(resampling);
    // What a decal is baked into is stored as it is to be after that.
    APPLIQUE_TRY(const EncodedTexture encoded,
                 encode_texture(resampled, slot.baked ? TextureEncoding() : encoding_));
    if (!encoded.why_png.empty())
      done_.warnings.push_back(png_warning(
          fmt::format("the {} of {}", slot.name, quoted_name(job_.model, group.material)), encoded));
    for (const SlotPointer& pointer : slot.slots) show_whole(material, pointer, set);
    set_slot_images(document_, material, slot.slots, encoded.bytes, slot.name);
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
    std::set<std::uint32_t> every_node;
    for (std::size_t i = 0; i < request.triangles.size(); ++i) {
      const SeparatedTriangle& t = request.triangles[i];
      const std::uint32_t p = standing_for(t);
      if (is_on_every_node(t)) every_node.insert(p);
      MovedTriangles& moved = parts[p];
      moved.triangles.push_back(t.triangle);
      std::array<std::array<float, 2>, 3> uvs = {};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto uv = layout.uv(layout.corners[i][k]);
        uvs[k] = {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
      }
      moved.uvs.push_back(uvs);
      if (const auto turned = tangents.find({t.part, t.triangle}); turned != tangents.end())
        moved.tangents.push_back(turned->second);
      if (job_.model.parts[t.part].mirrored == job_.model.parts[p].mirrored) continue;
      std::swap(moved.uvs.back()[1], moved.uvs.back()[2]);
      if (!moved.tangents.empty()) std::swap(moved.tangents.back()[1], moved.tangents.back()[2]);
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
      moves_[p] = {std::move(moved.triangles), primitive, every_node.contains(p)};
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

  /// What became of a part; null if nothing did.
  [[nodiscard]] const PartMove* move_of(const std::vector<ModelPart>& parts, std::uint32_t p) const {
    if (const auto own = moves_.find(p); own != moves_.end()) return &own->second;
    for (const auto& [other, move] : moves_)
      if (move.every_node && parts[other].mesh == parts[p].mesh &&
          parts[other].primitive == parts[p].primitive)
        return &move;
    return nullptr;
  }

  /// Leads the sources of the decals' surfaces to the new parts.
  void follow(const std::vector<ModelPart>& old_parts,
              const std::map<std::pair<std::size_t, std::size_t>, std::uint32_t>& index) {
    std::vector<std::vector<ModelSurface::Source>> places(old_parts.size());
    for (std::uint32_t p = 0; p < old_parts.size(); ++p) {
      const ModelPart& part = old_parts[p];
      const PartMove* move = move_of(old_parts, p);
      std::vector<std::uint32_t> rank(part.triangles.size(), ~0U);
      if (move != nullptr)
        for (std::uint32_t i = 0; i < move->triangles.size(); ++i) rank[move->triangles[i]] = i;
      std::uint32_t kept = 0;
      for (const std::uint32_t moved : rank) {
        const std::size_t primitive = moved == ~0U ? part.primitive : move->primitive;
        places[p].push_back({index.at({part.node, primitive}), moved == ~0U ? kept++ : moved});
      }
    }
    std::map<const ModelSurface*, std::shared_ptr<const ModelSurface>> surfaces;
    const auto follow = [&](std::shared_ptr<const ModelSurface>& surface) {
      auto& followed = surfaces[surface.get()];
      if (!followed) {
        auto copy = std::make_shared<ModelSurface>(*surface);
        for (auto& source : copy->sources) source = places[source.part][source.triangle];
        followed = std::move(copy);
      }
      surface = followed;
    };
    for (SolvedDecal& decal : job_.decals) {
      follow(decal.surface);
      if (decal.whole_surface != nullptr) follow(decal.whole_surface);
    }
  }

  SolvedJob& job_;
  const TextureEncoding& encoding_;
  Document document_;
  SeparatedUvs done_;
  std::optional<tinygltf::Model> geometry_;
  std::map<std::uint32_t, PartMove> moves_;  ///< By old part.
  std::vector<std::size_t> old_accessors_;   ///< Of the primitives that changed.
  std::set<std::size_t> old_views_;          ///< Their Draco data.
};

}  // namespace

Result<SeparatedUvs> separate_uvs(SolvedJob& job, const TextureEncoding& encoding) {
  APPLIQUE_TRY(const auto groups, find_uv_conflicts(job));
  std::vector<std::vector<UvConflictReport>> conflicts(job.decals.size());
  for (const auto& [group, findings] : groups)
    for (const UvFinding& finding : findings) {
      if (finding.outcome == UvConflict::error) return tl::unexpected<Error>(error_of(job, group, finding));
      conflicts[finding.decal].push_back(report_of(job, group, finding));
      // What is shared the transfer counts; that detail is lost shows nowhere else.
      if (finding.outcome == UvConflict::share && finding.trouble == UvTrouble::coarse)
        job.decals[finding.decal].warnings.push_back(
            {"uv_conflict", conflicts[finding.decal].back().message});
    }
  SeparatedUvs separated;
  std::optional<Separation> separation;
  for (const auto& [group, findings] : groups) {
    auto triangles = triangles_to_separate(job, findings);
    if (triangles.empty()) continue;
    if (!separation) separation.emplace(job, encoding);
    APPLIQUE_CHECK(separation->separate(group, std::move(triangles)));
  }
  if (separation) {
    APPLIQUE_TRY(separated, separation->finish());
  }
  separated.conflicts = std::move(conflicts);
  return separated;
}

}  // namespace applique
