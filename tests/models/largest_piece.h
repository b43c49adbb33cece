#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "applique/base/types.h"

#include "model.h"

namespace applique {

/// A place for a decal that nobody had to look for: in the middle of the largest smooth piece of a model's
/// largest part.
struct DecalPlace {
  Vec3 position = Vec3::Zero();  ///< On the surface, scene space.
  Vec3 up = Vec3::UnitY();       ///< Not along the normal.
  double size = 0;               ///< Scene units; an image of this width fits on the piece.
  std::size_t triangles = 0;     ///< Of the piece.
};

/// Triangles of one part belong to one piece where they share an edge and are inclined to one another by less
/// than 40 degrees. The middle is the triangle that is farthest from the piece's border; of a piece without
/// border, any.
DecalPlace find_place(const Model& model);

/// A job of one decal at the place, square image `image` of `pixels` a side; further members of the decal in
/// `decal`.
nlohmann::json job_at(const DecalPlace& place, const std::filesystem::path& model,
                      const std::filesystem::path& image, int pixels, const nlohmann::json& decal = {});

}  // namespace applique
