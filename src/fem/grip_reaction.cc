#include "fem/grip_reaction.h"

#include <glog/logging.h>

#include <Eigen/Geometry>

namespace lacuna {
namespace {

// Calls add(rows, node) for each node of each reaction, with the first row of the reaction.
template <typename Add>
void ForEachNode(const Model& model, const std::vector<Reaction>& reactions, const Add& add) {
  for (size_t k = 0; k < reactions.size(); ++k) {
    CHECK_LT(reactions[k].grip, model.grips.size());
    for (const int node : model.grips[reactions[k].grip].nodes)
      add(reactions[k], 3 * static_cast<Eigen::Index>(k), 3 * static_cast<Eigen::Index>(node));
  }
}

}  // namespace

Eigen::VectorXd NodalReactions(const StepEquation& equation, const Eigen::VectorXd& position,
                               const Eigen::VectorXd& external_force) {
  Eigen::VectorXd residual;
  equation.Residual(position, &residual);
  if (external_force.size() > 0) residual -= external_force;
  return residual;
}

Eigen::VectorXd SumReactions(const Model& model, const std::vector<Reaction>& reactions,
                             const Eigen::VectorXd& position, const Eigen::VectorXd& forces) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(reactions.size()));
  ForEachNode(model, reactions, [&](const Reaction& wanted, Eigen::Index row, Eigen::Index at) {
    const Eigen::Vector3d force = forces.segment<3>(at);
    if (!wanted.about)
      sums.segment<3>(row) += force;
    else
      sums.segment<3>(row) += (position.segment<3>(at) - *wanted.about).cross(force);
  });
  return sums;
}

Eigen::MatrixXd SumReactionChanges(const Model& model, const std::vector<Reaction>& reactions,
                                   const Eigen::VectorXd& position, const Eigen::VectorXd& forces,
                                   const Eigen::MatrixXd& position_by,
                                   const Eigen::MatrixXd& forces_by) {
  Eigen::MatrixXd sums =
      Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(reactions.size()), forces_by.cols());
  ForEachNode(model, reactions, [&](const Reaction& wanted, Eigen::Index row, Eigen::Index at) {
    if (!wanted.about) {
      sums.middleRows<3>(row) += forces_by.middleRows<3>(at);
      return;
    }
    const Eigen::Vector3d arm = position.segment<3>(at) - *wanted.about;
    const Eigen::Vector3d force = forces.segment<3>(at);
    for (Eigen::Index k = 0; k < sums.cols(); ++k)
      sums.block<3, 1>(row, k) += arm.cross(Eigen::Vector3d(forces_by.block<3, 1>(at, k))) +
                                  Eigen::Vector3d(position_by.block<3, 1>(at, k)).cross(force);
  });
  return sums;
}

}  // namespace lacuna
