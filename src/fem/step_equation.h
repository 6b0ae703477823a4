// The equation of motion of one time step, as a function of the unknown positions alone.
//
// An integrator (time_scheme.h) writes velocity and acceleration at the end of the step as
// v = γ (x − x̃) and a = γ (v − ṽ), with a rate γ and combinations x̃, ṽ of earlier states,
// so that a step is the root of
//   r(x) = M a(x) − Σ f_effect(x, v(x), t)          and          ∂r/∂x = γ² M − Σ (∂f/∂x + γ
//   ∂f/∂v).
// r(x) is also the force that would have to act from outside for x to be the motion: what the
// force fit estimates and what the diagnosis reads.
#ifndef LACUNA_FEM_STEP_EQUATION_H_
#define LACUNA_FEM_STEP_EQUATION_H_

#include <Eigen/Core>
#include <vector>

#include "fem/model.h"
#include "fem/time_scheme.h"

namespace lacuna {

// The motion up to now. `previous_*` is one step earlier, empty before the second step.
struct MotionHistory {
  double time = 0;                     // s
  Eigen::VectorXd position, velocity;  // 3n
  Eigen::VectorXd acceleration;        // 3n; empty before the first step
  Eigen::VectorXd previous_position, previous_velocity, previous_acceleration;
  double previous_time_step = 0;              // s; 0: as long as the next one
  std::vector<Eigen::VectorXd> effect_state;  // one per effect of the model
};
// At rest in the rest shape, at time 0.
MotionHistory RestHistory(const Model& model);

class StepEquation {
 public:
  // The motion that the end of the step at `position` means. Refers to that vector.
  struct EndOfStep {
    const Eigen::VectorXd& position;
    Eigen::VectorXd velocity, acceleration;
  };
  // `time_step` > 0, or 0 for statics. The model and the history must outlive the equation.
  StepEquation(const Model& model, const MotionHistory& history, TimeScheme scheme,
               double time_step);

  Eigen::VectorXd Velocity(const Eigen::VectorXd& position) const;
  // r(x), N, at all nodes (at gripped nodes: the reaction of the grip with a minus sign removed,
  // i.e. the force the grip exerts). `force_scale`, where asked for, becomes the sum of the
  // Euclidean norms of the terms of r, N: what "small" is to be measured by.
  void Residual(const Eigen::VectorXd& position, Eigen::VectorXd* residual,
                double* force_scale = nullptr) const;
  // The symmetric part of ∂r/∂x, N/m, at all nodes (overwrites `tangent`).
  void Tangent(const Eigen::VectorXd& position, bool convexify, BlockMatrix* tangent) const;
  // Its skew-symmetric part; false: there is none.
  bool SkewTangent(const Eigen::VectorXd& position, BlockMatrix* tangent) const;
  // ∂r/∂(parameter k of effect j), N per unit (overwrites `derivative`).
  void ParameterDerivative(const Eigen::VectorXd& position, int effect, int parameter,
                           Eigen::VectorXd* derivative) const;
  // Inertial plus stored energy whose gradient r is, where all effects have one; used by the line
  // search. NaN otherwise.
  double Potential(const Eigen::VectorXd& position) const;
  // The history after the step ended at `position`.
  MotionHistory Advance(const Eigen::VectorXd& position) const;

  const Body& body() const { return *model_.body; }
  double end_time() const { return end_time_; }
  double time_step() const { return time_step_; }
  double rate() const { return weights_.rate; }  // γ, 1/s; 0 in statics
  bool has_inertia() const { return inertia_; }
  const SchemeWeights& weights() const { return weights_; }

  EndOfStep End(const Eigen::VectorXd& position) const;
  // What an effect of the model sees there.
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
