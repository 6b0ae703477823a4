// Base class of effects that add mass to a body, and with it inertia and weight:
//   f_i = θ μ_i (g − a_i)   (I. Newton, Philosophiæ Naturalis Principia Mathematica, 1687),
// with the size θ of the effect, a field μ over the nodes (kg per unit of θ, of either sign), the
// acceleration of free fall g (m/s²) and the accelerations a of the nodes (m/s²).
//
// A derived class gives the field and its derivatives; the card must begin with θ and end with the
// setting `gravity`. The field is kept for each mesh on which the effect acts (rest_quantity.h), so
// that the effect may be used by several threads.
#ifndef LACUNA_EFFECTS_ADDED_MASS_H_
#define LACUNA_EFFECTS_ADDED_MASS_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "effects/rest_quantity.h"
#include "fem/effect.h"

namespace lacuna {

class AddedMass : public Effect {
 public:
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override;

  // With `convexify`, nodes with θ μ_i < 0 contribute nothing.
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override;

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override;

  // The potential energy of the weight, J; nothing in a step with inertia, which has no potential.
  std::optional<double> Energy(const Kinematics& at) const override;

  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values);

 protected:
  // μ at each node (n), kg per unit of θ. It may depend on the body at rest and on all parameters
  // but θ; it is computed again when one of those changes.
  virtual Eigen::VectorXd MassPerUnit(const Body& body) const = 0;

  // ∂μ/∂(parameter) at each node (n), for a parameter that is not a setting; `mass`: μ. The default
  // is for classes all of whose other parameters are settings: it must not be called (LOG(FATAL)).
  virtual Eigen::VectorXd MassPerUnitDerivative(const Body& body, int parameter,
                                                const Eigen::VectorXd& mass) const;

  // The size θ on a body: the first parameter, unless its zero depends on the body.
  virtual double Size(const Body& body) const;

  // Parameter values in the order of the card, SI: θ first, the three components of g last.
  Eigen::VectorXd parameters_;

 private:
  Eigen::Vector3d Gravity() const { return parameters_.tail<3>(); }
  std::shared_ptr<const Eigen::VectorXd> Mass(const Body& body) const;
  void AddScaledForce(const Kinematics& at, double size, const Eigen::VectorXd& mass,
                      Eigen::VectorXd* force) const;

  RestQuantity<Eigen::VectorXd> mass_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_ADDED_MASS_H_
