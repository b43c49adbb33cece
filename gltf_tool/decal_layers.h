#pragma once

#include <optional>

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

 private:
  Result<void> load_alpha();
  [[nodiscard]] Result<Image> read_scaled(const std::filesystem::path& path) const;
  Result<Image> colours(const DecalLayer& layer) const;

  const SolvedDecal* decal_;
  std::vector<std::optional<DecalImage>> images_;
  std::vector<std::uint16_t> alpha_;  // Of all layers, by pixel.
};

}  // namespace applique
