#include "diagnosis/marginal_nuisances.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

namespace lacuna {
namespace {

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// The model with explicit amounts: r + J x + N a, with a row (a − m)/s for each prior.
struct Explicit {
  Eigen::MatrixXd columns;
  Eigen::VectorXd residual;
  Explicit(const Eigen::VectorXd& r, const Eigen::MatrixXd& J, const Eigen::MatrixXd& N,
           const std::vector<LinearPrior>& priors)
      : columns(Eigen::MatrixXd::Zero(r.size() + N.cols(), J.cols() + N.cols())),
        residual(columns.rows()) {
    columns.topLeftCorner(r.size(), J.cols()) = J;
    columns.topRightCorner(r.size(), N.cols()) = N;
    residual.head(r.size()) = r;
    for (Eigen::Index k = 0; k < N.cols(); ++k) {
      columns(r.size() + k, J.cols() + k) = 1 / priors[k].deviation;
      residual[r.size() + k] = -priors[k].mean / priors[k].deviation;
    }
  }
};

TEST(MarginalNuisances, AFitFindsTheSameParametersWithTheSameCovariance) {
  const Eigen::Index rows = 40, parameters = 3;
  const Eigen::VectorXd residual = Random(rows, 1, 1);
  const Eigen::MatrixXd jacobian = Random(rows, parameters, 2);
  Eigen::MatrixXd columns = Random(rows, 5, 3);
  columns.col(4) = columns.col(0);  // a direction that occurs twice
  columns.col(3) *= 1e-9;           // one that changes nothing
  const std::vector<LinearPrior> priors = {
      {0, 1, false}, {0.5, 0.2, false}, {-1, 30, false}, {0, 2, false}, {0, 0.3, false}};
  const Explicit all(residual, jacobian, columns, priors);
  const Eigen::VectorXd best = -all.columns.householderQr().solve(all.residual);

  const MarginalNuisances nuisances(columns, priors);
  const Eigen::VectorXd left = nuisances.OfResidual(residual);
  const Eigen::MatrixXd by = nuisances.OfDerivatives(jacobian);
  const Eigen::VectorXd change = -by.householderQr().solve(left);
  EXPECT_LT((change - best.head(parameters)).norm(), 1e-9);
  EXPECT_NEAR((left + by * change).squaredNorm(), (all.residual + all.columns * best).squaredNorm(),
              1e-9);
  const Eigen::MatrixXd covariance = (all.columns.transpose() * all.columns).inverse();
  EXPECT_LT(
      ((by.transpose() * by).inverse() - covariance.topLeftCorner(parameters, parameters)).norm(),
      1e-9);
  const Eigen::VectorXd amounts = nuisances.BestAmounts(residual + jacobian * change);
  EXPECT_LT((amounts - best.tail(columns.cols())).norm(), 1e-9);
}

TEST(MarginalNuisances, WithoutNuisancesNothingChanges) {
  const Eigen::VectorXd residual = Random(6, 1, 1);
  const MarginalNuisances none(Eigen::MatrixXd(6, 0), {});
  EXPECT_EQ(none.OfResidual(residual), residual);
  EXPECT_EQ(none.OfDerivatives(residual), residual);
  EXPECT_EQ(none.BestAmounts(residual).size(), 0);
}

}  // namespace
}  // namespace lacuna
