// What effects share that add mass to a body, and so inertia and weight:
//   f_i = θ μ_i (g − a_i),
// with a size θ, a field μ ≥ 0 or of either sign over the nodes, the acceleration of free fall g
// and the nodes' accelerations a.
#ifndef LACUNA_EFFECTS_ADDED_MASS_H_
#define LACUNA_EFFECTS_ADDED_MASS_H_

#include <Eigen/Core>
#include <optional>

#include "effects/rest_quantity.h"
#include "fem/effect.h"

namespace lacuna {

class AddedMass : public Effect {
 public:
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override;

  // Where θ μ_i < 0, the stand-in leaves out what is indefinite.
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override;

  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override;

  // In statics, where inertia is silent: that of the weight.
  std::optional<double> Energy(const Kinematics& at) const override;

  Eigen::VectorXd Parameters() const override { return parameters_; }
  void SetParameters(const Eigen::VectorXd& values);

 protected:
  // μ: kg per unit of θ at each node (n), from the other parameters and the body at rest.
  virtual Eigen::VectorXd MassPerUnit(const Body& body) const = 0;

  // ∂μ/∂(parameter), of those that are no settings; `mass`: μ.
  virtual Eigen::VectorXd MassPerUnitBy(const Body& body, int parameter,
                                        const Eigen::VectorXd& mass) const;

  // In the order of the card: θ first, the three components of g last.
  Eigen::VectorXd parameters_;

 private:
  double Size() const { return parameters_[0]; }
  Eigen::Vector3d Gravity() const { return parameters_.tail<3>(); }
  std::shared_ptr<const Eigen::VectorXd> Mass(const Body& body) const;
  void AddScaledForce(const Kinematics& at, double size, const Eigen::VectorXd& mass,
                      Eigen::VectorXd* force) const;

  RestQuantity<Eigen::VectorXd> mass_;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_ADDED_MASS_H_
