#include "applique/patch/depth.h"

#include <algorithm>
#include <array>
#include <optional>

#include <Eigen/Geometry>

#include "applique/base/laplacian_solver.h"
#include "applique/base/types.h"

namespace applique {
namespace {

/// The share of the segment a -> b at which it passes the triangle, or nothing.
std::optional<double> passage(Vec2 a, Vec2 b, const std::array<Vec2, 3>& triangle) {
  // Clip the segment's parameters by the three sides (Cyrus and Beck).
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    const Vec2 corner = triangle[k], side = triangle[(k + 1) % 3] - corner;
    const double at_a = cross(side, a - corner), at_b = cross(side, b - corner);
    if (at_a < 0 && at_b < 0) return std::nullopt;
    if (at_a < 0) from = std::max(from, at_a / (at_a - at_b));
    if (at_b < 0) to = std::min(to, at_a / (at_a - at_b));
  }
  return from <= to ? std::optional(0.5 * (from + to)) : std::nullopt;
}

/// Depth and order, which spread alike, as one complex number.
using Value = std::complex<double>;

/// What is fixed: per face its value, or none.
using Fixed = IdVector<PatchFaceId, std::optional<Value>>;

Fixed fix_faces(const Patch& patch, const IdVector<PatchVertexId, Vec2>& image,
                std::span<const DepthFeature> features, std::span<const FeaturePair> tree) {
  const auto value = [&](std::uint32_t k) { return Value(features[k].depth, k); };
  IdVector<PatchFaceId, Value> sum(patch.faces.size(), 0);
  IdVector<PatchFaceId, int> count(patch.faces.size(), 0);
  const auto add = [&](PatchFaceId q, Value fixed) {
    sum[q] += fixed;
    ++count[q];
  };
  for (const auto& [i, j] : tree) {
    const Vec2 a = features[i].image, b = features[j].image;
    for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
      const auto& v = patch.faces[q].vertices;
      if (const auto t = passage(a, b, {image[v[0]], image[v[1]], image[v[2]]}))
        add(q, (1 - *t) * value(i) + *t * value(j));
    }
  }
  for (const DepthFeature& feature : features) count[feature.face] = 0;
  for (std::uint32_t k = 0; k < features.size(); ++k) {
    if (count[features[k].face] == 0) sum[features[k].face] = 0;
    add(features[k].face, value(k));
  }
  Fixed fixed(patch.faces.size());
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size()))
    if (count[q] > 0) fixed[q] = sum[q] / static_cast<double>(count[q]);
  return fixed;
}

}  // namespace

FaceDepths spread_depths(const Patch& patch, const IdVector<PatchVertexId, Vec2>& image,
                         std::span<const DepthFeature> features, std::span<const FeaturePair> tree) {
  const Fixed fixed = fix_faces(patch, image, features, tree);
  IdVector<PatchFaceId, int> row(patch.faces.size(), -1);
  int rows = 0;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size()))
    if (!fixed[q]) row[q] = rows++;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(rows);
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    if (row[q] < 0) continue;
    for (const PatchFaceId across : patch.faces[q].neighbours) {
      if (!across.valid()) continue;
      entries.emplace_back(row[q], row[q], 1);
      if (row[across] < 0)
        right[row[q]] += *fixed[across];
      else if (row[across] < row[q])
        entries.emplace_back(row[q], row[across], -1);
    }
  }
  Eigen::VectorXcd solved;
  if (rows > 0) {
    Eigen::SparseMatrix<double> laplacian(rows, rows);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    LaplacianSolver solver;
    const bool regular = solver.compute(laplacian);
    APPLIQUE_ASSERT(regular);  // a patch hangs together, and something in it is fixed
    solved = solver.solve(right);
  }
  // A lone feature leaves all open: the place along the image's longer side orders its ends, one of which
  // then lies over the other as a whole.
  Eigen::AlignedBox2d box;
  for (const Vec2 z : image) box.extend(Eigen::Vector2d(z.real(), z.imag()));
  const bool upright = box.sizes().y() > box.sizes().x();
  const auto order_of_one = [&](PatchFaceId q) {
    Vec2 sum = 0;
    for (PatchVertexId v : patch.faces[q].vertices) sum += image[v];
    return upright ? sum.imag() : sum.real();
  };
  // Equal depths are to be equal to the bit, so that `order` decides.
  const bool level = std::all_of(features.begin(), features.end(),
                                 [&](const DepthFeature& f) { return f.depth == features[0].depth; });
  FaceDepths depths;
  for (PatchFaceId q : ids<PatchFaceId>(patch.faces.size())) {
    const Value value = fixed[q] ? *fixed[q] : solved[row[q]];
    depths.depth.push_back(level ? features[0].depth : value.real());
    depths.order.push_back(features.size() > 1 ? value.imag() : order_of_one(q));
  }
  return depths;
}

}  // namespace applique
