#include "applique/embed/embed.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "applique/embed/align.h"
#include "applique/embed/arap.h"
#include "applique/embed/boundary_first.h"
#include "applique/embed/least_stretch.h"
#include "applique/embed/mean_value.h"

#include "support/shapes.h"

namespace applique {
namespace {

/// A disc over all faces within a geodesic-like reach of face `first` (all that glue reaches on an open
/// mesh).
struct Disc {
  SurfaceMesh mesh;
  BridgedSurface surface;
  ImmersedDisc disc;

  explicit Disc(
      const shapes::Soup& soup, FaceId first = FaceId(0),
      const std::function<bool(const Vec3&)>& keep = [](const Vec3&) { return true; })
      : mesh(soup.weld()), surface(mesh), disc(surface, first) {
    for (std::size_t i = 0; i < disc.faces().size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const PatchFace& face = disc.faces()[PatchFaceId(i)];
        const FaceId beyond = surface.neighbour(face.mesh_face, k);
        if (face.neighbours[k].valid() || !beyond.valid()) continue;
        const auto c = mesh.corners(beyond);
        if (keep((c[0] + c[1] + c[2]) / 3)) disc.glue(PatchFaceId(i), k, 1);
      }
    disc.compact();
  }
};

/// The largest relative error of an edge's length in the plane.
double length_error(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  double worst = 0;
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const double length = std::abs(plane[disc.faces[t][(k + 1) % 3]] - plane[disc.faces[t][(k + 2) % 3]]);
      worst = std::max(worst, std::abs(length / disc.lengths[t][k] - 1));
    }
  return worst;
}

double mean_length_error(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  double sum = 0;
  for (std::size_t t = 0; t < disc.faces.size(); ++t)
    for (int k = 0; k < 3; ++k)
      sum += std::abs(std::abs(plane[disc.faces[t][(k + 1) % 3]] - plane[disc.faces[t][(k + 2) % 3]]) /
                          disc.lengths[t][k] -
                      1);
  return sum / static_cast<double>(3 * disc.faces.size());
}

/// L2 stretch (Sander et al. 2001) at the best scale: 1 for an isometry.
double l2_stretch(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  double sum = 0, plane_area = 0;
  for (std::size_t t = 0; t < disc.faces.size(); ++t) {
    const auto corner = disc.flat(t);
    const auto& f = disc.faces[t];
    const double area = 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double mapped = 0.5 * cross(plane[f[1]] - plane[f[0]], plane[f[2]] - plane[f[0]]);
    double squares = 0;  // of both singular values, times the area
    for (int k = 0; k < 3; ++k)
      squares += 0.5 * disc.cotangents[t][k] * std::norm(plane[f[(k + 1) % 3]] - plane[f[(k + 2) % 3]]);
    sum += 0.5 * squares * area * area / (mapped * mapped);
    plane_area += mapped;
  }
  return std::sqrt(sum * plane_area) / disc.area;
}

TEST(BoundaryFirst, IsAnIsometryOnThePlane) {
  const Disc d(shapes::plane(12, 9, 2, 1, 0.3));
  const DiscGeometry geometry = measure_disc(d.disc);
  EXPECT_LT(length_error(geometry, flatten_boundary_first(geometry)), 1e-11);
}

TEST(BoundaryFirst, UnrollsACylinder) {
  const Disc d(shapes::cylinder(40, 12, 1, 2), FaceId(0),
               [](const Vec3& p) { return std::abs(std::atan2(p.y(), p.x())) < 2.5; });
  const DiscGeometry geometry = measure_disc(d.disc);
  EXPECT_EQ(count_flips(geometry, flatten_boundary_first(geometry)), 0u);
  EXPECT_LT(length_error(geometry, flatten_boundary_first(geometry)), 1e-10);
}

/// A spherical cap has a known flattening with unit boundary scale: the stereographic projection.
TEST(BoundaryFirst, ConvergesToTheStereographicProjectionOfACap) {
  double previous = 1;
  for (int levels = 3; levels <= 5; ++levels) {
    const shapes::Soup soup = shapes::sphere(levels, 1);
    const SurfaceMesh mesh = soup.weld();
    const Vec3 pole = mesh.positions[VertexId(0)];
    const Disc d(soup, mesh.vertex_face[VertexId(0)],
                 [&](const Vec3& p) { return p.normalized().dot(pole) > 0.5; });
    const DiscGeometry geometry = measure_disc(d.disc);
    const std::vector<Vec2> plane = flatten_boundary_first(geometry);
    const Vec3 x = pole.unitOrthogonal(), y = pole.cross(x);
    std::vector<Vec2> exact(plane.size());
    for (PatchVertexId v : ids<PatchVertexId>(plane.size())) {
      const Vec3 p = d.disc.position(v);
      exact[v.value] = Vec2(p.dot(x), p.dot(y)) / (1 + p.dot(pole));
    }
    const Similarity fit = fit_similarity(plane, exact);
    double error = 0;
    for (std::size_t v = 0; v < plane.size(); ++v) error += std::norm(fit(plane[v]) - exact[v]);
    error = std::sqrt(error / static_cast<double>(plane.size()));
    EXPECT_LT(error, 0.6 * previous) << "levels " << levels;
    previous = error;
  }
  EXPECT_LT(previous, 5e-3);
}

TEST(Tutte, TurnsNothingOver) {
  for (const double height : {0.0, 1.0, 5.0}) {
    const Disc d(shapes::bump(24, height, 0.3));
    const DiscGeometry geometry = measure_disc(d.disc);
    EXPECT_EQ(count_flips(geometry, embed_on_circle(geometry)), 0u) << height;
  }
}

/// The circle is far from the rectangle that the disc is, and close to folding at the corners.
TEST(LeastStretch, FindsTheIsometryOfAPlane) {
  const Disc d(shapes::plane(12, 9, 2, 1, 0.3));
  const DiscGeometry geometry = measure_disc(d.disc);
  const std::vector<Vec2> plane = relax_stretch(geometry, embed_on_circle(geometry), {1, 1000, 1e-13});
  EXPECT_EQ(count_flips(geometry, plane), 0u);
  EXPECT_LT(length_error(geometry, plane), 1e-4);
}

TEST(LeastStretch, LeavesAFoldedStartAsItIs) {
  const Disc d(shapes::plane(4, 4, 1, 1, 0));
  const DiscGeometry geometry = measure_disc(d.disc);
  std::vector<Vec2> folded = flatten_boundary_first(geometry);
  for (Vec2& z : folded) z = std::conj(z);
  EXPECT_EQ(relax_stretch(geometry, folded), folded);
}

TEST(LeastStretch, KeepsWhatCountsMoreNearerToItsShape) {
  const Disc bump(shapes::bump(24, 0.8, 0.3));
  const DiscGeometry geometry = measure_disc(bump.disc);
  // The left half counts ten times as much.
  std::vector<double> weights;
  for (const auto& face : geometry.faces) {
    double x = 0;
    for (const int v : face) x += bump.disc.position(PatchVertexId(static_cast<std::uint32_t>(v))).x();
    weights.push_back(x < 0 ? 1 : 0.1);
  }
  const auto error_on_the_left = [&](const std::vector<Vec2>& plane) {
    double sum = 0;
    for (std::size_t t = 0; t < geometry.faces.size(); ++t) {
      if (weights[t] < 1) continue;
      for (int k = 0; k < 3; ++k)
        sum +=
            std::abs(std::abs(plane[geometry.faces[t][(k + 1) % 3]] - plane[geometry.faces[t][(k + 2) % 3]]) /
                         geometry.lengths[t][k] -
                     1);
    }
    return sum;
  };
  const std::vector<Vec2> start = embed_on_circle(geometry);
  StretchOptions options;
  const auto evenly = relax_stretch(geometry, start, options);
  options.weights = weights;
  const auto weighted = relax_stretch(geometry, start, options);
  EXPECT_EQ(count_flips(geometry, weighted), 0U);
  EXPECT_LT(error_on_the_left(weighted), 0.8 * error_on_the_left(evenly));
}

TEST(Embed, EndsAtTheSameMapFromWhereverItStarts) {
  const Disc d(shapes::bump(32, 1.2, 0.3));
  const DiscGeometry geometry = measure_disc(d.disc);
  const std::vector<Vec2> conformal = embed_disc(geometry).plane;
  const std::vector<Vec2> circle = embed_disc(geometry, {}, embed_on_circle(geometry)).plane;
  EXPECT_NEAR(mean_length_error(geometry, circle), mean_length_error(geometry, conformal), 1e-3);
}

TEST(Embed, IsometricHasLessStretchThanConformalAndNoFlips) {
  const Disc d(shapes::bump(32, 1.2, 0.3));
  const DiscGeometry geometry = measure_disc(d.disc);
  const Embedding conformal = embed_disc(geometry, {Energy::conformal});
  const Embedding isometric = embed_disc(geometry, {Energy::isometric});
  EXPECT_EQ(conformal.flips, 0u);
  EXPECT_EQ(isometric.flips, 0u);
  EXPECT_LT(mean_length_error(geometry, isometric.plane), mean_length_error(geometry, conformal.plane));
  EXPECT_LT(l2_stretch(geometry, isometric.plane) - 1, 0.1 * (l2_stretch(geometry, conformal.plane) - 1));
  EXPECT_LT(l2_stretch(geometry, isometric.plane),
            l2_stretch(geometry, relax_arap(geometry, conformal.plane)));
}

/// Mean over the disc of s1 / s2, and of the larger of s1 s2 and its inverse.
struct Distortion {
  double angle = 0, area = 0;
};

Distortion distortion(const DiscGeometry& disc, const std::vector<Vec2>& plane) {
  double mapped = 0;
  for (const auto& f : disc.faces)
    mapped += 0.5 * cross(plane[f[1]] - plane[f[0]], plane[f[2]] - plane[f[0]]);
  Distortion sum;
  for (std::size_t t = 0; t < disc.faces.size(); ++t) {
    const auto corner = disc.flat(t);
    const auto& f = disc.faces[t];
    const double area = 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double ratio =
        0.5 * cross(plane[f[1]] - plane[f[0]], plane[f[2]] - plane[f[0]]) / mapped * disc.area / area;
    Vec2 a = 0, b = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec2 hat = Vec2(0, 0.25) * (corner[(k + 2) % 3] - corner[(k + 1) % 3]) / area;
      a += plane[f[k]] * std::conj(hat);
      b += plane[f[k]] * hat;
    }
    sum.angle += area / disc.area * (std::abs(a) + std::abs(b)) / (std::abs(a) - std::abs(b));
    sum.area += area / disc.area * std::max(ratio, 1 / ratio);
  }
  return sum;
}

