// The interface of a physical effect, a law that exerts forces on a body.
//
// An effect gives nodal forces f(x, v, a, t; p, z) of the positions x, velocities v, accelerations
// a, the time t, its parameters p and its internal variables z. The motion of a body with lumped
// masses M obeys M a = Σ f + external forces (step_equation.h). The time integrator, the fits and
// the diagnosis know effects through this interface only. A new effect consists of one file in
// src/effects, one line in the catalogue, one test and one entry in a YAML file.
//
// Shapes and units. Nodal vectors have 3·nodes entries, node-major (x₀ y₀ z₀ x₁ …); tangents are
// block matrices on the pattern of the body. All quantities are in SI units.
//
// Output. The functions named Add… add to what the output holds and must not overwrite it, because
// the caller sums over effects. The caller provides outputs of the right size.
//
// Ownership. A Kinematics and everything it refers to are valid during the call only. An effect
// owns its parameters and does not change; WithParameters makes another one. Internal variables
// belong to the caller, so that one effect can serve several simulations at the same time.
//
// Threads. A simulation calls its effects one after another from a single thread. Effects are
// shared by simulations on different threads, so const functions may run concurrently and must not
// change the effect, not even mutable members. Inside a call an effect may use ForEachElement
// (element_schedule.h), whose results do not depend on the number of threads; sums in an arbitrary
// order are not allowed, because results must be reproducible bit by bit.
//
// Failures. An effect does not throw at a configuration that it cannot evaluate; it adds NaN or
// infinity. Newton's method then shortens its step, and the time step fails with a message if that
// does not help. NaN is never a valid force. On the card, a NaN default marks a parameter that the
// user must give, and a NaN null value an effect that cannot be switched off by this parameter.
// Outputs of the wrong size and parameter numbers out of range are programming errors (CHECK).
//
// Example: a uniform lift f_i = a m_i e_z with the acceleration a (m/s²) as its only parameter
// (tests/fem/effect_test.cc).
//   class Lift final : public CloneableEffect<Lift> {
//    public:
//     const EffectCard& Card() const override { return LiftCard(); }
//     Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, a_); }
//     void SetParameters(const Eigen::VectorXd& values) { a_ = values[0]; }  // of a new copy
//     void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
//       force->reshaped(3, at.body.NodeCount()).row(2) += a_ * at.body.node_mass.transpose();
//     }
//     void AddTangents(const Kinematics&, const TangentWeights&, bool,
//                      BlockMatrix*) const override {}
//     void AddParameterDerivative(const Kinematics& at, int,
//                                 Eigen::VectorXd* f) const override {
//       f->reshaped(3, at.body.NodeCount()).row(2) += at.body.node_mass.transpose();
//     }
//    private:
//     double a_ = 0;
//   };
#ifndef LACUNA_FEM_EFFECT_H_
#define LACUNA_FEM_EFFECT_H_

#include <glog/logging.h>

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "fem/block_matrix.h"
#include "fem/body.h"
#include "record/effect_card.h"

namespace lacuna {

class Effect;

// The state of the body at which an effect is evaluated: the end of a time step.
struct Kinematics {
  const Body& body;
  const Eigen::VectorXd& position;      // m
  const Eigen::VectorXd& velocity;      // m/s
  const Eigen::VectorXd& acceleration;  // m/s²; 0 without inertia
  double time = 0;                      // s
  double time_step = 0;  // s; 0: an equilibrium that does not follow an earlier state
  // Internal variables of this effect at the start of the step, StateSize() entries, e.g. viscous
  // strains. Empty for an effect without memory.
  const Eigen::VectorXd& state;
  // The elasticity law of the body at its present parameters, for an effect that is defined
  // relative to that law. Null if the effect is evaluated by itself, without a model.
  const Effect* elasticity = nullptr;
  // Whether the step has inertia. Otherwise the body is in equilibrium at `time`; the length of a
  // quasi-static step then matters for rates and for internal variables only.
  bool has_inertia = false;

  // The kinematics with other internal variables, to which the result refers.
  Kinematics WithState(const Eigen::VectorXd& other) const {
    return {.body = body,
            .position = position,
            .velocity = velocity,
            .acceleration = acceleration,
            .time = time,
            .time_step = time_step,
            .state = other,
            .elasticity = elasticity,
            .has_inertia = has_inertia};
  }
};

// Factors of the derivatives of the force in a tangent. Their units make all three terms N/m.
struct TangentWeights {
  double position = 0;      // factor of ∂f/∂x (N/m), dimensionless
  double velocity = 0;      // factor of ∂f/∂v (N s/m), 1/s
  double acceleration = 0;  // factor of ∂f/∂a (kg), 1/s²
};

class Effect {
 public:
  virtual ~Effect() = default;

  // Name, equation, parameters and look-alikes of the effect. Must exist until the program ends.
  virtual const EffectCard& Card() const = 0;

