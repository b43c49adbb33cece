#include "explain/colour_ramp.h"

#include <algorithm>
#include <cmath>

#include "applique/image/decal_image.h"

namespace applique {

// The matrices are those of B. Ottosson, "A perceptual color space for image processing", 2020.
draw::Rgba to_srgb(const OkLab& colour) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(colour.lightness + 0.3963377774 * colour.a + 0.2158037573 * colour.b);
  const double m = cube(colour.lightness - 0.1055613458 * colour.a - 0.0638541728 * colour.b);
  const double s = cube(colour.lightness - 0.0894841775 * colour.a - 1.2914855480 * colour.b);
  const auto encoded = [](double linear) { return linear_to_srgb(std::clamp(linear, 0.0, 1.0)); };
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

draw::Rgba ramp_colour(std::span<const OkLab> ramp, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(ramp.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), ramp.size() - 2);
  const OkLab &from = ramp[first], &to = ramp[first + 1];
  const double share = at - static_cast<double>(first);
  return to_srgb({std::lerp(from.lightness, to.lightness, share), std::lerp(from.a, to.a, share),
                  std::lerp(from.b, to.b, share)});
}

}  // namespace applique
