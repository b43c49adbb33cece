#include "applique/embed/symmetric_dirichlet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SparseCholesky>

#include "applique/embed/collapse.h"

namespace applique {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// A triangle at rest: its area and the gradients of its corners' hat functions.
struct RestTriangle {
  double area;
  std::array<Vector2d, 3> gradient;
};

std::vector<RestTriangle> rest_triangles(const DiscGeometry& disc) {
  std::vector<RestTriangle> rest(disc.faces.size());
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const auto corner = disc.flat(t);
    const double twice_area = cross(corner[1] - corner[0], corner[2] - corner[0]);
    rest[t].area = 0.5 * twice_area;
    for (int k = 0; k < 3; ++k) {
      const Vec2 opposite = corner[(k + 2) % 3] - corner[(k + 1) % 3];
      rest[t].gradient[k] = Vector2d(-opposite.imag(), opposite.real()) / twice_area;
    }
  }
  return rest;
}

Matrix2d deformation(const RestTriangle& rest, const std::array<int, 3>& f, const std::vector<Vec2>& plane) {
  Matrix2d F = Matrix2d::Zero();
  for (int k = 0; k < 3; ++k)
    F += Vector2d(plane[f[k]].real(), plane[f[k]].imag()) * rest.gradient[k].transpose();
  return F;
}

double energy(const DiscGeometry& disc, const std::vector<RestTriangle>& rest,
              const std::vector<Vec2>& plane) {
  double sum = 0;
  for (std::size_t t = 0; t < rest.size(); ++t) {
    const Matrix2d F = deformation(rest[t], disc.faces[t], plane);
    const double det = F.determinant();
    if (det <= 0) return std::numeric_limits<double>::infinity();
    const double norm2 = F.squaredNorm();
    sum += rest[t].area * 0.5 * (norm2 + norm2 / (det * det));
  }
  return sum;
}

/// F = U diag(s) V^T in closed form, both rotations; det F > 0.
struct Rotations {
  Matrix2d U, V;
  Vector2d s;
};

Rotations decompose(const Matrix2d& F) {
  const double sum_angle = std::atan2(F(1, 0) - F(0, 1), F(0, 0) + F(1, 1));
  const double difference_angle = std::atan2(F(1, 0) + F(0, 1), F(0, 0) - F(1, 1));
  const double sum = std::hypot(F(0, 0) + F(1, 1), F(1, 0) - F(0, 1));
  const double difference = std::hypot(F(0, 0) - F(1, 1), F(1, 0) + F(0, 1));
  return {Eigen::Rotation2Dd(0.5 * (sum_angle + difference_angle)).toRotationMatrix(),
          Eigen::Rotation2Dd(0.5 * (difference_angle - sum_angle)).toRotationMatrix(),
          Vector2d(0.5 * (sum + difference), 0.5 * (sum - difference))};
}

/// The Newton system of the whole disc: its pattern is built once.
class NewtonSystem {
 public:
  explicit NewtonSystem(const DiscGeometry& disc) : disc_(disc) {
    const auto size = static_cast<Eigen::Index>(2 * disc.vertices);
    std::vector<Eigen::Triplet<double>> pattern;
    pattern.reserve(21 * disc.faces.size());
    for_each_entry([&](std::size_t, int, int row, int column) { pattern.emplace_back(row, column, 0); });
    hessian_.resize(size, size);
    hessian_.setFromTriplets(pattern.begin(), pattern.end());
    slots_.resize(disc.faces.size());
    for_each_entry([&](std::size_t t, int entry, int row, int column) {
      const int* first = hessian_.innerIndexPtr() + hessian_.outerIndexPtr()[column];
      const int* last = hessian_.innerIndexPtr() + hessian_.outerIndexPtr()[column + 1];
      slots_[t][entry] = static_cast<int>(std::lower_bound(first, last, row) - hessian_.innerIndexPtr());
    });
    gradient_.resize(size);
    solver_.analyzePattern(hessian_);
  }

  /// The Newton step at `plane`; false when the system cannot be solved.
  bool step(const std::vector<RestTriangle>& rest, const std::vector<Vec2>& plane, VectorXd& direction) {
    std::fill_n(hessian_.valuePtr(), hessian_.nonZeros(), 0.0);
    gradient_.setZero();
    for (std::size_t t = 0; t < rest.size(); ++t) add_triangle(t, rest[t], plane);
    // The energy does not see motions of the plane: a trace of the diagonal holds them.
    const double hold = 1e-8 * hessian_.diagonal().mean();
    for (Eigen::Index i = 0; i < hessian_.rows(); ++i) hessian_.coeffRef(i, i) += hold;
    solver_.factorize(hessian_);
    if (solver_.info() != Eigen::Success) return false;
    direction = solver_.solve(-gradient_);
    return direction.allFinite();
  }

