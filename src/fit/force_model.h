// The external forces that a fit may use to explain the motion.
//
// The force model is part of the hypothesis: forces that can act anywhere explain any motion,
// whereas forces on a known footprint can reveal that the physics of the model is wrong. For the
// fit every force model has the same form: some nodes carry no unknown force, at others the three
// force components are unknown, and a basis of few force fields may be added. Nodal vectors are 3n,
// node-major.
#ifndef LACUNA_FIT_FORCE_MODEL_H_
#define LACUNA_FIT_FORCE_MODEL_H_

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "fem/body.h"

namespace lacuna {

struct ForceModel {
  // n flags: node i carries an unknown force of its own.
  std::vector<char> free;
  // 3n × K, N: column k is the force field of coefficient k. The prior of each coefficient is the
  // standard normal distribution, so coefficients are of order 1. K may be 0.
  Eigen::SparseMatrix<double, Eigen::RowMajor> basis;

  Eigen::Index CoefficientCount() const { return basis.cols(); }
  bool HasFreeNodes() const;
  bool HasUnknowns() const { return CoefficientCount() > 0 || HasFreeNodes(); }
};

// No unknown forces: the effects and the grips alone must explain the motion.
ForceModel NoForces(const Body& body);

// An unknown force at each of `nodes`.
ForceModel FreeForces(const Body& body, const Eigen::VectorXi& nodes);

// One unknown total force, for a contact with a known footprint. It is distributed over `nodes` by
// BoundaryShares (fem/prescribed_force.h). Three coefficients with prior deviation `force_scale`,
// N.
ForceModel FootprintForce(const Body& body, const Eigen::VectorXi& nodes, double force_scale);

// One unknown force at each of `nodes`, with three coefficients of prior deviation `force_scale`
// (N) each. Unlike FreeForces, this needs few nodes and has a prior in newtons.
ForceModel NodalForces(const Body& body, const Eigen::VectorXi& nodes, double force_scale);

// A smooth traction field over the boundary vertices among `nodes`: a Gaussian random field of
// standard deviation `traction_scale` (Pa) and covariance exp(−d²/(2 ℓ²)) with ℓ = `length` (m).
// Its basis is the pivoted Cholesky factor of the covariance, truncated at 0.1 % of the variance.
ForceModel SmoothForces(const Body& body, const Eigen::VectorXi& nodes, double length,
                        double traction_scale);

// The subspace of a force model whose net force and net torque about the body's centre are zero
// (Transue & Choi 2015, section 10, report a drift of both). CHECKs that there are no free nodes,
// because the restriction would make the matrix of their forces dense.
ForceModel HoldNetForceAndTorque(const Body& body, const ForceModel& model);

// The net force (N) and the net torque about `centre` (N m) of nodal forces (3n, N) that act at the
// positions (3n, m).
struct NetForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};
NetForce NetForceOf(const Eigen::VectorXd& nodal_force, const Eigen::VectorXd& position,
                    const Eigen::Vector3d& centre);

// The standard deviation of each component of the net force, N, if the coefficients have the given
// covariance (K × K).
Eigen::Vector3d NetForceDeviation(const ForceModel& model, const Eigen::MatrixXd& covariance);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_MODEL_H_
