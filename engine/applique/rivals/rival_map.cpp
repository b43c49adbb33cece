#include "applique/rivals/rival_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "applique/decal_input.h"

namespace applique {
namespace {

Vec2 centroid(const std::vector<Vec2>& polygon) {
  Vec2 moment = 0;
  double twice_area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    moment += cross(a, b) * (a + b);
    twice_area += cross(a, b);
  }
  return moment / (3 * twice_area);
}

}  // namespace

Result<RivalTask> make_task(const SurfaceMesh& surface, const DecalInput& input) {
  RivalTask task{input, targets_of(input), 0, {}};
  const Vec2 middle = centroid(input.region.polygon());
  const auto nearest = std::min_element(task.targets.begin(), task.targets.end(), [&](Vec2 a, Vec2 b) {
    return std::abs(a - middle) < std::abs(b - middle);
  });
  task.anchor = static_cast<std::size_t>(nearest - task.targets.begin());
  task.frame = tangent_frame(surface, input.features[task.anchor].surface);
  if (input.features.size() == 1) {
    APPLIQUE_TRY(task.frame.y, lone_up(input, task.frame.normal));
    task.frame.x = task.frame.y.cross(task.frame.normal);
  }
  return task;
}

Result<Similarity> place_in_image(const SurfaceMesh& surface, const RivalTask& task,
                                  const std::vector<Vec2>& features) {
  const Vec2 anchor = features[task.anchor], target = task.targets[task.anchor];
  if (features.size() == 1) {
    const double scale = lone_scale(task.input);
    return Similarity{scale, target - scale * anchor};
  }
  if (is_mirrored(features, task.targets)) return fail_mirrored(surface, task.input);
  const Similarity fit = fit_similarity_about(task.anchor, features, task.targets);
  if (!(std::abs(fit.scale) > 0) || !std::isfinite(std::abs(fit.scale)))
    return fail(ErrorCode::not_solved,
                fmt::format("decal '{}': the map has the features where no size of the image brings them "
                            "near to their places; leave out \"method\", or pin one feature only",
                            task.input.name));
  return fit;
}

RegionBox::RegionBox(const Region& region) : low_(region.polygon()[0]), high_(low_) {
  for (const Vec2 z : region.polygon()) {
    low_ = {std::min(low_.real(), z.real()), std::min(low_.imag(), z.imag())};
    high_ = {std::max(high_.real(), z.real()), std::max(high_.imag(), z.imag())};
  }
}

bool RegionBox::meets(std::initializer_list<Vec2> corners) const {
  const auto some = [&](auto holds) { return std::any_of(corners.begin(), corners.end(), holds); };
  return some([&](Vec2 z) { return z.real() <= high_.real(); }) &&
         some([&](Vec2 z) { return z.real() >= low_.real(); }) &&
         some([&](Vec2 z) { return z.imag() <= high_.imag(); }) &&
         some([&](Vec2 z) { return z.imag() >= low_.imag(); });
}

}  // namespace applique
