#include "unroll.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "texel_map.h"

namespace applique {
namespace {

constexpr double slimmest = 1e6;  // length to width: a slimmer triangle has no area to speak of

/// An edge that two triangles share, or a part of one.
struct Hinge {
  std::array<std::uint32_t, 2> triangles;
  /// By triangle: where the edge's two ends are in it, the same point of the surface first.
  std::array<std::array<std::array<double, 3>, 2>, 2> ends;
  double pixels = 0;  ///< Of it, under the decal.
};

bool has_area(const std::array<Texel, 3>& corners) {
  const auto [longer, shorter] = half_axes(map_between({Texel{0, 0}, Texel{1, 0}, Texel{0, 1}}, corners));
  return shorter * slimmest > longer;
}

/// The edges between the triangles that their decals cross, each pair of triangles once.
std::vector<Hinge> find_hinges(const SolvedJob& job, std::span<const SeparatedTriangle> triangles) {
  std::map<std::pair<std::size_t, PatchFaceId>, std::uint32_t> triangle_of;  // By decal and its face.
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (const PatchFaceId f : triangles[i].faces) triangle_of[{triangles[i].decal, f}] = i;
  struct Shared {
    Hinge hinge;
    double longest = 0;  // of the pieces that the decal has of the edge
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Shared> pairs;
  for (const auto& [key, i] : triangle_of) {
    const auto& [d, f] = key;
    const SolvedDecal& decal = job.decals[d];
    const PatchFace& face = decal.map.patch.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto across = triangle_of.find({d, face.neighbours[k]});
      if (across == triangle_of.end() || across->second <= i) continue;
      const std::uint32_t j = across->second;
      const PatchFace& other = decal.map.patch.faces[face.neighbours[k]];
      const std::array<PatchVertexId, 2> ends = {face.vertices[(k + 1) % 3], face.vertices[(k + 2) % 3]};
      const double pixels = decal.region.frame().pixels_per_unit() *
                            std::abs(decal.map.image[ends[1]] - decal.map.image[ends[0]]);
      Shared& shared = pairs[{i, j}];
      shared.hinge.pixels += pixels;
      if (pixels <= shared.longest) continue;
      shared.longest = pixels;
      shared.hinge.triangles = {i, j};
      for (std::size_t side = 0; side < 2; ++side) {
        const PatchFace& here = side == 0 ? face : other;
        for (std::size_t end = 0; end < 2; ++end) {
          const auto corner = std::find(here.vertices.begin(), here.vertices.end(), ends[end]);
          shared.hinge.ends[side][end] = decal.surface->corners_in_source(
              here.mesh_face)[static_cast<std::size_t>(corner - here.vertices.begin())];
        }
      }
    }
  }
  std::vector<Hinge> hinges;
  for (const auto& [pair, shared] : pairs)
    if (shared.longest > 0) hinges.push_back(shared.hinge);
  return hinges;
}

std::complex<double> point_in(const std::array<Texel, 3>& corners, const std::array<double, 3>& weights) {
  return blend(weights, [&](std::size_t k) { return std::complex(corners[k][0], corners[k][1]); });
}

/// Moves a triangle in the plane until the hinge's ends are where those of the other one are.
void hang(std::array<Texel, 3>& corners, const std::array<std::array<double, 3>, 2>& ends,
          const std::array<Texel, 3>& other, const std::array<std::array<double, 3>, 2>& other_ends) {
  const auto from = point_in(corners, ends[0]), to = point_in(other, other_ends[0]);
  const auto turn = (point_in(other, other_ends[1]) - to) / (point_in(corners, ends[1]) - from);
  const double length = std::abs(turn);
  double size = 0;
  for (Texel& corner : corners) {
    const auto moved = to + turn / length * (std::complex(corner[0], corner[1]) - from);
    corner = {moved.real(), moved.imag()};
    size = std::max(size, std::abs(moved - to));
  }
  // What is one corner is so to the bit, or both might claim a texel on the edge.
  constexpr double tolerance = 1e-9;
  for (Texel& corner : corners)
    for (const Texel& there : other)
      if (std::hypot(corner[0] - there[0], corner[1] - there[1]) < tolerance * size) corner = there;
}

/// Turns triangles in the plane so that their box is small.
void turn_into_box(std::vector<std::array<Texel, 3>>& corners, const std::vector<std::uint32_t>& piece) {
  constexpr int turns = 90;  // of a degree
  const auto turned = [](const Texel& p, int degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Texel{std::cos(angle) * p[0] - std::sin(angle) * p[1],
                 std::sin(angle) * p[0] + std::cos(angle) * p[1]};
  };
  double least = HUGE_VAL;
  int best = 0;
  for (int degrees = 0; degrees < turns; ++degrees) {
    Texel lower = {HUGE_VAL, HUGE_VAL};
    Texel upper = {-HUGE_VAL, -HUGE_VAL};
    for (const std::uint32_t i : piece)
      for (const Texel& corner : corners[i]) {
        const Texel p = turned(corner, degrees);
        for (std::size_t c = 0; c < 2; ++c) {
          lower[c] = std::min(lower[c], p[c]);
          upper[c] = std::max(upper[c], p[c]);
        }
      }
    const double area = (upper[0] - lower[0]) * (upper[1] - lower[1]);
    if (area < least) {
      least = area;
      best = degrees;
    }
  }
  for (const std::uint32_t i : piece)
    for (Texel& corner : corners[i]) corner = turned(corner, best);
}

}  // namespace

std::array<Texel, 3> flatten(const SolvedJob& job, const SeparatedTriangle& t) {
  const ModelPart& part = job.model.parts[t.part];
  const auto& corners = part.triangles[t.triangle];
  const Vec3 side = part.positions[corners[1]] - part.positions[corners[0]];
  const Vec3 other = part.positions[corners[2]] - part.positions[corners[0]];
  const double length = side.norm();
  if (length == 0) return {};
  return {Texel{0, 0}, Texel{length, 0}, Texel{other.dot(side) / length, -side.cross(other).norm() / length}};
}

Unrolled unroll(const SolvedJob& job, std::span<const SeparatedTriangle> triangles) {
  Unrolled unrolled;
  std::vector<char> flat;
  for (const SeparatedTriangle& t : triangles) {
    unrolled.corners.push_back(flatten(job, t));
    flat.push_back(has_area(unrolled.corners.back()) ? 1 : 0);
  }
  unrolled.beside.resize(triangles.size());

  // The tree of the hinges that carry the most: what it leaves out is least of a seam.
  std::vector<Hinge> hinges = find_hinges(job, triangles);
  std::erase_if(hinges, [&](const Hinge& hinge) {
    return flat[hinge.triangles[0]] == 0 || flat[hinge.triangles[1]] == 0;
  });
  std::stable_sort(hinges.begin(), hinges.end(),
                   [](const Hinge& a, const Hinge& b) { return a.pixels > b.pixels; });
  std::vector<std::uint32_t> parents(triangles.size());
  std::iota(parents.begin(), parents.end(), 0U);
  const auto root_of = [&](std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, const Hinge*> tree;
  for (const Hinge& hinge : hinges) {
    const auto [a, b] = hinge.triangles;
    if (root_of(a) == root_of(b)) continue;
    parents[root_of(a)] = root_of(b);
    tree[{a, b}] = tree[{b, a}] = &hinge;
    unrolled.beside[a].push_back(b);
    unrolled.beside[b].push_back(a);
  }

  std::vector<char> placed(triangles.size(), 0);
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (std::exchange(placed[first], 1) != 0) continue;
    if (flat[first] == 0) {
      unrolled.corners[first] = {Texel{0, 0}, Texel{1, 0}, Texel{0, 1}};
      continue;
    }
    std::vector<std::uint32_t> piece = {first};
    double pixels = 0;
    double area = 0;
    for (std::size_t at = 0; at < piece.size(); ++at) {
      const std::uint32_t i = piece[at];
      pixels += pixels_on(job, triangles[i]);
      area += 0.5 * std::abs(doubled_area(unrolled.corners[i]));
      for (const std::uint32_t j : unrolled.beside[i]) {
        if (std::exchange(placed[j], 1) != 0) continue;
        const Hinge& hinge = *tree.at({i, j});
        const std::size_t side = hinge.triangles[0] == j ? 0 : 1;
        hang(unrolled.corners[j], hinge.ends[side], unrolled.corners[i], hinge.ends[1 - side]);
        piece.push_back(j);
      }
    }
    const double scale = std::sqrt(std::max(pixels, 1.0) / area);
    for (const std::uint32_t i : piece)
      for (Texel& corner : unrolled.corners[i])
        for (double& x : corner) x *= scale;
    turn_into_box(unrolled.corners, piece);
  }
  return unrolled;
}

}  // namespace applique