  // The values of the parameters in the order of the card, SI.
  virtual Eigen::VectorXd Parameters() const = 0;
  // A copy of the effect with other values (cloneable_effect.h). What an effect has derived from
  // the rest shape of its body is shared by its copies where it does not depend on what changes.
  virtual std::shared_ptr<const Effect> WithParameters(const Eigen::VectorXd& values) const = 0;

  // Adds the nodal forces f, N.
  virtual void AddForce(const Kinematics& at, Eigen::VectorXd* force) const = 0;

  // Adds the weighted sum of ∂f/∂x, ∂f/∂v and ∂f/∂a, N/m, or its symmetric part if it is not
  // symmetric. With `convexify`, an indefinite tangent is replaced by a symmetric approximation
  // that is negative semi-definite for weights ≥ 0, as Newton's method needs far from the solution.
  virtual void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                           BlockMatrix* tangent) const = 0;

  // Adds the skew-symmetric part that AddTangents omits. Returns false if the tangent of this
  // effect is always symmetric.
  virtual bool AddSkewTangents(const Kinematics& /*at*/, const TangentWeights& /*weights*/,
                               BlockMatrix* /*tangent*/) const {
    return false;
  }

  // Adds ∂f/∂p at fixed x, v, a and z for the parameter of this number, N per unit of the
  // parameter. Not called for parameters that the card marks as settings.
  virtual void AddParameterDerivative(const Kinematics& at, int parameter,
                                      Eigen::VectorXd* derivative) const = 0;

  // For an effect that is defined relative to the elasticity law of the body (at.elasticity): adds
  // ∂f/∂p of its own force for the parameter p of that number of the law, N per unit of p. The
  // force of most effects does not depend on the law.
  virtual void AddElasticityDerivative(const Kinematics& /*at*/, int /*parameter*/,
                                       Eigen::VectorXd* /*derivative*/) const {}

  // Adds the first Piola–Kirchhoff stress P of the effect at the quadrature points (3 × 3·points,
  // Pa, that of point q in columns 3q to 3q + 2), from which its forces follow as f_a = −Σ w P g_a
  // (point_integrals.h). Returns false, and adds nothing, if the effect is no stress of the
  // material: a load, a support, a mass.
  virtual bool AddStress(const Kinematics& /*at*/, Eigen::Matrix3Xd* /*stress*/) const {
    return false;
  }

  // The potential E with f = −∂E/∂x, J, up to a constant; no value if the force has no potential.
  virtual std::optional<double> Energy(const Kinematics&) const { return std::nullopt; }

  // Internal variables z: their number for a body, their values at rest, and their values at the
  // end of the step that leads to `at`, which depend on the positions, the time step, the
  // parameters and the values at its start. InitialState and AdvanceState overwrite their output.
  // An effect with internal variables must define all functions below; the defaults CHECK that
  // there are none.
  virtual Eigen::Index StateSize(const Body&) const { return 0; }
  virtual void InitialState(const Body& body, Eigen::VectorXd* /*state*/) const {
    CheckHasNoState(body, "InitialState");
  }
  virtual void AdvanceState(const Kinematics& at, Eigen::VectorXd* /*state_at_end*/) const {
    CheckHasNoState(at.body, "AdvanceState");
  }

  // The derivatives of an effect with internal variables; k columns for k directions. At a limit
  // such as that of yield, they belong to the same branch as the tangent of AddTangents. A point
  // that has flowed stands exactly at its limit after the step, so that derivatives of both
  // branches would mix where the next step does not move it.
  //
  // Adds ∂f/∂z · changes (state × k) to `forces` (3n × k, N).
  virtual void AddStateDerivatives(const Kinematics& at,
                                   const Eigen::Ref<const Eigen::MatrixXd>& /*changes*/,
                                   Eigen::Ref<Eigen::MatrixXd> /*forces*/) const {
    CheckHasNoState(at.body, "AddStateDerivatives");
  }
  // Replaces changes of z at the start of the step (state × k) by those at its end, where the
  // positions at its end change by `moved` (3n × k, m).
  virtual void AdvanceStateDerivatives(const Kinematics& at,
                                       const Eigen::Ref<const Eigen::MatrixXd>& /*moved*/,
                                       Eigen::Ref<Eigen::MatrixXd> /*changes*/) const {
    CheckHasNoState(at.body, "AdvanceStateDerivatives");
  }
  // Adds ∂z/∂p at the end of the step, at fixed positions and fixed z at its start, for the
  // parameter of this number, per unit of the parameter. Not called for settings.
  virtual void AddStateByParameter(const Kinematics& at, int /*parameter*/,
                                   Eigen::Ref<Eigen::VectorXd> /*change*/) const {
    CheckHasNoState(at.body, "AddStateByParameter");
  }

 private:
  void CheckHasNoState(const Body& body, const char* function) const {
    CHECK_EQ(StateSize(body), 0) << Card().type << " has internal variables, but no " << function;
  }
};

}  // namespace lacuna

#endif  // LACUNA_FEM_EFFECT_H_