  [[nodiscard]] const VectorXd& gradient() const { return gradient_; }

 private:
  /// Calls visit(face, entry, row, column) for the lower triangle of each face's 6 x 6 block.
  template <class Visit>
  void for_each_entry(Visit visit) const {
    for (std::size_t t = 0; t < disc_.faces.size(); ++t) {
      int entry = 0;
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j <= i; ++j) {
          const int a = 2 * disc_.faces[t][i / 2] + i % 2, b = 2 * disc_.faces[t][j / 2] + j % 2;
          visit(t, entry++, std::max(a, b), std::min(a, b));
        }
    }
  }

  void add_triangle(std::size_t t, const RestTriangle& rest, const std::vector<Vec2>& plane) {
    const auto& f = disc_.faces[t];
    const auto [U, V, s] = decompose(deformation(rest, f, plane));
    const double s1 = s[0], s2 = s[1];
    const Vector2d slope(s1 - 1 / (s1 * s1 * s1), s2 - 1 / (s2 * s2 * s2));
    const double cube = s1 * s1 * s1 * s2 * s2 * s2;
    const std::array<double, 4> eigenvalue = {
        1 + 3 / (s1 * s1 * s1 * s1), 1 + 3 / (s2 * s2 * s2 * s2),
        std::max(0.0, 1 - (s1 * s1 - s1 * s2 + s2 * s2) / cube),  // twist
        1 + (s1 * s1 + s1 * s2 + s2 * s2) / cube};                // shear
    std::array<Vector2d, 3> turned;                               // hat gradients in the frame of V
    for (int k = 0; k < 3; ++k) {
      turned[k] = V.transpose() * rest.gradient[k];
      const Vector2d pull = rest.area * (U * slope.cwiseProduct(turned[k]));
      gradient_.segment<2>(2 * f[k]) += pull;
    }
    std::array<Eigen::Matrix<double, 6, 1>, 4> mode;
    const double half = std::sqrt(0.5);
    for (int k = 0; k < 3; ++k) {
      const double x = turned[k][0], y = turned[k][1];
      mode[0].segment<2>(2 * k) = U.col(0) * x;
      mode[1].segment<2>(2 * k) = U.col(1) * y;
      mode[2].segment<2>(2 * k) = half * (U.col(1) * x - U.col(0) * y);
      mode[3].segment<2>(2 * k) = half * (U.col(1) * x + U.col(0) * y);
    }
    Eigen::Matrix<double, 6, 6> block = Eigen::Matrix<double, 6, 6>::Zero();
    for (int m = 0; m < 4; ++m) block += (rest.area * eigenvalue[m]) * mode[m] * mode[m].transpose();
    int entry = 0;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j) hessian_.valuePtr()[slots_[t][entry++]] += block(i, j);
  }

  const DiscGeometry& disc_;
  SparseMatrix hessian_;  // lower triangle
  std::vector<std::array<int, 21>> slots_;
  VectorXd gradient_;
  Eigen::SimplicialLDLT<SparseMatrix> solver_;
};

std::vector<Vec2> moved(const std::vector<Vec2>& plane, const VectorXd& direction, double t) {
  std::vector<Vec2> result(plane.size());
  for (std::size_t v = 0; v < plane.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(2 * v);
    result[v] = plane[v] + t * Vec2(direction[row], direction[row + 1]);
  }
  return result;
}

}  // namespace

std::vector<Vec2> relax_symmetric_dirichlet(const DiscGeometry& disc, std::vector<Vec2> plane,
                                            const SymmetricDirichletOptions& options) {
  constexpr double sufficient = 1e-4;  // Armijo
  constexpr int most_halvings = 12;
  constexpr double most_steps = 8;  // Newton steps that one line search may go
  const std::vector<RestTriangle> rest = rest_triangles(disc);
  double value = energy(disc, rest, plane);
  if (!std::isfinite(value)) return plane;
  NewtonSystem system(disc);
  VectorXd direction;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (!system.step(rest, plane, direction)) break;
    const double slope = system.gradient().dot(direction);
    const double longest =
        0.9 * first_collapse(disc, plane, moved(plane, direction, most_steps)) * most_steps;
    const double before = value;
    double t = std::min(1.0, longest);
    for (int halving = 0; halving < most_halvings; ++halving, t *= 0.5) {
      const double reached = energy(disc, rest, moved(plane, direction, t));
      if (reached > value + sufficient * t * slope) continue;
      value = reached;
      // Near a collapse the energy is of inverse squares, on which a Newton step goes a third of the way
      // only.
      while (2 * t <= longest) {
        const double further = energy(disc, rest, moved(plane, direction, 2 * t));
        if (further >= value) break;
        value = further;
        t *= 2;
      }
      plane = moved(plane, direction, t);
      break;
    }
    if (before - value <= options.tolerance * value) break;
  }
  return plane;
}

}  // namespace applique
