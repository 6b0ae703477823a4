#include "fit/active_bounds.h"

#include <Eigen/QR>
#include <cmath>
#include <vector>

namespace lacuna {

double QuadraticCost::GainOf(const Eigen::VectorXd& step) const {
  if (!(cost > 0)) return 0;
  return -(gradient.dot(step) + 0.5 * step.dot(information * step)) / cost;
}

Eigen::VectorXd StepWithin(const QuadraticCost& model, const Eigen::VectorXd& low,
                           const Eigen::VectorXd& high) {
  const Eigen::Index count = model.gradient.size();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(count);
  std::vector<char> at_bound(static_cast<size_t>(count), 0);
  for (Eigen::Index k = 0; k < count; ++k)
    at_bound[k] =
        (low[k] == 0 && model.gradient[k] >= 0) || (high[k] == 0 && model.gradient[k] <= 0);
  // Each round either reaches a bound or releases one at lower cost, so the loop terminates; the
  // limit guards against cycles caused by rounding.
  for (Eigen::Index round = 0; round < 10 * (count + 1); ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < count; ++k)
      if (!at_bound[k]) free.push_back(k);
    Eigen::VectorXd uphill = model.gradient + model.information * step;
    double part = 1;  // fraction of the way to the free minimum before the first bound is reached
    Eigen::Index reached = -1;
    double bound = 0;
    if (!free.empty()) {
      const Eigen::MatrixXd information = model.information(free, free);
      const Eigen::VectorXd slope = uphill(free);
      const Eigen::VectorXd direction = -information.completeOrthogonalDecomposition().solve(slope);
      for (size_t i = 0; i < free.size(); ++i) {
        const double to = direction[static_cast<Eigen::Index>(i)];
        const double limit = (to > 0 ? high : low)[free[i]];
        const double room = std::abs(limit - step[free[i]]);
        if (part * std::abs(to) <= room) continue;
        part = room / std::abs(to);
        reached = free[i];
        bound = limit;
      }
      step(free) += part * direction;
    }
    if (reached >= 0) {
      step[reached] = bound;
      at_bound[reached] = 1;
      continue;
    }
    uphill = model.gradient + model.information * step;
    Eigen::Index released = -1;
    double most = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      const double inwards = step[k] <= low[k] ? -uphill[k] : uphill[k];
      if (!at_bound[k] || low[k] == high[k] || !(inwards > most)) continue;
      most = inwards;
      released = k;
    }
    if (released < 0) break;
    at_bound[released] = 0;
  }
  return step;
}

}  // namespace lacuna
