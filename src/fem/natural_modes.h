// Natural frequencies and mode shapes of a body about a configuration.
//
// K φ = ω² M φ for the free components, with the tangent stiffness K of the effects, the symmetric
// part of −∂f/∂x (Effect::AddTangents), and the lumped masses M of the body, without the inertia
// that effects add. The skew-symmetric part of loads that turn with the body is neglected, so that
// flutter is not found. The modes are computed by subspace iteration with (K + σM)⁻¹ M and
// Rayleigh–Ritz (Bathe & Wilson, Numerical Methods in Finite Element Analysis, 1976); the positive
// shift σ, small against the wanted ω², admits bodies that can move as rigid bodies. Damping and
// internal variables are ignored.
#ifndef LACUNA_FEM_NATURAL_MODES_H_
#define LACUNA_FEM_NATURAL_MODES_H_

#include <Eigen/Core>
#include <string>

#include "fem/model.h"

namespace lacuna {

struct NaturalModes {
  std::string message;          // why there are none; empty: the modes were found
  Eigen::VectorXd frequencies;  // Hz, ascending; those of rigid motions are 0 up to rounding
  Eigen::MatrixXd shapes;       // 3n × modes, φᵀMφ = I
  int iterations = 0;
  bool IsUsable() const { return message.empty(); }
};

// The `count` lowest modes about `position` (3n, m), where K must be positive semi-definite. CHECKs
// that the body has more than `count` free components.
NaturalModes FindNaturalModes(const Model& model, const Eigen::VectorXd& position, int count);

}  // namespace lacuna

#endif  // LACUNA_FEM_NATURAL_MODES_H_
