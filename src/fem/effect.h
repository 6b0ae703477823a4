// A physical effect: a law that puts forces on a body. Everything the model can do, and everything
// it may lack, is one of these; the time integrator, the fit and the diagnosis see nothing else.
//
// A new effect is one file in src/effects, one line in the catalogue, one test, one YAML entry.
#ifndef LACUNA_FEM_EFFECT_H_
#define LACUNA_FEM_EFFECT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "fem/block_matrix.h"
#include "fem/body.h"
#include "record/effect_card.h"

namespace lacuna {

// What an effect may look at. Vectors have length 3·nodes, node-major, SI.
struct Kinematics {
  const Body& body;
  const Eigen::VectorXd& position;      // m
  const Eigen::VectorXd& velocity;      // m/s
  const Eigen::VectorXd& acceleration;  // m/s², for effects that add inertia; 0 in statics
  double time = 0;                      // s
  double time_step = 0;                 // s; 0: statics
  // Internal variables of this effect at the start of the step (StateSize() long), e.g. viscous
  // strains; empty for an effect without memory.
  const Eigen::VectorXd& state;
};

// How much of each of an effect's derivatives is asked for.
struct TangentWeights {
  double position = 0;      // of ∂f/∂x, N/m
  double velocity = 0;      // of ∂f/∂v, N s/m
  double acceleration = 0;  // of ∂f/∂a, kg
};

class Effect {
 public:
  virtual ~Effect() = default;

  virtual const EffectCard& Card() const = 0;

  // Values in the order of the card's parameters, SI.
  virtual Eigen::VectorXd Parameters() const = 0;
  // A copy of the effect with other values. Effects do not change: models that are fitted, refitted
  // and predicted side by side share them. What an effect has derived from the rest shape of its
  // body is shared by its copies as long as it does not depend on what changes
  // (cloneable_effect.h).
  virtual std::shared_ptr<const Effect> WithParameters(const Eigen::VectorXd& values) const = 0;

  // Adds the effect's nodal forces, N.
  virtual void AddForce(const Kinematics& at, Eigen::VectorXd* force) const = 0;

  // Adds the weighted sum of ∂f/∂x, ∂f/∂v and ∂f/∂a; of a matrix that is not symmetric, the
  // symmetric part. For an effect whose exact tangent is indefinite, `convexify` asks for a
  // symmetric negative semi-definite stand-in (for weights ≥ 0).
  virtual void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                           BlockMatrix* tangent) const = 0;

  // Adds the skew-symmetric part that AddTangents leaves out. Returns whether there may be any.
  virtual bool AddSkewTangents(const Kinematics& /*at*/, const TangentWeights& /*weights*/,
                               BlockMatrix* /*tangent*/) const {
    return false;
  }

  // Adds ∂f/∂(parameter), N per unit of the parameter; never asked for a setting.
  virtual void AddParameterDerivative(const Kinematics& at, int parameter,
                                      Eigen::VectorXd* derivative) const = 0;

  // Stored energy E with f = −∂E/∂x, J; nothing where the force has no potential.
  virtual std::optional<double> Energy(const Kinematics&) const { return std::nullopt; }

  // Memory: its length for a body, its value at rest, and its value at the end of a step, with
  // `parameters` in place of the effect's own, as its derivatives by them are differences.
  virtual Eigen::Index StateSize(const Body&) const { return 0; }
  virtual void InitialState(const Body&, Eigen::VectorXd* /*state*/) const {}
  virtual void AdvanceState(const Kinematics&, const Eigen::VectorXd& /*parameters*/,
                            Eigen::VectorXd* /*state_at_end*/) const {}
};

}  // namespace lacuna

#endif  // LACUNA_FEM_EFFECT_H_
