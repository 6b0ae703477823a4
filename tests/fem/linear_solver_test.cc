#include "fem/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/parallel.h"
#include "support/lattice.h"

namespace lacuna {
namespace {

// The solution of the free part by a dense factorisation; 0 at the fixed nodes.
Eigen::VectorXd DenseSolution(const BlockMatrix& A, const std::vector<char>& fixed,
                              const Eigen::VectorXd& b) {
  const BlockPattern& pattern = A.pattern();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(b.size(), b.size());
  Eigen::VectorXd right = b;
  for (int i = 0; i < pattern.nodes; ++i) {
    for (int k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k) {
      if (fixed[i] || fixed[pattern.column[k]]) continue;
      dense.block<3, 3>(3 * i, 3 * pattern.column[k]) = A.Block(k);
    }
    if (fixed[i]) {
      dense.block<3, 3>(3 * i, 3 * i).setIdentity();
      right.segment<3>(3 * i).setZero();
    }
  }
  return dense.ldlt().solve(right);
}

class LinearSolverMethod : public testing::TestWithParam<LinearSolverOptions::Method> {};

TEST_P(LinearSolverMethod, AgreesWithADenseFactorisationAndIsZeroAtFixedNodes) {
  const Lattice lattice(7);
  LinearSolverOptions options;
  options.method = GetParam();
  options.relative_tolerance = 1e-12;
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), options);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  // The later matrices differ from the first one, so that the kept factor is a preconditioner only.
  for (const double angle : {0.0, 0.1, 0.2}) {
    const BlockMatrix A = lattice.Stiffness(angle, 0.01);
    Eigen::VectorXd x;
    const LinearSolveSummary summary = solver.Solve(A, b, &x);
    ASSERT_TRUE(summary.IsUsable()) << summary.message;
    EXPECT_LE(summary.relative_residual, 1e-12);
    const Eigen::VectorXd expected = DenseSolution(A, lattice.fixed, b);
    // The tolerance of the solver times a condition number of about 1e3.
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm()) << "angle " << angle;
    for (int i = 0; i < lattice.n * lattice.n; ++i) {
      EXPECT_EQ(x.segment<3>(3 * i), Eigen::Vector3d::Zero());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, LinearSolverMethod,
                         testing::Values(LinearSolverOptions::Method::kKeptFactor,
                                         LinearSolverOptions::Method::kDirect),
                         [](const auto& info) {
                           return info.param == LinearSolverOptions::Method::kDirect ? "Direct"
                                                                                     : "KeptFactor";
                         });

TEST(LinearSolver, KeepsItsFactorForSimilarMatricesAndRenewsItForOthers) {
  const Lattice lattice(14);
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  Eigen::VectorXd x;
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 0.01), b, &x).factorised);
  EXPECT_EQ(solver.factorisations(), 1);

  const LinearSolveSummary like = solver.Solve(lattice.Stiffness(0.01, 0.01), b, &x);
  EXPECT_TRUE(like.IsUsable());
  EXPECT_FALSE(like.factorised);
  EXPECT_GT(like.iterations, 0);
  EXPECT_EQ(solver.factorisations(), 1);

  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(solver.Solve(lattice.Stiffness(1.2, 1e-4), b, &x).IsUsable());
  }
  EXPECT_EQ(solver.factorisations(), 2);

  solver.DropFactor();
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(1.2, 1e-4), b, &x).factorised);
  EXPECT_EQ(solver.factorisations(), 3);
}

