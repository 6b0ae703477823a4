// A base class for effects that change the natural (stress-free) shape of the material, such as
// swelling or thermal expansion. The prescribed strain does not depend on the elastic moduli. Such
// an effect evaluates the elasticity law of the body in the state that the material would have
// relative to its new natural shape, the elastic part, and adds the difference from the law in the
// actual state,
//   E = e E_el(elastic part) − E_el(x),   f = s f_el(elastic part) − f_el(x),
//   ∂f/∂x = k K_el(elastic part) − K_el(x),   P = λ² P_el(F/λ) − P_el(F),
// with the energy E_el, the force f_el, its derivative K_el = ∂f_el/∂x and the first
// Piola–Kirchhoff stress P_el of the law, and with the free stretch λ of the material, the same in
// all directions. A model may contain one such effect only, because two of these differences do not
// add up to that of the product of the stretches; their cards exclude each other
// (EffectCard::excludes).
#ifndef LACUNA_EFFECTS_FREE_STRAIN_H_
#define LACUNA_EFFECTS_FREE_STRAIN_H_

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "fem/effect.h"

namespace lacuna {

// A derived class gives the card, the parameters, the derivative with respect to the strain, and
// the three functions HasNoStrain, WithElasticPart and Stretches.
class FreeStrain : public Effect {
 public:
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const final;
  // Adds nothing with `convexify`: the law's own approximation stands for both.
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const final;
  void AddElasticityDerivative(const Kinematics& at, int parameter,
                               Eigen::VectorXd* derivative) const final;
  bool AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const final;
  std::optional<double> Energy(const Kinematics& at) const final;

 protected:
  struct ElasticPart {
    const Kinematics& state;    // as the law sees it
    double force_factor = 1;    // s, also of the derivatives with respect to the law's parameters
    double tangent_factor = 1;  // k
    double energy_factor = 1;   // e
  };

  // Whether the effect adds nothing, because its strain is zero everywhere.
  virtual bool HasNoStrain() const = 0;
  // Calls `use` once with the elastic part of the state, which lives as long as the call.
  virtual void WithElasticPart(const Kinematics& at,
                               const std::function<void(const ElasticPart&)>& use) const = 0;
  // λ at each quadrature point.
  virtual Eigen::VectorXd Stretches(const Body& body) const = 0;

  // CHECKs that there is a law.
  static const Effect& Law(const Kinematics& at);
  // The state with another body of the same mesh and other positions (3n, m), which must outlive
  // it. Elasticity laws have no memory and do not depend on velocities.
  static Kinematics AsSeenByLaw(const Kinematics& at, const Body& body,
                                const Eigen::VectorXd& position);
  // Adds factor · f_el − K_el x, both in `state`, where x are the positions of `at`.
  static void AddForceAndStiffness(const Kinematics& at, const Kinematics& state, double factor,
                                   Eigen::VectorXd* result);

 private:
  using AddOfLaw = std::function<void(const Kinematics& state, Eigen::VectorXd* of_law)>;
  void AddDifference(const Kinematics& at, const AddOfLaw& add, Eigen::VectorXd* result) const;
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_FREE_STRAIN_H_