TEST(Embed, ANumberLiesBetweenTheEnergies) {
  const Disc d(shapes::bump(32, 1.2, 0.3));
  const DiscGeometry geometry = measure_disc(d.disc);
  Distortion before = distortion(geometry, embed_disc(geometry, {Energy::conformal}).plane);
  for (const double isometry : {0.02, 0.1, 0.5, 1.0}) {
    const Embedding embedding = embed_disc(geometry, {Energy{isometry}});
    EXPECT_EQ(embedding.flips, 0u);
    const Distortion now = distortion(geometry, embedding.plane);
    EXPECT_GT(now.angle, before.angle) << isometry;
    EXPECT_LT(now.area, before.area) << isometry;
    before = now;
  }
}

/// A cap far beyond a hemisphere, where ARAP folds: the result must still turn nothing over.
TEST(Embed, TurnsNothingOverWhereArapFolds) {
  const shapes::Soup soup = shapes::sphere(5, 1);
  const SurfaceMesh mesh = soup.weld();
  const Vec3 pole = mesh.positions[VertexId(0)];
  const Disc d(soup, mesh.vertex_face[VertexId(0)],
               [&](const Vec3& p) { return std::acos(p.normalized().dot(pole)) < 3.0; });
  const DiscGeometry geometry = measure_disc(d.disc);
  const std::vector<Vec2> folded = relax_arap(geometry, flatten_boundary_first(geometry));
  ASSERT_GT(count_flips(geometry, folded), 0u) << "the case no longer folds: choose a harder one";
  const Embedding embedding = embed_disc(geometry);
  EXPECT_EQ(embedding.flips, 0u);
  EXPECT_EQ(embedding.rung, EmbeddingRung::isometric);
  EXPECT_EQ(count_flips(geometry, embedding.plane), 0u);
}

