#include "support/random_decals.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include <rapidcheck.h>

namespace applique::random_decals {
namespace {

constexpr double size = 512;
constexpr ImageFrame frame{size, size};
constexpr double facing = 0.35;  // cosine to the viewer of a surface that one would pin something to

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<Pixel> star_contour(std::mt19937& random) {
  const int corners = 5 + static_cast<int>(random() % 20);
  std::vector<Pixel> contour;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * (k + uniform(random, -0.3, 0.3)) / corners;
    const double radius = uniform(random, 80, 250);
    contour.push_back({256 + radius * std::cos(angle), 256 + radius * std::sin(angle)});
  }
  return contour;
}

/// A strip along a curve that turns about evenly: a hook, an S, a C.
std::vector<Pixel> strip_contour(std::mt19937& random) {
  const double bend = uniform(random, -4, 4), swing = uniform(random, -2, 2), width = uniform(random, 20, 45);
  constexpr int pieces = 24;
  std::vector<Vec2> line = {0};
  double heading = uniform(random, 0, 2 * std::numbers::pi);
  for (int k = 0; k < pieces; ++k) {
    heading += bend / pieces + swing / pieces * std::cos(2 * std::numbers::pi * k / pieces);
    line.push_back(line.back() + std::polar(700.0 / pieces, heading));
  }
  Vec2 middle = 0;
  for (Vec2 z : line) middle += z / double(line.size());
  std::vector<Pixel> contour;
  for (const double side : {1.0, -1.0})
    for (int k = 0; k <= pieces; ++k) {
      const int i = side > 0 ? k : pieces - k;
      const Vec2 along = line[std::min(i + 1, pieces)] - line[std::max(i - 1, 0)];
      const Vec2 z = line[i] - middle + side * width * Vec2(0, 1) * along / std::abs(along);
      contour.push_back({256 + z.real(), 256 + z.imag()});
    }
  return contour;
}

std::vector<Pixel> notched_contour(std::mt19937& random) {
  const int notches = 1 + static_cast<int>(random() % 3);
  std::vector<Pixel> contour = {{30, 480}, {30, 40}};
  for (int k = 0; k < notches; ++k) {
    const double middle = 30 + 452.0 * (k + 1) / (notches + 1), half = uniform(random, 8, 40);
    const double bottom = uniform(random, 150, 420);
    contour.insert(
        contour.end(),
        {{middle - half, 40}, {middle - half, bottom}, {middle + half, bottom}, {middle + half, 40}});
  }
  contour.push_back({482, 40});
  contour.push_back({482, 480});
  return contour;
}

Region random_region(std::mt19937& random) {
  while (true) {
    const auto kind = random() % 3;
    const auto region = Region::from_contour(kind == 0   ? star_contour(random)
                                             : kind == 1 ? strip_contour(random)
                                                         : notched_contour(random),
                                             frame);
    if (region) return *region;  // A strip may cross itself.
  }
}

Vec3 normal_at(const SurfaceMesh& mesh, FaceId face) {
  const auto corners = mesh.corners(face);
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
}

}  // namespace

DecalInput random_decal(const Ground& ground, std::mt19937& random) {
  DecalInput input{"random", random_region(random), {}, {}};
  // Seen from a random side, as a person would pick the places: what a ray meets first and faces the viewer.
  const SurfaceMesh& mesh = *ground.mesh;
  const FaceId face(random() % mesh.faces.size());
  const auto corners = mesh.corners(face);
  const Vec3 normal = normal_at(mesh, face);
  const Vec3 eye = (corners[0] + corners[1] + corners[2]) / 3 + 4 * ground.size * normal;
  const double turn = uniform(random, 0, 2 * std::numbers::pi);
  const Vec3 x = Eigen::AngleAxisd(turn, normal) * normal.unitOrthogonal(), y = normal.cross(x);
  const double width = ground.size * uniform(random, 0.2, 1), pull = 0.04 * width * uniform(random, 0, 1);
  input.lone = LoneFrame{width, y};
  const auto count = 1 + random() % 9;
  const double apart = 0.25 / std::sqrt(static_cast<double>(count));
  std::vector<Vec2> places;
  for (int tries = 0; tries < 1000 && places.size() < count; ++tries) {
    const Pixel pixel{uniform(random, 0, size), uniform(random, 0, size)};
    const Vec2 z = frame.to_plane(pixel);
    if (!input.region.contains(z)) continue;
    if (std::any_of(places.begin(), places.end(), [&](Vec2 other) { return std::abs(other - z) < apart; }))
      continue;
    const Vec2 at = 0.5 * width * z + pull * Vec2(uniform(random, -1, 1), uniform(random, -1, 1));
    const auto place = ground.query->first_hit(eye + at.real() * x + at.imag() * y, -normal);
    if (!place || normal_at(mesh, place->face).dot(normal) < facing) continue;
    places.push_back(z);
    input.features.push_back({pixel, *place, 0});
  }
  return input;
}

std::string outcome(const Result<DecalMap>& map) {
  if (!map) return "error: " + std::string(name_of(map.error().code));
  for (const char* code : {"flipped_triangles", "not_converged"})
    for (const Warning& warning : map->warnings)
      if (warning.code == code) return std::string("warned: ") + code;
  const MapQuality& quality = map->quality;
  const bool exact = std::all_of(quality.feature_residual.begin(), quality.feature_residual.end(),
                                 [](double residual) { return residual < 1e-6; });
  return exact && quality.flipped_image == 0 && quality.flipped_plane == 0 ? "solved" : "";
}

void Tally::print(const std::string& method) const {
  for (const auto& [ground, outcomes] : counts_)
    for (const auto& [outcome, count] : outcomes)
      std::printf("%-9s %-14s %-34s %5d\n", method.c_str(), ground.c_str(), outcome.c_str(), count);
}

double Tally::share_solved() const {
  int all = 0, solved = 0;
  for (const auto& [ground, outcomes] : counts_)
    for (const auto& [outcome, count] : outcomes) {
      all += count;
      solved += outcome == "solved" ? count : 0;
    }
  return all == 0 ? 0 : double(solved) / all;
}

bool check(const Ground& ground, Tally& tally) {
  return rc::check("random decals on a " + ground.name, [&] {
    // Any seed at any stage of the run: RapidCheck scales numbers with its progress.
    std::mt19937 random(
        *rc::gen::noShrink(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint32_t>())));
    const DecalInput input = random_decal(ground, random);
    SolveOptions options;
    options.check_patch = true;
    const std::string ended = outcome(solve_decal(*ground.mesh, input, options));
    tally.add(ground.name, ended);
    RC_ASSERT(!ended.empty());
  });
}

}  // namespace applique::random_decals
