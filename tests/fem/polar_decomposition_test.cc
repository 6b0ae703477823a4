#include "fem/polar_decomposition.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <vector>

namespace lacuna {
namespace {

Eigen::Matrix3d RandomMatrix(std::mt19937* random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix3d matrix;
  for (double& entry : matrix.reshaped()) entry = normal(*random);
  return matrix;
}

// Checks the conditions for R to be the rotation nearest to F: RᵀR = I, det R = 1, S = RᵀF is
// symmetric, and the sum of any two eigenvalues of S is not negative, i.e. tr(S) I − S is positive
// semi-definite.
void ExpectNearestRotation(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) {
  // Rounding of a few operations on entries of the magnitude of F.
  const double tolerance = 1e-12;
  EXPECT_NEAR((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 0, tolerance);
  EXPECT_NEAR(R.determinant(), 1, tolerance);
  const Eigen::Matrix3d S = R.transpose() * F;
  // If two singular values nearly cancel, the rotation is ill-conditioned, but S is still
  // symmetric.
  EXPECT_NEAR((S - S.transpose()).norm(), 0, 1e-10 * F.norm());
  const Eigen::Matrix3d sums = S.trace() * Eigen::Matrix3d::Identity() - S;
  EXPECT_GE(sums.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-10 * F.norm());
}

TEST(PolarDecompositionTest, ManyRotationsAreTheNearestOnesOfRegularSingularAndInvertedMatrices) {
  std::mt19937 random(5);
  std::vector<Eigen::Matrix3d> F;
  for (int k = 0; k < 101; ++k) {  // not a multiple of the number of lanes
    const Eigen::Matrix3d matrix = RandomMatrix(&random);
    if (k % 3 == 0) {
      const Eigen::Vector3d axis = RandomMatrix(&random).col(0).normalized();
      F.push_back(Eigen::AngleAxisd(k, axis) * (Eigen::Matrix3d::Identity() + 0.1 * matrix));
    } else if (k % 3 == 1) {
      F.push_back(matrix);  // half of them inverted
    } else {
      F.push_back(1e-4 * matrix);  // needs more steps than the lanes perform
    }
  }
  F[7] = Eigen::Vector3d(1, 1, 0).asDiagonal();
  std::vector<Eigen::Matrix3d> R = F;
  ReplaceByRotations(static_cast<int>(R.size()), R.data());
  for (size_t k = 0; k < F.size(); ++k) {
    SCOPED_TRACE(k);
    ExpectNearestRotation(F[k], R[k]);
  }
}

TEST(PolarDecompositionTest, ManyRotationsAgreeWithSingleOnes) {
  std::mt19937 random(6);
  std::vector<Eigen::Matrix3d> F;
  for (int k = 0; k < 40; ++k) {
    F.push_back(Eigen::Matrix3d::Identity() + 0.2 * RandomMatrix(&random));
  }
  std::vector<Eigen::Matrix3d> R = F;
  ReplaceByRotations(static_cast<int>(R.size()), R.data());
  for (size_t k = 0; k < F.size(); ++k) {
    // Both iterations end at rounding errors.
    EXPECT_NEAR((R[k] - PolarRotation(F[k])).norm(), 0, 1e-12);
  }
}

}  // namespace
}  // namespace lacuna
