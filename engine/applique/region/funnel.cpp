#include "applique/region/funnel.h"

#include "applique/base/predicates.h"

namespace applique {

std::vector<FunnelTurn> pull_tight(Vec2 a, Vec2 b, const std::vector<Portal>& portals) {
  std::vector<FunnelTurn> turns;
  Vec2 apex = a, left = a, right = a;
  std::size_t left_at = 0, right_at = 0;
  for (std::size_t i = 0; i <= portals.size(); ++i) {
    const auto turn = [&](const FunnelTurn& corner) {
      turns.push_back(corner);
      apex = left = right = corner.at;
      left_at = right_at = i = corner.portal;  // Go on after the portal where the corner was found.
    };
    const Portal portal = i < portals.size() ? portals[i] : Portal{b, b};
    if (right == apex || orientation(apex, right, portal.right) >= 0) {
      if (right == apex || left == apex || orientation(apex, left, portal.right) < 0) {
        right = portal.right;
        right_at = i;
      } else {
        turn({left, left_at, true});
        continue;
      }
    }
    if (left == apex || orientation(apex, left, portal.left) <= 0) {
      if (left == apex || right == apex || orientation(apex, right, portal.left) > 0) {
        left = portal.left;
        left_at = i;
      } else {
        turn({right, right_at, false});
      }
    }
  }
  return turns;
}

}  // namespace applique
