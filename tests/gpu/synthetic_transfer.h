#pragma once

#include <memory>
#include <random>

#include "applique/transfer/transfer.h"

namespace applique {

/// A transfer with everything that it points at.
struct SyntheticTransfer {
  std::unique_ptr<DecalImage> image;
  std::unique_ptr<Warp> warp;
  Transfer transfer;
};

struct SyntheticOptions {
  int texture = 256;  ///< Side of the texture, texels.
  int image = 300;    ///< Side of the image, pixels.
  int features = 6;
  int grid = 8;  ///< Quads along a sheet's edge.
  int sheets = 1;
  bool stacked = false;  ///< The upper sheets lie over faces of the lowest, all but a strip at its left.
  int groups = 1;  ///< Of features, with influences that vary along a sheet; two features each, or more.
  double nonlinear = 0.5;  ///< Share of the faces that need the warp.
  double centre = 0.5;     ///< Of the faces, in textures.
  double extent = 0.7;     ///< Of the faces, in textures.
};

/// Random features that move by up to a tenth of the plane, with all pairs and linear trajectories (§3.5 of
/// the design) in four steps.
Warp random_warp(std::mt19937& random, int features, int groups = 1);

/// Noise over waves, with a soft round outline.
DecalImage noise_image(std::mt19937& random, int width, int height);

/// Jittered and turned grids over a texture, each after the first a sheet higher, with a seam along the
/// middle of each: its right half lies a few texels apart.
SyntheticTransfer synthetic_transfer(unsigned seed, const SyntheticOptions& options);

/// Random colours.
Image noise_texture(unsigned seed, int width, int height, int bits = 8);

}  // namespace applique
