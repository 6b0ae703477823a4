// A stiffness that differs from place to place: an extra Young's modulus ΔE, weighted by a function
// w of the place in the rest shape, on top of the body's elasticity law.
//
//   ψ = w(X) ψ_nH(F; ΔE, ν)
// with the neo-Hookean energy ψ_nH, in which E is a factor: a neo-Hookean body with this effect is
// one of Young's modulus E + w ΔE where Poisson's ratios are the same. With another law that is so
// at small strain.
//
// A `Weight` is a value type made from the card's parameters:
//   static const EffectCard& Card();       parameters: young_modulus_difference, …, poisson_ratio
//   explicit Weight(const Eigen::VectorXd& parameters);
//   double Value(const Vector3d& X) const;                       w
//   double Derivative(const Vector3d& X, int parameter) const;   by a parameter between these two;
//                                          only where they are not all settings
#ifndef LACUNA_EFFECTS_EXTRA_STIFFNESS_H_
#define LACUNA_EFFECTS_EXTRA_STIFFNESS_H_

#include <Eigen/Core>
#include <limits>
#include <string>

#include "effects/elastic_parameters.h"
#include "effects/neo_hookean_energy.h"
#include "fem/point_energy_effect.h"
#include "record/effect_card.h"

namespace lacuna {

// young_modulus_difference; `where` completes "Young's modulus added to the body's …".
inline ParameterCard YoungModulusDifference(const std::string& where) {
  return {.name = "young_modulus_difference",
          .meaning = "Young's modulus added to the body's " + where +
                     ", ΔE; negative (by less than the body's own) where it is softer",
          .dimension = kPressure,
          .bounds = kAnyValue,
          .null_value = 0,
          .plausible_min = -1e5,
          .plausible_max = 1e6,
          .default_value = std::numeric_limits<double>::quiet_NaN()};
}

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
  LameConstants per_modulus_;  // for a Young's modulus of 1
};

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EXTRA_STIFFNESS_H_
