// A stiffness that varies in space: an extra Young's modulus ΔE (Pa), weighted by a function w of
// the place X in the rest shape, in addition to the elasticity law of the body:
//   ψ = w(X) ψ_nH(F; ΔE, ν), J/m³,
// with the neo-Hookean energy ψ_nH (neo_hookean_energy.h), which is proportional to E. A
// neo-Hookean body with this effect therefore has Young's modulus E + w ΔE if Poisson's ratios
// agree; for other elasticity laws that holds at small strain. F refers to the rest shape, also in
// a body that swells (free_strain.h).
//
// A `Weight` is a value type with these members:
//   static const EffectCard& Card();       parameters: young_modulus_difference, …, poisson_ratio
//   explicit Weight(const Eigen::VectorXd& parameters);    all parameters of the card
//   double Value(const Vector3d& X) const;                 w
//   double Derivative(const Vector3d& X, int parameter) const;    ∂w/∂(parameter), for a parameter
//                     between the first and the last; only needed if these are not all settings
#ifndef LACUNA_EFFECTS_EXTRA_STIFFNESS_H_
#define LACUNA_EFFECTS_EXTRA_STIFFNESS_H_

#include <Eigen/Core>
#include <string>

#include "effects/elastic_parameters.h"
#include "effects/neo_hookean_energy.h"
#include "fem/point_energy_effect.h"
#include "record/effect_card.h"

namespace lacuna {

// The parameter young_modulus_difference (Pa). `where` completes "Young's modulus added to the
// body's …".
inline ParameterCard YoungModulusDifference(const std::string& where) {
  return {.name = "young_modulus_difference",
          .meaning = "Young's modulus added to the body's " + where +
                     ", ΔE; negative (by less than the body's own) where it is softer",
          .dimension = kPressure,
          .bounds = kAnyValue,
          .null_value = 0,
          .plausible_min = -1e5,
          .plausible_max = 1e6,
          .of_body = true,
          .default_value = kMustBeGiven};
}

// A law for PointEnergyEffect (fem/point_energy_effect.h).
template <typename Weight>
class ExtraStiffnessLaw {
 public:
  static const EffectCard& Card() { return Weight::Card(); }

  explicit ExtraStiffnessLaw(const Eigen::VectorXd& parameters)
      : weight_(parameters),
        difference_(parameters[0]),
        per_modulus_(LameByYoungModulus(parameters[parameters.size() - 1])) {}

  double EnergyDensity(const Eigen::Matrix3d& F, const MaterialPoint& at) const {
    return Scaled(difference_ * weight_.Value(at.position)).EnergyDensity(F);
  }

  Eigen::Matrix3d Stress(const Eigen::Matrix3d& F, const MaterialPoint& at) const {
    return Scaled(difference_ * weight_.Value(at.position)).Stress(F);
  }

  StressTangent Tangent(const Eigen::Matrix3d& F, const MaterialPoint& at, bool convexify) const {
    return Scaled(difference_ * weight_.Value(at.position)).Tangent(F, convexify);
  }

  Eigen::Matrix3d StressDerivative(const Eigen::Matrix3d& F, const MaterialPoint& at,
                                   int parameter) const {
    double by_parameter = weight_.Value(at.position);
    if constexpr (requires { weight_.Derivative(at.position, parameter); }) {
      if (parameter != 0) by_parameter = difference_ * weight_.Derivative(at.position, parameter);
    }
    return Scaled(by_parameter).Stress(F);
  }

 private:
  NeoHookeanEnergy Scaled(double young_modulus) const {
    return NeoHookeanEnergy({young_modulus * per_modulus_.lambda, young_modulus * per_modulus_.mu});
  }

  Weight weight_;
  double difference_;          // ΔE, Pa
  LameConstants per_modulus_;  // λ and μ per unit of Young's modulus
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EXTRA_STIFFNESS_H_
