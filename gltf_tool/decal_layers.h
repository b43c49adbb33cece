#pragma once

#include <cstdint>
#include <optional>
#include <span>
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
  /// Errors: those of read_image, naming the decal.
  Result<const DecalImage*> image(std::size_t layer);

  /// What a layer has for each pixel of the decal's image, straight; the alpha is the layer's own, which the
  /// decal's image in the place of a layer has not. Vectors of a normal map that no surface has are flat.
  /// Errors: those of read_image, naming the decal; image_invalid for a normal map of such vectors only.
  Result<Image> values(std::size_t layer);

  /// How much of the decal shows at each pixel before the region cuts it: the alpha of its image or the mask
  /// in its place. Errors: those of read_image, naming the decal.
  Result<std::span<const std::uint16_t>> alpha();

  /// What there was to say of the layers so far: normal_map_faulty.
  [[nodiscard]] const std::vector<Warning>& warnings() const { return warnings_; }

 private:
  Result<void> load_alpha();
  [[nodiscard]] Result<Image> read_scaled(const std::filesystem::path& path, Floats floats) const;
  Result<Image> source_of(const DecalLayer& layer) const;
  Result<void> mend_normals(const DecalLayer& layer, Image& image);

  const SolvedDecal* decal_;
  std::vector<std::optional<DecalImage>> images_;
  std::vector<std::uint16_t> alpha_;  // Of all layers, by pixel.
  std::vector<Warning> warnings_;
};

}  // namespace applique
