#include "fem/supernodal_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "core/memory_limit.h"
#include "core/parallel.h"
#include "support/lattice.h"

namespace lacuna {
namespace {

SupernodalFactor FactorFor(const Lattice& lattice) {
  return SupernodalFactor(*lattice.pattern, NestedDissection(*lattice.pattern, lattice.fixed));
}

// The free entries of b in elimination order.
Eigen::VectorXf Reduced(const Eigen::VectorXd& b, const EliminationOrder& order) {
  Eigen::VectorXf reduced(3 * order.FreeNodes());
  for (int k = 0; k < order.FreeNodes(); ++k) {
    reduced.segment<3>(3 * k) = b.segment<3>(3 * order.node[k]).cast<float>();
  }
  return reduced;
}

TEST(SupernodalFactor, RefusesWhatDoesNotFitIntoMemory) {
  const Lattice lattice(12);
  SetMemoryLimit(MemoryInUse() + 1'000'000);
  EXPECT_THROW(FactorFor(lattice), OutOfMemory);
  SetMemoryLimit(0);
  EXPECT_GT(FactorFor(lattice).entries(), 1e6 / sizeof(float));
}

TEST(NestedDissection, OrdersEachFreeNodeOnceAndReproducibly) {
  const Lattice lattice(6);
  const EliminationOrder order = NestedDissection(*lattice.pattern, lattice.fixed);
  ASSERT_EQ(order.FreeNodes(), 6 * 6 * 5);
  for (int k = 0; k < order.FreeNodes(); ++k) {
    EXPECT_FALSE(lattice.fixed[order.node[k]]);
    EXPECT_EQ(order.place[order.node[k]], k);
  }
  EXPECT_EQ(std::count(order.place.begin(), order.place.end(), -1), 6 * 6);
  EXPECT_EQ(NestedDissection(*lattice.pattern, lattice.fixed).node, order.node);
}

TEST(AssemblyTree, ContainsEachEntryOfTheFactor) {
  const Lattice lattice(6);
  const AssemblyTree tree =
      MakeAssemblyTree(*lattice.pattern, NestedDissection(*lattice.pattern, lattice.fixed));
  const int n = tree.order.FreeNodes();
  // Symbolic elimination of a dense matrix of flags.
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> filled(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      filled(i, j) = lattice.pattern->Find(tree.order.node[i], tree.order.node[j]) >= 0;
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = j + 1; i < n; ++i) {
      for (int k = j + 1; filled(i, j) && k < n; ++k) {
        if (filled(k, j)) filled(i, k) = filled(k, i) = true;
      }
    }
  }

  ASSERT_EQ(tree.column_begin.back(), n);
  for (int s = 0; s < tree.SupernodeCount(); ++s) {
    EXPECT_TRUE(tree.parent[s] < 0 || tree.parent[s] > s);
    const auto rows = tree.row.begin() + tree.row_begin[s];
    const auto rows_end = tree.row.begin() + tree.row_begin[s + 1];
    EXPECT_TRUE(std::is_sorted(rows, rows_end));
    for (int j = tree.column_begin[s]; j < tree.column_begin[s + 1]; ++j) {
      for (int i = tree.column_begin[s + 1]; i < n; ++i) {
        EXPECT_TRUE(!filled(i, j) || std::binary_search(rows, rows_end, i)) << i << ", " << j;
      }
    }
    // The runs map each update row to the same row of the parent.
    for (const RowRun& run : tree.runs[s]) {
      const int p = tree.parent[s];
      for (int k = 0; k < run.length; ++k) {
        const int to = run.to + k, columns = tree.Columns(p);
        const int row =
            to < columns ? tree.column_begin[p] + to : tree.row[tree.row_begin[p] + to - columns];
        EXPECT_EQ(rows[run.from + k], row);
      }
    }
  }
}

// With 16³ nodes some fronts are divided into several tiles; 4³ nodes make a single front.
class SupernodalFactorOfSize : public testing::TestWithParam<int> {};

TEST_P(SupernodalFactorOfSize, SolvesToSinglePrecision) {
  const Lattice lattice(GetParam());
  const BlockMatrix A = lattice.Stiffness(0.3, 0.01);
  SupernodalFactor factor = FactorFor(lattice);
  Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  Eigen::VectorXf solution;
  for (int repetition = 0; repetition < 2; ++repetition) {
    ASSERT_EQ(factor.Factorise(A), Pivots::kPositive);
    factor.Solve(Reduced(b, factor.order()), &solution);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), product;
    for (int k = 0; k < factor.order().FreeNodes(); ++k) {
      x.segment<3>(3 * factor.order().node[k]) = solution.segment<3>(3 * k).cast<double>();
    }
    A.Multiply(x, &product);
    const Eigen::VectorXf residual = Reduced(b - product, factor.order());
    // Single precision (6e-8) times a condition number of a few thousand.
    EXPECT_LT(residual.norm(), 1e-3 * Reduced(b, factor.order()).norm());
  }
}

TEST_P(SupernodalFactorOfSize, GivesTheSameBitsOnOneAndTwoThreads) {
  const Lattice lattice(GetParam());
  const BlockMatrix A = lattice.Stiffness(0.3, 0.01);
  const int threads = ThreadCount();
  Eigen::VectorXf solutions[2];
  for (int k = 0; k < 2; ++k) {
    SetThreadCount(k + 1);
    SupernodalFactor factor = FactorFor(lattice);
    ASSERT_EQ(factor.Factorise(A), Pivots::kPositive);
    factor.Solve(Reduced(RandomVector(3 * lattice.Nodes()), factor.order()), &solutions[k]);
  }
  SetThreadCount(threads);
  EXPECT_EQ(solutions[0], solutions[1]);
}

INSTANTIATE_TEST_SUITE_P(Nodes, SupernodalFactorOfSize, testing::Values(2, 4, 9, 16));

TEST(SupernodalFactor, DistinguishesIndefiniteFromIllConditionedMatrices) {
  Lattice lattice(6);
  SupernodalFactor held = FactorFor(lattice);
  EXPECT_EQ(held.Factorise(lattice.Stiffness(0, 0.01)), Pivots::kPositive);
  EXPECT_EQ(held.Factorise(lattice.Stiffness(0, -3)), Pivots::kNegative);
  BlockMatrix not_a_number = lattice.Stiffness(0, 0.01);
  not_a_number.Block(not_a_number.pattern().BlockCount() - 1).setConstant(std::nan(""));
  EXPECT_EQ(held.Factorise(not_a_number), Pivots::kInDoubt);

  // Without fixed nodes the lattice can be translated without a force, so a pivot would be 0. A
  // small negative mass makes it negative, but by less than rounding errors.
  std::fill(lattice.fixed.begin(), lattice.fixed.end(), 0);
  EXPECT_EQ(FactorFor(lattice).Factorise(lattice.Stiffness(0, -1e-6)), Pivots::kInDoubt);
}

TEST(SupernodalFactor, CanBeUsedAfterAFailure) {
  const Lattice lattice(6);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  SupernodalFactor fresh = FactorFor(lattice), used = FactorFor(lattice);
  EXPECT_EQ(used.Factorise(lattice.Stiffness(0, -3)), Pivots::kNegative);
  Eigen::VectorXf x[2];
  for (SupernodalFactor* factor : {&fresh, &used}) {
    ASSERT_EQ(factor->Factorise(lattice.Stiffness(0, 1)), Pivots::kPositive);
    factor->Solve(Reduced(b, factor->order()), &x[factor == &used]);
  }
  EXPECT_EQ(x[0], x[1]);
}

}  // namespace
}  // namespace lacuna
