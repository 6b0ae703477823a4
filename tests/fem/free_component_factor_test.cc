#include "fem/free_component_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "support/dense_matrix.h"
#include "support/lattice.h"

namespace lacuna {
namespace {

// A lattice with one end held along all axes and, elsewhere, some nodes held along one or two.
struct PartlyHeldLattice {
  Lattice lattice = Lattice(4);
  std::vector<AxisSet> axes;
  std::vector<int> free_components, held_components;

  PartlyHeldLattice() : axes(static_cast<size_t>(lattice.Nodes())) {
    for (int node = 0; node < lattice.Nodes(); ++node) {
      AxisSet& held = axes[static_cast<size_t>(node)];
      if (lattice.fixed[static_cast<size_t>(node)])
        held = AxisSet::All();
      else if (node % 5 == 1)
        held = AxisSet::Of(1);
      else if (node % 5 == 2)
        held = AxisSet::Of(0) | AxisSet::Of(2);
      for (int axis = 0; axis < 3; ++axis)
        (held.Has(axis) ? held_components : free_components).push_back(3 * node + axis);
    }
  }

  FreeComponentFactor Factor() const { return {*lattice.pattern, HeldComponents(axes)}; }

  Eigen::MatrixXd RightHandSides() const {
    return RandomVector(2 * 3 * lattice.Nodes()).reshaped(3 * lattice.Nodes(), 2);
  }
};

// The second matrix is solved with a new factor in the same order.
TEST(FreeComponentFactor, AgreesWithADenseFactorisation) {
  const PartlyHeldLattice held;
  const std::vector<int>& free = held.free_components;
  const Eigen::MatrixXd B = held.RightHandSides();
  FreeComponentFactor factor = held.Factor();
  for (const double angle : {0.0, 0.3}) {
    const BlockMatrix A = held.lattice.Stiffness(angle, 0.01);
    const Eigen::MatrixXd free_part = Dense(A)(free, free), free_right = B(free, Eigen::all);
    const Eigen::MatrixXd solution = free_part.ldlt().solve(free_right);
    ASSERT_TRUE(factor.Factorise(A));
    const Eigen::MatrixXd X = factor.Solve(B);
    ASSERT_EQ(X.rows(), B.rows());
    EXPECT_LT((X(free, Eigen::all) - solution).norm(), 1e-10 * solution.norm());
    EXPECT_TRUE(X(held.held_components, Eigen::all).isZero(0));
  }
}

TEST(FreeComponentFactor, DoesNotUseTheHeldComponentsOfTheRightHandSide) {
  const PartlyHeldLattice held;
  FreeComponentFactor factor = held.Factor();
  ASSERT_TRUE(factor.Factorise(held.lattice.Stiffness(0.3, 0.01)));
  const Eigen::MatrixXd B = held.RightHandSides();
  Eigen::MatrixXd changed = B;
  changed(held.held_components, Eigen::all).array() += 100;
  const Eigen::MatrixXd X = factor.Solve(B);
  EXPECT_LT((factor.Solve(changed) - X).norm(), 1e-12 * X.norm());
}

TEST(FreeComponentFactor, RefusesAMatrixThatIsNotPositiveDefiniteOrNotANumber) {
  const PartlyHeldLattice held;
  FreeComponentFactor factor = held.Factor();
  EXPECT_FALSE(factor.Factorise(held.lattice.Stiffness(0.3, -3)));
  BlockMatrix not_a_number = held.lattice.Stiffness(0.3, 0.01);
  not_a_number.Block(not_a_number.pattern().BlockCount() - 1)
      .setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(factor.Factorise(not_a_number));
  EXPECT_TRUE(factor.Factorise(held.lattice.Stiffness(0.3, 0.01))) << "can be used after a failure";
}

}  // namespace
}  // namespace lacuna
