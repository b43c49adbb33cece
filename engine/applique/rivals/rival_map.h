#pragma once

#include <unordered_map>
#include <vector>

#include "applique/decal.h"
#include "applique/embed/align.h"
#include "applique/surface/tangent_frame.h"

namespace applique {

/// What a rival is given: a decal and where its map is anchored.
struct RivalTask {
  const DecalInput& input;
  std::vector<Vec2> targets;  ///< The features in the image, plane units.
  std::size_t anchor = 0;     ///< The feature that is met.
  TangentFrame frame;         ///< At the anchor; with a lone feature y runs along the image's y axis.
};

/// A rival's map of the part of the surface that it reaches: linear in each face, a place in the image for
/// each vertex.
struct RivalMap {
  std::unordered_map<VertexId, Vec2> image;  ///< Plane units, by vertex reached.
  std::vector<FaceId> faces;   ///< Those with all vertices reached, each once: what the map has cost.
  std::vector<Vec2> features;  ///< Where the map has the features, plane units.
  std::vector<std::vector<Vec3>> lines;  ///< What was drawn on the surface to make it, scene units.
};

/// The task of a decal whose input has been checked. The anchor is the feature nearest to the centroid of the
/// region. Error: size_missing, where a lone feature's "up" runs along the normal.
Result<RivalTask> make_task(const SurfaceMesh& surface, const DecalInput& input);

/// The similarity that brings a map's own coordinates, scene units, to the image: exact at the anchor; of the
/// wanted size with a lone feature, else nearest to the other features in the sum of squares. `features`: in
/// the map's coordinates. Errors: features_mirrored; not_solved where the map has all features in one place.
Result<Similarity> place_in_image(const SurfaceMesh& surface, const RivalTask& task,
                                  const std::vector<Vec2>& features);

/// The region's bounding box, which says how far a map must go: unlike the region it is convex, so that ways
/// from the anchor to its parts stay in it.
class RegionBox {
 public:
  explicit RegionBox(const Region& region);
  /// Whether the triangle's, or segment's, own box meets this one.
  [[nodiscard]] bool meets(std::initializer_list<Vec2> corners) const;

 private:
  Vec2 low_, high_;
};

}  // namespace applique
