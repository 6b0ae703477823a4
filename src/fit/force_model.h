// Which external forces a fit may use to explain the motion.
//
// The force model is part of the hypothesis: forces that span everything observed explain anything,
// forces on a known footprint leave room for physics to be wrong. Every model is the same thing to
// the fit: nodes that carry no unknown force, nodes whose three force components are unknown, and a
// low-dimensional basis of force fields.
#ifndef LACUNA_FIT_FORCE_MODEL_H_
#define LACUNA_FIT_FORCE_MODEL_H_

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "fem/body.h"

namespace lacuna {

struct ForceModel {
  // n: node i carries an unknown force of its own.
  std::vector<char> free;
  // 3n × K: force field of a coefficient, N. A coefficient is expected to be of order 1: its prior
  // is a standard normal distribution. K may be 0.
  Eigen::SparseMatrix<double, Eigen::RowMajor> basis;

  Eigen::Index CoefficientCount() const { return basis.cols(); }
  bool HasUnknowns() const;
};

// No unknown forces: the effects and grips must explain the motion.
ForceModel NoForces(const Body& body);

// An unknown force at each of `nodes`.
ForceModel FreeForces(const Body& body, const Eigen::VectorXi& nodes);

// One unknown total force, shared by `nodes` in proportion to the boundary area around them (three
// coefficients, each of `force_scale`, N): a contact whose footprint is known.
ForceModel FootprintForce(const Body& body, const Eigen::VectorXi& nodes, double force_scale);

// One force of its own at each of `nodes` (three coefficients each, of `force_scale`, N): as
// FreeForces, but few enough to be coefficients, and with a prior in newtons.
ForceModel NodalForces(const Body& body, const Eigen::VectorXi& nodes, double force_scale);

// A smooth traction field over the boundary vertices among `nodes`: a Gaussian random field of
// standard deviation `traction_scale` (Pa) and correlation length `length` (m), spanned by the
// pivoted Cholesky factor of its covariance up to 0.1 % of the variance.
ForceModel SmoothForces(const Body& body, const Eigen::VectorXi& nodes, double length,
                        double traction_scale);

// The same model without the fields that push or turn the body as a whole: net force and net torque
// about the body's centre are held at zero (section 10 of Transue & Choi 2015 reports their drift).
// Models with free nodes cannot be so restricted without filling the matrix; CHECKs that there are
// none.
ForceModel HoldNetForceAndTorque(const Body& body, const ForceModel& model);

// Net force (N) and net torque (N m) about `centre` of nodal forces (3n) at positions (3n).
struct NetForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};
NetForce NetForceOf(const Eigen::VectorXd& nodal_force, const Eigen::VectorXd& position,
                    const Eigen::Vector3d& centre);

// Standard deviation of each component of the net force (N) of coefficients with this covariance
// (K × K).
Eigen::Vector3d NetForceDeviation(const ForceModel& model, const Eigen::MatrixXd& covariance);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_MODEL_H_
