#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "applique/image/decal_image.h"

#include "material.h"
#include "solve_job.h"

namespace applique {

/// What a slot's texture holds.
Encoding encoding_of(MaterialSlot slot);

/// The images of a decal's layers, each made when it is first asked for.
class DecalLayers {
 public:
  explicit DecalLayers(const SolvedDecal& decal) : decal_(&decal), images_(decal.job.layers.size()) {}

  /// A layer's image in the decal's frame, cut by the region: the layer's own alpha counts, times that of the
  /// decal's image or of the mask in its place. Images of another size are scaled to that of the decal's.
  /// Errors: those of values.
  Result<const DecalImage*> image(std::size_t layer);

  /// What a layer has for each pixel of the decal's image, straight; the alpha is the layer's own, which the
  /// decal's image in the place of a layer has not. Vectors of a normal map that no surface has are flat.
  /// Errors: those of read_image, naming the layer; image_invalid for a normal map of such vectors only.
  Result<Image> values(std::size_t layer);

  /// How much of the decal shows at each pixel before the region cuts it: the alpha of its image or the mask
  /// in its place. Errors: those of read_image, naming the mask.
  Result<std::span<const std::uint16_t>> alpha();

  /// What there is to say of the layers that were asked for: normal_map_faulty, and invisible where nothing
  /// of the decal, or of such a layer, is seen on any surface. Errors: those of alpha.
  Result<std::vector<Warning>> warnings();

 private:
  Result<void> load_alpha();
  [[nodiscard]] Result<Image> read_scaled(const std::filesystem::path& path, Floats floats,
                                          const std::string& label) const;
  Result<Image> source_of(const DecalLayer& layer) const;
  Result<void> mend_normals(const DecalLayer& layer, Image& image);
  Result<bool> shows_in_region();
  Result<std::string> why_invisible();
  [[nodiscard]] std::string why_invisible(std::size_t layer) const;

  const SolvedDecal* decal_;
  std::vector<std::optional<DecalImage>> images_;
  std::vector<std::uint16_t> alpha_;   // Of all layers, by pixel.
  std::set<std::size_t> transparent_;  // Layers whose own alpha is 0 all over.
  std::vector<Warning> faulty_normals_;
};

/// Reads all that a decal's layers need, as a bake does, and adds to the decal's warnings what DecalLayers
/// has to say of them. Errors: those of DecalLayers.
Result<void> check_layers(SolvedDecal& decal);

}  // namespace applique
