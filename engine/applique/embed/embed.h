#pragma once

#include <span>
#include <vector>

#include "applique/embed/disc_geometry.h"
#include "applique/embed/placed_point.h"

namespace applique {

/// What an embedding keeps: 0 angles only, 1 lengths as well, between them a blend (relax_stretch).
struct Energy {
  double isometry = 1;

  static const Energy isometric, conformal;
  bool operator==(const Energy&) const = default;
};
inline constexpr Energy Energy::isometric{1};
inline constexpr Energy Energy::conformal{0};

/// Which step of the ladder the embedding came from.
enum class EmbeddingRung {
  conformal,  ///< Boundary-first flattening as asked for.
  isometric,  ///< Down the energy as asked for, which no fold can pass.
  circle,     ///< The conformal map folded; the flip-free map on a circle took its place.
  arap,       ///< Rounding folded even that one: as rigid as possible all the same.
};

struct Embedding {
  std::vector<Vec2> plane;  ///< Per vertex; the disc's own scale, any position and rotation.
  EmbeddingRung rung = EmbeddingRung::conformal;
  std::size_t flips = 0;  ///< Triangles turned over all the same (§4.3 of the design).
};

struct EmbedOptions {
  Energy energy = Energy::isometric;
  bool rough = false;  ///< The disc is going to change: stops earlier.
  /// Draws points to targets where `start` says what frame these are in; else, and conformally, without
  /// effect.
  std::span<const PlacedPoint> guide{};
  std::span<const double> weights{};  ///< By face, how much an isometric map is to care for it; empty: 1.
};

/// Embeds the disc in the plane with a free boundary (§5.1 of the paper; §4.2 and §4.3 of the design):
/// conformal, and from there down to the isometric map; turned-over triangles are looked for after each
/// solve. The paper stops at the conformal map. The design goes on by ARAP, which folds on strongly curved
/// discs; the descent does not.
///
/// `start`, when given, is an embedding of the disc's own scale that the isometric descent may begin at; one
/// that turns triangles over is not used.
Embedding embed_disc(const DiscGeometry& disc, const EmbedOptions& options = {},
                     const std::vector<Vec2>& start = {});

}  // namespace applique
