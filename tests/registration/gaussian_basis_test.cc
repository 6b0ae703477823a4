#include "registration/gaussian_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "registration/basis_table.h"
#include "registration/warped_body.h"

namespace lacuna {
namespace {

constexpr double kTolerance = 1e-4;

double KernelAt(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double squared = (a - b).squaredNorm();
  return std::exp(-0.5 * squared / (1.5 * 1.5)) + 0.02 * std::exp(-0.5 * squared / (0.6 * 0.6));
}

Eigen::Matrix3Xd Body(int count, uint64_t seed) { return SampleBody(count, seed).points / 0.05; }

GaussianBasis BasisOn(const Eigen::Matrix3Xd& points, int max_rank = 1000) {
  return GaussianBasis(points, {{1.5, 1.0}, {0.6, 0.02}}, kTolerance, max_rank);
}

TEST(GaussianBasisTest, ProductsOfTheFunctionsAreTheKernel) {
  const Eigen::Matrix3Xd points = Body(300, 1);
  const GaussianBasis basis = BasisOn(points);
  ASSERT_LT(basis.Rank(), 200);
  const Eigen::MatrixXd values = basis.Values(points);
  const Eigen::MatrixXd kernel = values.transpose() * values;
  // The remainder is positive semidefinite with a diagonal up to the tolerance times k(y, y)
  // = 1.02.
  for (int i = 0; i < 300; i += 7) {
    for (int j = 0; j < 300; j += 5) {
      EXPECT_NEAR(kernel(i, j), KernelAt(points.col(i), points.col(j)), 1.02 * kTolerance);
    }
  }
}

TEST(GaussianBasisTest, GradientsMatchFiniteDifferences) {
  const GaussianBasis basis = BasisOn(Body(300, 1), 40);
  const Eigen::Matrix3Xd points = Body(5, 2);
  Eigen::MatrixXd gradient[3];
  basis.Gradients(points, gradient);
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Matrix3Xd before = points, after = points;
    before.row(axis).array() -= kStep;
    after.row(axis).array() += kStep;
    const Eigen::MatrixXd slope = (basis.Values(after) - basis.Values(before)) / (2.0 * kStep);
    // The rounding error of φ (about 1e-14 after L⁻¹) divided by the step.
    EXPECT_LT((slope - gradient[axis]).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_GT(slope.cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(GaussianBasisTest, LeadingFunctionsEqualThoseOfTheWholeBasis) {
  const Eigen::Matrix3Xd points = Body(300, 1);
  const GaussianBasis basis = BasisOn(points, 40);
  const Eigen::MatrixXd difference =
      basis.Leading(12).Values(points) - basis.Values(points).topRows(12);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BasisTableTest, AgreesWithTheBasisInDoublePrecision) {
  const Eigen::Matrix3Xd points = Body(333, 3);
  const GaussianBasis basis = BasisOn(Body(300, 1), 64);
  const BlockTree tree(points.cast<float>());
  const BasisTable table(basis, tree, BestKernels());
  const Eigen::MatrixXd values = basis.Values(points);
  const Eigen::Matrix3Xd coefficients = Eigen::Matrix3Xd::Random(3, basis.Rank());
  // Coordinates and kernel values are rounded to 6e-8, multiplied by |L⁻¹| ≈ 100 and √64.
  EXPECT_LT((table.Expand(coefficients).cast<double>() - coefficients * values).norm() /
                (coefficients * values).norm(),
            1e-4);
  const Eigen::Matrix3Xf forces = Eigen::Matrix3Xf::Random(3, points.cols());
  const Eigen::Matrix3Xd projected = forces.cast<double>() * values.transpose();
  EXPECT_LT((table.Project(forces) - projected).norm() / projected.norm(), 1e-4);
}

// With a fine tolerance L⁻¹ is so large that kernel values in single precision would not suffice.
TEST(BasisTableTest, AgreesWithAFineBasisToo) {
  const Eigen::Matrix3Xd points = Body(333, 3).cast<float>().cast<double>();
  const GaussianBasis basis(Body(300, 1), {{1.0, 1.0}}, 1e-9, 300);
  const BlockTree tree(points.cast<float>());
  const BasisTable table(basis, tree, BestKernels());
  const Eigen::MatrixXd values = basis.Values(points);
  const Eigen::Matrix3Xd coefficients = Eigen::Matrix3Xd::Random(3, basis.Rank());
  // φ is rounded to 6e-8.
  EXPECT_LT((table.Expand(coefficients).cast<double>() - coefficients * values).norm() /
                (coefficients * values).norm(),
            1e-6);
  const Eigen::Matrix3Xf forces = Eigen::Matrix3Xf::Random(3, points.cols());
  const Eigen::Matrix3Xd projected = forces.cast<double>() * values.transpose();
  // Compare function by function, because the finest ones have the smallest values.
  for (int k = 0; k < basis.Rank(); ++k) {
    EXPECT_LT((table.Project(forces) - projected).col(k).norm(),
              1e-5 * values.row(k).norm() * std::sqrt(333.0));
  }
}

}  // namespace
}  // namespace lacuna