/// A spike on which the conformal map itself folds: the ladder starts from the circle.
TEST(Embed, FallsBackWhereTheConformalMapFolds) {
  const Disc d(shapes::bump(40, 4, 0.2));
  const DiscGeometry geometry = measure_disc(d.disc);
  ASSERT_GT(count_flips(geometry, flatten_boundary_first(geometry)), 0u) << "choose a harder case";
  EXPECT_EQ(embed_disc(geometry).flips, 0u);
  const Embedding conformal = embed_disc(geometry, {Energy::conformal});
  EXPECT_EQ(conformal.flips, 0u);
  EXPECT_EQ(conformal.rung, EmbeddingRung::circle);
}

TEST(Align, RecoversARandomSimilarity) {
  const std::vector<Vec2> from = {{0, 0}, {1, 0.2}, {-0.3, 0.8}, {0.5, -0.9}};
  const Similarity truth{std::polar(1.7, 2.1), Vec2(-0.4, 3)};
  std::vector<Vec2> to;
  for (Vec2 z : from) to.push_back(truth(z));
  const Similarity fit = fit_similarity(from, to);
  EXPECT_LT(std::abs(fit.scale - truth.scale), 1e-14);
  EXPECT_LT(std::abs(fit.shift - truth.shift), 1e-14);
  EXPECT_FALSE(is_mirrored(from, to));
  for (Vec2& z : to) z = std::conj(z);
  EXPECT_TRUE(is_mirrored(from, to));
}

}  // namespace
}  // namespace applique