TEST(LinearSolver, RotatesItsFactorWithTheBody) {
  const Lattice lattice(10);
  const double angle = 1.3;
  const std::vector<Eigen::Matrix3d> before(lattice.Nodes(), Eigen::Matrix3d::Identity());
  const std::vector<Eigen::Matrix3d> after(
      lattice.Nodes(), Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  Eigen::VectorXd x;
  const int when_new = solver.Solve(lattice.Stiffness(0, 0.01), b, &x, &before).iterations;
  // The lattice has rotated as a whole, so the rotated factor is as good as a new one.
  const LinearSolveSummary rotated = solver.Solve(lattice.Stiffness(angle, 0.01), b, &x, &after);
  EXPECT_TRUE(rotated.IsUsable());
  EXPECT_FALSE(rotated.factorised);
  EXPECT_LE(rotated.iterations, when_new + 1);
  // A solver that is not given the rotation renews its factor.
  LinearSolver without_rotations(lattice.pattern, HoldNodes(lattice.fixed), {});
  without_rotations.Solve(lattice.Stiffness(0, 0.01), b, &x);
  EXPECT_TRUE(without_rotations.Solve(lattice.Stiffness(angle, 0.01), b, &x).factorised);
}

TEST(LinearSolver, StartsFromEarlierSolutionsIfTheyHelp) {
  const Lattice lattice(10);
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  const BlockMatrix A = lattice.Stiffness(0, 0.01);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  Eigen::VectorXd x, doubled;
  solver.Solve(A, b, &x);
  EXPECT_EQ(solver.Solve(A, 2 * b, &doubled).iterations, 0);
  // Both solutions have a tolerance of 1e-9, at a condition number of about 1e3.
  EXPECT_LT((doubled - 2 * x).norm(), 1e-5 * doubled.norm());
}

TEST(LinearSolver, FallsBackOnDoublePrecisionForIllConditionedMatrices) {
  // Without fixed nodes and with a tiny mass term, the condition number is about 1e10.
  const Lattice lattice(5);
  const std::vector<char> free(lattice.Nodes(), 0);
  LinearSolver solver(lattice.pattern, HoldNodes(free), {.relative_tolerance = 1e-8});
  const BlockMatrix A = lattice.Stiffness(0, 1e-9);
  Eigen::VectorXd b = RandomVector(3 * lattice.Nodes()), x, product;
  const LinearSolveSummary summary = solver.Solve(A, b, &x);
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  A.Multiply(x, &product);
  // By rounding, the residual of the recurrence deviates from the true one by 1e-16 ‖A‖ ‖x‖ with
  // ‖A‖ ‖x‖ ≈ 1e10 ‖b‖.
  EXPECT_LT((b - product).norm(), 1e-5 * b.norm());
}

TEST(LinearSolver, DirectFactorisesEachMatrix) {
  const Lattice lattice(4);
  LinearSolverOptions options;
  options.method = LinearSolverOptions::Method::kDirect;
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), options);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  Eigen::VectorXd x;
  for (int k = 1; k <= 3; ++k) {
    EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), b, &x).factorised);
    EXPECT_EQ(solver.factorisations(), k);
  }
}

TEST(LinearSolver, ReportsAMatrixThatIsNotPositiveDefinite) {
  const Lattice lattice(5);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  Eigen::VectorXd x;
  const auto expect_refusal = [&] {
    const LinearSolveSummary summary = solver.Solve(lattice.Stiffness(0, -3), b, &x);
    EXPECT_EQ(summary.status, LinearSolveSummary::Status::kNotPositiveDefinite);
    EXPECT_FALSE(summary.IsUsable());
    EXPECT_FALSE(summary.message.empty());
    EXPECT_EQ(x, Eigen::VectorXd::Zero(b.size()));
  };
  expect_refusal();
  // The same holds if the factor of an earlier matrix is available, and the next definite matrix is
  // solved again.
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), b, &x).IsUsable());
  expect_refusal();
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), b, &x).IsUsable());
}

TEST(LinearSolver, ReportsNotANumber) {
  const Lattice lattice(3);
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  Eigen::VectorXd b = RandomVector(3 * lattice.Nodes()), x;
  BlockMatrix A = lattice.Stiffness(0, 1);
  b[b.size() - 1] = std::nan("");
  EXPECT_FALSE(solver.Solve(A, b, &x).IsUsable());
  b[b.size() - 1] = 1;
  A.Block(A.pattern().BlockCount() - 1)(2, 2) = std::nan("");
  EXPECT_FALSE(solver.Solve(A, b, &x).IsUsable());
}

TEST(LinearSolver, AcceptsAZeroRightHandSideAndABodyWithoutFreeNodes) {
  const Lattice lattice(3);
  Eigen::VectorXd x;
  LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3 * lattice.Nodes());
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), zero, &x).IsUsable());
  EXPECT_EQ(x, zero);
  LinearSolver held(lattice.pattern, HoldNodes(std::vector<char>(lattice.Nodes(), 1)), {});
  EXPECT_TRUE(held.Solve(lattice.Stiffness(0, 1), RandomVector(zero.size()), &x).IsUsable());
  EXPECT_EQ(x, zero);
}

TEST(LinearSolver, GivesTheSameBitsOnOneAndTwoThreadsAndOnARepeatedRun) {
  const Lattice lattice(12);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  const auto solutions = [&](int threads) {
    const int before = ThreadCount();
    SetThreadCount(threads);
    LinearSolver solver(lattice.pattern, HoldNodes(lattice.fixed), {});
    Eigen::MatrixXd all(b.size(), 4);
    for (int k = 0; k < 4; ++k) {
      Eigen::VectorXd x;
      EXPECT_TRUE(solver.Solve(lattice.Stiffness(0.1 * k, 0.01), b, &x).IsUsable());
      all.col(k) = x;
    }
    SetThreadCount(before);
    return all;
  };
  const Eigen::MatrixXd on_two = solutions(2);
  EXPECT_EQ(on_two, solutions(1));
  EXPECT_EQ(on_two, solutions(2));
}

}  // namespace
}  // namespace lacuna
