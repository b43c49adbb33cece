#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "applique/decal.h"

#include "compare/layouts.h"
#include "compare/sites.h"

namespace applique::compare {

/// The region with one pin: the middle of the image at the anchor, in the site's size and direction.
DecalInput one_pin(const Site& site, const Layout& layout, const std::string& name);

/// The layout's first `count` pins at the surface points where `map` has their image points: where someone
/// would put them who wants the picture undistorted. Errors: not_solved, naming a pin that the map does not
/// cover.
Result<std::vector<Feature>> pins_of_map(const DecalMap& map, const Layout& layout, int count);

/// Where the map has a surface point, plane units; where it has it several times, the place nearest to
/// `target`. None where it does not cover the point.
std::optional<Vec2> image_of(const DecalMap& map, const SurfacePoint& point, Vec2 target);

}  // namespace applique::compare
