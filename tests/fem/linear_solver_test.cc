#include "fem/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/parallel.h"

namespace lacuna {
namespace {

// A block of n × n × n nodes, each coupled by springs to its neighbours along the lattice's edges
// and diagonals: a small stand-in for a stiffness matrix, with one end held.
struct Lattice {
  int n;
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<char> fixed;

  explicit Lattice(int size) : n(size), fixed(Nodes(), 0) {
    const int path[6][3] = {{1, 3, 7}, {1, 5, 7}, {2, 3, 7}, {2, 6, 7}, {4, 5, 7}, {4, 6, 7}};
    const int cells = n - 1;
    Eigen::MatrixXi tets(4, 6 * cells * cells * cells);
    Eigen::Index e = 0;
    for (int z = 0; z < cells; ++z) {
      for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
          const auto corner = [&](int k) {
            return Node(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
          };
          for (const auto& p : path) {
            tets.col(e++) << corner(0), corner(p[0]), corner(p[1]), corner(p[2]);
          }
        }
      }
    }
    pattern = std::make_shared<BlockPattern>(MakeBlockPattern(Nodes(), tets));
    for (int k = 0; k < n * n; ++k) fixed[k] = 1;
  }

  int Nodes() const { return n * n * n; }
  int Node(int x, int y, int z) const { return x + n * (y + n * z); }

  // Springs of random stiffness between 1 and 2, along edges turned by `angle` about z, plus a
  // mass on each node.
  BlockMatrix Stiffness(double angle, double mass) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(1, 2);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    BlockMatrix matrix(pattern);
    for (int i = 0; i < Nodes(); ++i) {
      matrix.Block(pattern->diagonal[i]) += mass * Eigen::Matrix3d::Identity();
      for (int k = pattern->row_begin[i]; k < pattern->row_begin[i + 1]; ++k) {
        const int j = pattern->column[k];
        if (j <= i) continue;
        const Eigen::Vector3d edge = turn * (Position(j) - Position(i)).normalized();
        const Eigen::Matrix3d spring =
            uniform(random) * (edge * edge.transpose() + 0.05 * Eigen::Matrix3d::Identity());
        matrix.Block(k) -= spring;
        matrix.Block(pattern->Find(j, i)) -= spring.transpose();
        matrix.Block(pattern->diagonal[i]) += spring;
        matrix.Block(pattern->diagonal[j]) += spring;
      }
    }
    return matrix;
  }

  Eigen::Vector3d Position(int node) const {
    return Eigen::Vector3d(node % n, node / n % n, node / (n * n));
  }
};

Eigen::VectorXd RandomVector(Eigen::Index size) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(size);
  for (double& value : v) value = normal(random);
  return v;
}

// The free part solved densely, 0 on the fixed nodes.
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

TEST_P(LinearSolverMethod, SolvesLikeADenseFactorisationAndLeavesFixedNodesAtZero) {
  const Lattice lattice(7);
  LinearSolverOptions options;
  options.method = GetParam();
  options.relative_tolerance = 1e-12;
  LinearSolver solver(lattice.pattern, lattice.fixed, options);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  // The second and third matrices differ, so that a kept factor is a preconditioner there.
  for (const double angle : {0.0, 0.1, 0.2}) {
    const BlockMatrix A = lattice.Stiffness(angle, 0.01);
    Eigen::VectorXd x;
    const LinearSolveSummary summary = solver.Solve(A, b, &x);
    ASSERT_TRUE(summary.IsUsable()) << summary.message;
    EXPECT_LE(summary.relative_residual, 1e-12);
    const Eigen::VectorXd expected = DenseSolution(A, lattice.fixed, b);
    // Condition number of about 1e3 times the tolerance.
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

TEST(LinearSolver, KeepsItsFactorForLikeMatricesAndRenewsItForUnlikeOnes) {
  const Lattice lattice(14);
  LinearSolver solver(lattice.pattern, lattice.fixed, {});
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

TEST(LinearSolver, DirectFactorisesEachMatrix) {
  const Lattice lattice(4);
  LinearSolverOptions options;
  options.method = LinearSolverOptions::Method::kDirect;
  LinearSolver solver(lattice.pattern, lattice.fixed, options);
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
  LinearSolver solver(lattice.pattern, lattice.fixed, {});
  Eigen::VectorXd x;
  const auto expect_refusal = [&] {
    const LinearSolveSummary summary = solver.Solve(lattice.Stiffness(0, -3), b, &x);
    EXPECT_EQ(summary.status, LinearSolveSummary::Status::kNotPositiveDefinite);
    EXPECT_FALSE(summary.IsUsable());
    EXPECT_FALSE(summary.message.empty());
    EXPECT_EQ(x, Eigen::VectorXd::Zero(b.size()));
  };
  expect_refusal();
  // Also when a good factor of an earlier matrix is at hand; and the next good matrix is solved.
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), b, &x).IsUsable());
  expect_refusal();
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), b, &x).IsUsable());
}

TEST(LinearSolver, ReportsNotANumber) {
  const Lattice lattice(3);
  LinearSolver solver(lattice.pattern, lattice.fixed, {});
  Eigen::VectorXd b = RandomVector(3 * lattice.Nodes()), x;
  BlockMatrix A = lattice.Stiffness(0, 1);
  b[b.size() - 1] = std::nan("");
  EXPECT_FALSE(solver.Solve(A, b, &x).IsUsable());
  b[b.size() - 1] = 1;
  A.Block(A.pattern().BlockCount() - 1)(2, 2) = std::nan("");
  EXPECT_FALSE(solver.Solve(A, b, &x).IsUsable());
}

TEST(LinearSolver, SolvesANullRightHandSideAndABodyWithoutFreeNodes) {
  const Lattice lattice(3);
  Eigen::VectorXd x;
  LinearSolver solver(lattice.pattern, lattice.fixed, {});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3 * lattice.Nodes());
  EXPECT_TRUE(solver.Solve(lattice.Stiffness(0, 1), zero, &x).IsUsable());
  EXPECT_EQ(x, zero);
  LinearSolver held(lattice.pattern, std::vector<char>(lattice.Nodes(), 1), {});
  EXPECT_TRUE(held.Solve(lattice.Stiffness(0, 1), RandomVector(zero.size()), &x).IsUsable());
  EXPECT_EQ(x, zero);
}

TEST(LinearSolver, GivesTheSameBitsOnOneAndTwoThreadsAndOnARepeatedRun) {
  const Lattice lattice(12);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  const auto solutions = [&](int threads) {
    const int before = ThreadCount();
    SetThreadCount(threads);
    LinearSolver solver(lattice.pattern, lattice.fixed, {});
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
