// The forces that grips exert on a body.
//
// At a gripped node i the equation of motion is not solved; its residual
//   r_i = m_i a_i − Σ f_i                                     (step_equation.h)
// is the force that the grip exerts on the node, beside any external force there. The reaction of a
// grip is the sum of these forces over its nodes: three rows x, y, z, N.
#ifndef LACUNA_FEM_GRIP_REACTION_H_
#define LACUNA_FEM_GRIP_REACTION_H_

#include <Eigen/Core>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

// The sums of nodal vectors (3n × k) over the nodes of grips, given by their indices in
// Model::grips: 3·grips × k.
Eigen::MatrixXd SumOverGrips(const Model& model, const std::vector<size_t>& grips,
                             const Eigen::Ref<const Eigen::MatrixXd>& nodal);

// The reactions of grips, 3·grips × 1, N, at the end of a step at `position` (3n) under an external
// nodal force (3n, N; empty: none). NaN where an effect cannot be evaluated.
Eigen::VectorXd GripReactions(const Model& model, const std::vector<size_t>& grips,
                              const StepEquation& equation, const Eigen::VectorXd& position,
                              const Eigen::VectorXd& external_force);

}  // namespace lacuna

#endif  // LACUNA_FEM_GRIP_REACTION_H_
