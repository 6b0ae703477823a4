// Stress and stretch at the nodes of a deformed body, recovered from the quadrature points.
//
// The stress is the sum over the effects that are a stress of the material (Effect::AddStress),
// elastic and inelastic, as Cauchy's tensor σ = P Fᵀ / det F. σ and F are known at the quadrature
// points. In a quadratic element they are extrapolated to the corners by the linear function
// through its four points, and a midpoint gets the mean of the ends of its edge; in a linear
// element they are constant. The value of a node is the mean over its elements, weighted by volume
// (Zienkiewicz & Taylor, The Finite Element Method, vol. 1, on nodal averaging). Where materials or
// edges make the true stress discontinuous or infinite, as at the rim of a clamp, the value depends
// on the mesh and does not converge.
#ifndef LACUNA_FEM_NODAL_RECOVERY_H_
#define LACUNA_FEM_NODAL_RECOVERY_H_

#include <Eigen/Core>
#include <vector>

#include "fem/model.h"

namespace lacuna {

struct NodalStress {
  Eigen::MatrixXd cauchy;     // 6 × n, Pa: xx, yy, zz, yz, xz, xy
  Eigen::VectorXd von_mises;  // n, Pa: of the nodal tensor
  Eigen::Matrix3Xd stretch;   // 3 × n: principal stretches, the largest first
};

// The stresses and stretches at `position` and `velocity` (3n, node-major, m and m/s) at `time`
// (s), with the internal variables of each effect of the model there, at the end of the step that
// led to this state. Values are not finite where a law cannot be evaluated.
NodalStress RecoverNodalStress(const Model& model, const Eigen::VectorXd& position,
                               const Eigen::VectorXd& velocity, double time,
                               const std::vector<Eigen::VectorXd>& effect_state);

// √(3/2 s:s) with the deviator s of a symmetric tensor: xx, yy, zz, yz, xz, xy.
double VonMises(const Eigen::Matrix<double, 6, 1>& stress);

// Values at the quadrature points (k × points) as values at the nodes (k × n), as described above.
Eigen::MatrixXd RecoverAtNodes(const Body& body, const Eigen::MatrixXd& at_points);

}  // namespace lacuna

#endif  // LACUNA_FEM_NODAL_RECOVERY_H_
