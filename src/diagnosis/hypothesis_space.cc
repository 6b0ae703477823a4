#include "diagnosis/hypothesis_space.h"

#include <glog/logging.h>

#include <cmath>
#include <numeric>
#include <utility>

namespace lacuna {

HypothesisSpace MakeHypothesisSpace(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns,
                                    std::vector<LinearPrior> priors, Eigen::Index base,
                                    std::vector<WeighedHypothesis> hypotheses, double variance,
                                    Eigen::Index rows) {
  CHECK_EQ(columns.cols(), static_cast<Eigen::Index>(priors.size()));
  CHECK_LE(base, columns.cols());
  Eigen::VectorXd at_means = residual;
  for (Eigen::Index k = 0; k < base; ++k) {
    LinearPrior& prior = priors[static_cast<size_t>(k)];
    if (std::isfinite(prior.deviation)) at_means += prior.mean * columns.col(k);
    prior.mean = 0;
    prior.positive = false;
  }
  HypothesisSpace space;
  space.model =
      LinearGaussianModel::FromProducts(at_means.squaredNorm(), columns.transpose() * at_means,
                                        columns.transpose() * columns, std::move(priors));
  space.variance = variance;
  space.rows = rows;
  space.base.resize(static_cast<size_t>(base));
  std::iota(space.base.begin(), space.base.end(), 0);
  space.hypotheses = std::move(hypotheses);
  return space;
}

}  // namespace lacuna
