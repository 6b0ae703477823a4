#include "registration/motion_step.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "registration/rigidity.h"
#include "registration/warped_body.h"

namespace lacuna {
namespace {

GaussianBasis BasisOn(const Eigen::Matrix3Xd& points) {
  return GaussianBasis(points, {{1.5, 1.0}}, 1e-3, 20);
}

double RigidityEnergy(const Patches& patches, const Eigen::Matrix3Xd& coefficients) {
  double energy = 0.0;
  for (const Eigen::Matrix3d& f : DeformationGradients(patches, coefficients)) {
    energy += 0.5 * (f - NearestRotation(f)).squaredNorm() / patches.Count();
  }
  return energy;
}

TEST(RigidityTest, GradientMatchesFiniteDifferencesOfTheEnergy) {
  const Eigen::Matrix3Xd points = SampleBody(300, 1).points / 0.05;
  const Patches patches = MakePatches(BasisOn(points), points);
  const Eigen::Index rank = patches.mean_basis.rows();
  const Eigen::Matrix3Xd coefficients = 0.1 * Eigen::Matrix3Xd::Random(3, rank);
  const Eigen::Matrix3Xd gradient =
      RigidityGradient(patches, DeformationGradients(patches, coefficients));
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < coefficients.size(); i += 5) {
    Eigen::Matrix3Xd before = coefficients, after = coefficients;
    before.data()[i] -= kStep;
    after.data()[i] += kStep;
    const double slope =
        (RigidityEnergy(patches, after) - RigidityEnergy(patches, before)) / (2.0 * kStep);
    // Central differences of an energy of about 0.1 have a rounding error of 1e-16 / 1e-5 and a
    // truncation error of 1e-10.
    EXPECT_NEAR(gradient.data()[i], slope, 1e-8);
  }
  EXPECT_GT(gradient.norm(), 1e-2);
}

TEST(RigidityTest, ARotationHasNoEnergyAndAStretchHas) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT((NearestRotation(rotation) - rotation).norm(), 1e-12);
  const Eigen::Matrix3d stretch = Eigen::Vector3d(1.2, 0.9, 1.1).asDiagonal();
  EXPECT_LT((NearestRotation(rotation * stretch) - rotation).norm(), 1e-12);
  EXPECT_EQ(NearestRotation(Eigen::Matrix3d::Zero()), Eigen::Matrix3d::Identity());
}

TEST(MotionStepTest, TheNewtonStepOfPlainCpdSolvesItsNormalEquations) {
  const PointCloud body = SampleBody(200, 1);
  const Eigen::Matrix3Xd points = body.points / 0.05;
  const GaussianBasis basis = BasisOn(points);
  SourceSurface source;
  source.normals = body.normals;
  source.curvature_bias.setZero(200);
  source.patches = MakePatches(basis, points);  // of one point each
  ASSERT_EQ(source.patches.size, 1);
  const BlockTree tree(points.cast<float>());
  const BasisTable table(basis, tree, BestKernels());
  Posterior posterior;
  posterior.weight = Eigen::VectorXf::Random(200).array() + 1.5f;
  posterior.shift = 0.1f * Eigen::Matrix3Xf::Random(3, 200);
  const MotionObjective objective = {1.0, 0.3, 0.0};
  const Eigen::Matrix3Xd coefficients = 0.1 * Eigen::Matrix3Xd::Random(3, basis.Rank());
  const std::vector<Eigen::Matrix3d> gradients = DeformationGradients(source.patches, coefficients);
  const Pull pull = PullOf(source, gradients, posterior, 0.1, objective);
  const Eigen::LLT<Eigen::MatrixXd> hessian(
      MotionHessian(source, pull, RigidityHessian(source.patches), objective)
          .selfadjointView<Eigen::Lower>());
  const Eigen::Matrix3Xd found =
      coefficients + MotionStep(source, table, pull, coefficients, gradients, objective, hessian);

  // Myronenko & Song 2010, Eq. 22, in the basis: (Φ diag(P) Φᵀ + σ²λ) cᵀ = Φ diag(P) (u + d)ᵀ.
  const Eigen::MatrixXd phi = basis.Values(points);
  const Eigen::VectorXd weight = posterior.weight.cast<double>();
  Eigen::MatrixXd left = phi * weight.asDiagonal() * phi.transpose();
  left.diagonal().array() += 0.3;
  const Eigen::Matrix3Xd goal = coefficients * phi + posterior.shift.cast<double>();
  const Eigen::Matrix3Xd expected =
      left.llt().solve(phi * weight.asDiagonal() * goal.transpose()).transpose();
  // The Hessian is summed in single precision and has a condition number of about 1e3.
  EXPECT_LT((found - expected).norm(), 1e-3 * expected.norm());
}

TEST(MotionStepTest, OnlyTheDistanceAlongTheNormalExertsAForce) {
  const PointCloud body = SampleBody(64, 1);
  const Eigen::Matrix3Xd points = body.points / 0.05;
  const GaussianBasis basis = BasisOn(points);
  SourceSurface source{body.normals, Eigen::VectorXd::Zero(64), MakePatches(basis, points)};
  Posterior posterior;
  posterior.weight.setOnes(64);
  posterior.shift.resize(3, 64);
  for (int i = 0; i < 64; ++i) {
    posterior.shift.col(i) = body.normals.col(i).unitOrthogonal().cast<float>();
  }
  const std::vector<Eigen::Matrix3d> still(64, Eigen::Matrix3d::Identity());
  EXPECT_LT(PullOf(source, still, posterior, 0.1, {0.0, 0.0, 0.0}).force.norm(), 1e-5);
  source.normals.setZero();  // unknown: the whole distance counts
  EXPECT_NEAR(PullOf(source, still, posterior, 0.1, {0.0, 0.0, 0.0}).force.norm(), 8.0, 1e-4);
}

}  // namespace
}  // namespace lacuna
