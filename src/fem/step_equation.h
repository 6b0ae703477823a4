// The equation of motion of one time step as a function of the unknown positions.
//
// An integrator (time_scheme.h) expresses velocity and acceleration at the end of the step as
// v = γ (x − x̃) and a = γ (v − ṽ), with a rate γ and combinations x̃, ṽ of earlier states. A step is
// then the root of
//   r(x) = M a(x) − Σ f(x, v(x), a(x), t),    ∂r/∂x = γ² M − Σ (∂f/∂x + γ ∂f/∂v + γ² ∂f/∂a),
// summed over the effects, with lumped masses M. r(x) is also the external load that would be
// needed for x to be the motion; the force fit and the diagnosis use it in this sense. Nodal
// vectors are 3n, node-major.
#ifndef LACUNA_FEM_STEP_EQUATION_H_
#define LACUNA_FEM_STEP_EQUATION_H_

#include <Eigen/Core>
#include <vector>

#include "fem/model.h"
#include "fem/time_scheme.h"

namespace lacuna {

// The motion up to the current time. `previous_…` is one step earlier, empty before the second
// step.
struct MotionHistory {
  double time = 0;                     // s
  Eigen::VectorXd position, velocity;  // 3n, m and m/s
  Eigen::VectorXd acceleration;        // 3n, m/s²; empty before the first step
  Eigen::VectorXd previous_position, previous_velocity, previous_acceleration;
  double previous_time_step = 0;              // s; 0: of the same length as the next step
  std::vector<Eigen::VectorXd> effect_state;  // internal variables of each effect of the model
};

// The history of a body at rest in its rest shape at time 0.
MotionHistory RestHistory(const Model& model);

// Immutable. Keeps references to the model and the history, which must outlive it; an EndOfStep
// keeps one to its position vector.
class StepEquation {
 public:
  // The state at the end of the step for given positions. Refers to the position vector.
  struct EndOfStep {
    const Eigen::VectorXd& position;
    Eigen::VectorXd velocity, acceleration;
  };
  // `time_step` > 0 in s, or 0 in statics. CHECKs that the history fits the model.
  StepEquation(const Model& model, const MotionHistory& history, TimeScheme scheme,
               double time_step);

  Eigen::VectorXd Velocity(const Eigen::VectorXd& position) const;
  // r(x) at all nodes, N; at gripped nodes it is the force that the grip exerts on the body.
  // `force_scale`, if given, receives the sum of the Euclidean norms of the terms of r, N, relative
  // to which the size of r is to be judged.
  void Residual(const Eigen::VectorXd& position, Eigen::VectorXd* residual,
                double* force_scale = nullptr) const;
  // Overwrites `tangent` with the symmetric part of ∂r/∂x at all nodes, N/m, or with a positive
  // definite approximation of it if `convexify` is set.
  void Tangent(const Eigen::VectorXd& position, bool convexify, BlockMatrix* tangent) const;
  // Overwrites `tangent` with the skew-symmetric part; returns false if it is zero.
  bool SkewTangent(const Eigen::VectorXd& position, BlockMatrix* tangent) const;
  // The potential whose gradient is r, J: inertial terms plus the potentials of the effects. NaN if
  // an effect has no potential.
  double Potential(const Eigen::VectorXd& position) const;
  // Adds ∂f/∂p of all effects of the model for a parameter p of one of them. Those of the
  // elasticity law, which comes first, may enter other effects too.
  void AddParameterForce(const EndOfStep& end, int effect, int parameter,
                         Eigen::VectorXd* force) const;
  // The history after the step has ended at `position`; advances the internal variables.
  MotionHistory Advance(const Eigen::VectorXd& position) const;

  const Body& body() const { return *model_.body; }
  const Eigen::VectorXd& start_position() const { return history_.position; }
  double end_time() const { return end_time_; }
  double time_step() const { return time_step_; }
  double rate() const { return weights_.rate; }  // γ, 1/s; 0 in statics
  bool has_inertia() const { return inertia_; }
  const SchemeWeights& weights() const { return weights_; }

  EndOfStep End(const Eigen::VectorXd& position) const;
  // The arguments of an effect of the model at the end of the step.
  Kinematics At(const EndOfStep& end, size_t effect) const;

 private:
  TangentWeights Weights() const;

  const Model& model_;
  const MotionHistory& history_;
  bool inertia_ = true;
  double time_step_ = 0;
  double end_time_ = 0;
  SchemeWeights weights_;
  Eigen::VectorXd position_history_, velocity_history_;  // x̃, ṽ
};

}  // namespace lacuna

#endif  // LACUNA_FEM_STEP_EQUATION_H_
