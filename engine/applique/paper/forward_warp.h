#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "applique/base/types.h"
#include "applique/region/feature_graph.h"

namespace applique {

/// Carries points of the image to the plane by the paper's vector field (§5.1.1, eqs. (2) and (3); in complex
/// form, §3.1 of the design): the features move in straight lines from their image points to where they are
/// embedded, and each pair of them that sees one another takes the plane along with a similarity.
///
/// As printed, but for two things: the weights beta alpha are normalised as a product, for normalised each by
/// itself they sum to less than 1 and the features fall short (E5); a pair's alpha is the sum over all groups
/// that hold at least one of its features, as the text says, not both, as the formula says (E6). Even so it
/// folds where a feature of another group passes (E7): warp/warp.h has the rule that does not.
struct ForwardWarp {
  std::vector<Vec2> from;            ///< Features in the image, plane units.
  std::vector<Vec2> to;              ///< Features in the embedding.
  std::vector<FeaturePair> pairs;    ///< Each feature is in one.
  std::uint32_t groups = 1;          ///< §5.1.2.
  std::vector<std::uint32_t> group;  ///< By feature; empty when there is one group.
};

/// Explicit Euler steps of constant size, as the paper takes; it does not say how many. 64 leave 0.25 px of
/// error in an image of 1024 (§3.8 of the design). Features arrive exactly, whatever the number.
constexpr int euler_steps = 64;

/// Where each point ends up. `influence`: alpha_{p,l}, [point * groups + group], not looked at with one
/// group.
std::vector<Vec2> warp_forward(const ForwardWarp& warp, std::span<const Vec2> points,
                               std::span<const double> influence = {}, int steps = euler_steps);

/// The pair whose two features come to one place on their way, where the field is not defined (§5.1.3): its
/// number, or the number of pairs when there is none.
std::size_t colliding_pair(const ForwardWarp& warp);

}  // namespace applique
