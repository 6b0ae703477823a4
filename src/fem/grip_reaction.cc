#include "fem/grip_reaction.h"

#include <glog/logging.h>

#include <Eigen/Geometry>

namespace lacuna {
namespace {

// For each node of each grip, the axes along which this grip is the first to hold it.
std::vector<std::vector<AxisSet>> OwnAxes(const Model& model) {
  std::vector<AxisSet> held(static_cast<size_t>(model.body->NodeCount()));
  std::vector<std::vector<AxisSet>> own;
  for (const Grip& grip : model.grips) {
    own.emplace_back();
    for (const int node : grip.nodes) {
      AxisSet& before = held[static_cast<size_t>(node)];
      own.back().push_back(grip.axes.Without(before));
      before = before | grip.axes;
    }
  }
  return own;
}

// 1 for the components of a set, 0 for the others.
Eigen::Vector3d MaskOf(const AxisSet& axes) {
  return {axes.Has(0) ? 1.0 : 0.0, axes.Has(1) ? 1.0 : 0.0, axes.Has(2) ? 1.0 : 0.0};
}

// Calls add(reaction, row, at, mask) for each node of each reaction: the first rows of the reaction
// and of the node, and 1 for the components that the grip holds, 0 for the others.
template <typename Add>
void ForEachNode(const Model& model, const std::vector<Reaction>& reactions, const Add& add) {
  const std::vector<std::vector<AxisSet>> own = OwnAxes(model);
  for (size_t k = 0; k < reactions.size(); ++k) {
    const size_t grip = reactions[k].grip;
    CHECK_LT(grip, model.grips.size());
    const Eigen::VectorXi& nodes = model.grips[grip].nodes;
    for (Eigen::Index i = 0; i < nodes.size(); ++i)
      add(reactions[k], 3 * static_cast<Eigen::Index>(k), 3 * static_cast<Eigen::Index>(nodes[i]),
          MaskOf(own[grip][static_cast<size_t>(i)]));
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
  ForEachNode(
      model, reactions,
      [&](const Reaction& wanted, Eigen::Index row, Eigen::Index at, const Eigen::Vector3d& mask) {
        const Eigen::Vector3d force = mask.cwiseProduct(forces.segment<3>(at));
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
  ForEachNode(
      model, reactions,
      [&](const Reaction& wanted, Eigen::Index row, Eigen::Index at, const Eigen::Vector3d& mask) {
        if (!wanted.about) {
          sums.middleRows<3>(row) += mask.asDiagonal() * forces_by.middleRows<3>(at);
          return;
        }
        const Eigen::Vector3d arm = position.segment<3>(at) - *wanted.about;
        const Eigen::Vector3d force = mask.cwiseProduct(forces.segment<3>(at));
        for (Eigen::Index k = 0; k < sums.cols(); ++k) {
          const Eigen::Vector3d force_by = mask.cwiseProduct(forces_by.block<3, 1>(at, k));
          sums.block<3, 1>(row, k) +=
              arm.cross(force_by) + Eigen::Vector3d(position_by.block<3, 1>(at, k)).cross(force);
        }
      });
  return sums;
}

}  // namespace lacuna
