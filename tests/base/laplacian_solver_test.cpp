#include "applique/base/laplacian_solver.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/laplacians.h"

namespace applique {
namespace {

using Matrix = LaplacianSolver::Matrix;

constexpr std::size_t never = 0, always = ~std::size_t{0};  // factored

bool on_rim(const Vec3& p) {
  return std::max(std::abs(p.x()), std::abs(p.y())) == 1;
}

bool at_corner(const Vec3& p) {
  return p.x() == -1 && p.y() == -1;
}

double energy_norm(const Matrix& lower, const Eigen::VectorXcd& x) {
  const Eigen::VectorXcd image = lower.selfadjointView<Eigen::Lower>() * x;
  return std::sqrt(x.dot(image).real());
}

/// The energy norm of the difference between the two ways, as a share of the solution's.
double difference(const Matrix& lower, int most_iterations) {
  const Eigen::VectorXcd right = Eigen::VectorXcd::Random(lower.rows());
  LaplacianSolver factors({always}), multigrid({never});
  EXPECT_TRUE(factors.compute(lower));
  EXPECT_TRUE(multigrid.compute(lower));
  const Eigen::VectorXcd exact = factors.solve(right), iterated = multigrid.solve(right);
  EXPECT_EQ(factors.iterations(), 0);
  EXPECT_GT(multigrid.iterations(), 0);
  EXPECT_LE(multigrid.iterations(), most_iterations);
  return energy_norm(lower, iterated - exact) / energy_norm(lower, exact);
}

constexpr double tolerance = 10 * LaplacianSolverOptions().tolerance;

TEST(LaplacianSolver, MultigridAgreesWithTheFactors) {
  EXPECT_LT(difference(laplacians::cotangent(shapes::hills(90), on_rim), 20), tolerance);
}

TEST(LaplacianSolver, OneHeldVertexIsEnough) {
  EXPECT_LT(difference(laplacians::cotangent(shapes::hills(90), at_corner), 25), tolerance);
}

TEST(LaplacianSolver, SolvesWhereWeightsVaryAMillionfold) {
  const shapes::Soup soup = shapes::hills(90);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-3, 3);
  std::vector<double> any(soup.triangles.size());
  for (double& weight : any) weight = std::pow(10, exponent(random));
  EXPECT_LT(difference(laplacians::cotangent(soup, on_rim, [&](std::size_t t) { return any[t]; }), 60),
            tolerance);
  const auto along_x = [&](std::size_t t) {
    return std::pow(10, 3 * soup.positions[soup.triangles[t][0]].x());
  };
  EXPECT_LT(difference(laplacians::cotangent(soup, on_rim, along_x), 30), tolerance);
}

TEST(LaplacianSolver, SolvesOnNeedlesAndNegativeWeights) {
  const shapes::Soup thin =
      shapes::grid(360, 24, [](double s, double t) { return shapes::hills_at(2 * s - 1, 2 * t - 1); });
  EXPECT_LT(difference(laplacians::cotangent(thin, on_rim), 30), tolerance);
  const Matrix obtuse =
      laplacians::cotangent(shapes::plane(90, 90, 1, 1, 0.35), [](const Vec3& p) { return p.x() == 0; });
  bool negative = false;
  for (Eigen::Index c = 0; c < obtuse.outerSize(); ++c)
    for (Matrix::InnerIterator entry(obtuse, c); entry; ++entry)
      negative = negative || (entry.row() != c && entry.value() > 0);
  ASSERT_TRUE(negative);
  EXPECT_LT(difference(obtuse, 60), tolerance);
}

/// Sixteen times the unknowns: what makes the cost grow as they do.
TEST(LaplacianSolver, IterationsHardlyGrowWithTheUnknowns) {
  const auto iterations = [](int cells) {
    const Matrix lower = laplacians::cotangent(shapes::hills(cells), on_rim);
    LaplacianSolver solver({never});
    EXPECT_TRUE(solver.compute(lower));
    EXPECT_TRUE(solver.solve(Eigen::VectorXd(Eigen::VectorXd::Ones(lower.rows()))).allFinite());
    return solver.iterations();
  };
  EXPECT_LE(iterations(200), iterations(50) + 8);
}

TEST(LaplacianSolver, GivesWayToTheFactorsWhenItDoesNotConverge) {
  const Matrix lower = laplacians::cotangent(shapes::hills(40), on_rim);
  const Eigen::VectorXcd right = Eigen::VectorXcd::Random(lower.rows());
  LaplacianSolver hasty({never, 1e-10, 2}), factors({always});
  ASSERT_TRUE(hasty.compute(lower));
  ASSERT_TRUE(factors.compute(lower));
  EXPECT_LT((hasty.solve(right) - factors.solve(right)).norm(), 1e-10 * right.norm());
  EXPECT_EQ(hasty.iterations(), 0);
}

TEST(LaplacianSolver, RenewsTheValuesOfAPattern) {
  const shapes::Soup soup = shapes::hills(40);
  for (const std::size_t most_factored : {never, always}) {
    LaplacianSolver solver({most_factored});
    const Matrix lower = laplacians::cotangent(soup, on_rim);
    const Eigen::VectorXd right = Eigen::VectorXd::Random(lower.rows());
    ASSERT_TRUE(solver.compute(lower));
    const Eigen::VectorXd once = solver.solve(right);
    ASSERT_TRUE(solver.renew(3 * lower));
    EXPECT_LT((3 * solver.solve(right) - once).norm(), 1e-8 * once.norm());
  }
}

TEST(LaplacianSolver, ASingularMatrixHasNoFiniteSolution) {
  Matrix lower = laplacians::cotangent(shapes::hills(20), on_rim);
  lower.coeffRef(0, 0) = 0;
  for (Eigen::Index i = 1; i < lower.rows(); ++i)
    if (lower.coeff(i, 0) != 0) lower.coeffRef(i, 0) = 0;
  EXPECT_FALSE(LaplacianSolver({always}).compute(lower));
  LaplacianSolver multigrid({never});
  const bool finite = multigrid.compute(lower) &&
                      multigrid.solve(Eigen::VectorXd(Eigen::VectorXd::Ones(lower.rows()))).allFinite();
  EXPECT_FALSE(finite);
}

}  // namespace
}  // namespace applique
