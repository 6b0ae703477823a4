#include "fem/free_component_factor.h"

#include <utility>

namespace lacuna {

FreeComponentFactor::FreeComponentFactor(const BlockPattern& pattern, HeldComponents held)
    : held_(std::move(held)),
      order_(NestedDissection(pattern, held_.whole_nodes())),
      factor_(pattern, order_) {}

bool FreeComponentFactor::Factorise(const BlockMatrix& A) {
  return factor_.Factorise(held_.Decoupled(A));
}

Eigen::MatrixXd FreeComponentFactor::Solve(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd ordered(3 * order_.FreeNodes(), B.cols()), solution;
  for (int i = 0; i < order_.FreeNodes(); ++i)
    ordered.middleRows<3>(3 * i) = B.middleRows<3>(3 * order_.node[i]);
  factor_.Solve(ordered, &solution);
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(B.rows(), B.cols());
  for (int i = 0; i < order_.FreeNodes(); ++i)
    X.middleRows<3>(3 * order_.node[i]) = solution.middleRows<3>(3 * i);
  held_.ClearIn(X);
  return X;
}

}  // namespace lacuna
