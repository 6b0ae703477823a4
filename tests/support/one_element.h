// The smallest body: what an effect of strain alone does at one deformation gradient.
#ifndef LACUNA_SUPPORT_ONE_ELEMENT_H_
#define LACUNA_SUPPORT_ONE_ELEMENT_H_

#include <Eigen/Core>

#include "fem/effect.h"

namespace lacuna {

// One tetrahedron with the deformation gradient F: forces on its four nodes, energy and stress.
struct OneElement {
  Body body = MakeBody(
      {.nodes = Eigen::Matrix3Xd{{0, 0.03, 0, 0.005}, {0, 0, 0.02, 0.004}, {0, 0.002, 0, 0.025}},
       .tets = Eigen::Vector4i(0, 1, 2, 3)},
      1000);
  double time = 0;
  const Effect* elasticity = nullptr;  // of the body, for effects that refer to it
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(12), state;

  Eigen::VectorXd Position(const Eigen::Matrix3d& F) const {
    return (F * body.mesh.nodes).reshaped();
  }
  Eigen::VectorXd Force(const Effect& effect, const Eigen::Matrix3d& F) const {
    const Eigen::VectorXd position = Position(F);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(12);
    effect.AddForce({body, position, velocity, velocity, time, 0, state, elasticity}, &force);
    return force;
  }
  double Energy(const Effect& effect, const Eigen::Matrix3d& F) const {
    const Eigen::VectorXd position = Position(F);
    return *effect.Energy({body, position, velocity, velocity, time, 0, state, elasticity});
  }
  // P from nodal forces: with f_a = −V P g_a and Σ_a g_a X_aᵀ = I, P = −Σ f_a X_aᵀ / V.
  Eigen::Matrix3d Stress(const Effect& effect, const Eigen::Matrix3d& F) const {
    return -Force(effect, F).reshaped(3, 4) * body.mesh.nodes.transpose() / body.weight.sum();
  }
};

}  // namespace lacuna

#endif  // LACUNA_SUPPORT_ONE_ELEMENT_H_
