#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "applique/image/image.h"
#include "applique/image/image_frame.h"
#include "applique/warp/warp.h"

#include "material.h"
#include "model.h"
#include "overlay_mesh.h"
#include "solve_job.h"

namespace applique {

/// What an overlay shows in a slot of its material.
struct OverlayPicture {
  MaterialSlot slot = MaterialSlot::base_color;
  Image image;
};

/// How an overlay's pictures show the decal's image: their texel (x, y) shows the place `origin` + (x, y) /
/// `density`, in pixels of the image, or, where it is bent, of the plane that the warp carries to the image.
struct OverlayChart {
  ImageFrame frame;
  Eigen::Vector2d origin = {0, 0};
  double density = 1;  ///< Texels a pixel.
  int width = 0, height = 0;
  const Warp* warp = nullptr;  ///< The decal's; null: the image is not bent.
};

/// An overlay: its triangles, and what lies where in its pictures.
struct OverlayLayout {
  DecalMesh mesh;
  OverlayChart chart;
  bool divided_skin =
      false;  ///< Between the corners of a skin's triangles it follows the surface only nearly.
};

/// Lays a decal out as an overlay, `offset` (scene units, >= 0) above the surface.
///
/// On nodes without a skin the mesh is build_overlay_mesh's and the pictures are as the decal's image. A skin
/// moves what lies between a triangle's corners otherwise than a vertex there would move, so on nodes with
/// one the triangles stay whole: then the pictures are what bends, laid out in the plane of the decal's map,
/// with a margin of nothing around them for what of the triangles sticks out. (Where the image overlaps
/// itself there is no such plane; the triangles are divided all the same.)
///
/// The layout points into the decal.
OverlayLayout lay_out_overlay(const Model& model, const SolvedDecal& decal, double offset);

/// Lays images, in the decal's frame and of its size, out as pictures; a constant of a single texel stays
/// one. Outside the image they are transparent, with the colours of the border, if they have an alpha.
/// Normals are turned with the image where that is bent: by the direction in the picture in which the image's
/// x runs at each texel, as a bake turns them into a texture's frames.
std::vector<OverlayPicture> draw_pictures(const OverlayChart& chart, std::span<const OverlayPicture> images);

}  // namespace applique
