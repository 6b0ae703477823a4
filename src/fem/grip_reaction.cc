#include "fem/grip_reaction.h"

#include <glog/logging.h>

namespace lacuna {

Eigen::MatrixXd SumOverGrips(const Model& model, const std::vector<size_t>& grips,
                             const Eigen::Ref<const Eigen::MatrixXd>& nodal) {
  Eigen::MatrixXd sums =
      Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(grips.size()), nodal.cols());
  for (size_t k = 0; k < grips.size(); ++k) {
    CHECK_LT(grips[k], model.grips.size());
    for (const int node : model.grips[grips[k]].nodes)
      sums.middleRows<3>(3 * static_cast<Eigen::Index>(k)) += nodal.middleRows<3>(3 * node);
  }
  return sums;
}

Eigen::VectorXd GripReactions(const Model& model, const std::vector<size_t>& grips,
                              const StepEquation& equation, const Eigen::VectorXd& position,
                              const Eigen::VectorXd& external_force) {
  Eigen::VectorXd residual;
  equation.Residual(position, &residual);
  if (external_force.size() > 0) residual -= external_force;
  return SumOverGrips(model, grips, residual);
}

}  // namespace lacuna
