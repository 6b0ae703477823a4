// A force law that the user writes as expressions in the YAML file (docs/expression.md), as data:
//   f_i = M_i F(x_i, X_i, v_i, t, N_i; p),
// with the mass, volume or boundary area M_i of node i. The effect is in expression_force.cc.
#ifndef LACUNA_EFFECTS_EXPRESSION_LAW_H_
#define LACUNA_EFFECTS_EXPRESSION_LAW_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/expression.h"
#include "record/effect_card.h"

namespace lacuna {

struct ExpressionLaw {
  // Index of the first component of each variable that a law may use; the parameters follow them.
  enum Variable {
    kPosition,
    kRest = 3,
    kDisplacement = 6,
    kVelocity = 9,
    kTime = 12,
    kNormal = 13
  };
  static constexpr int kVariables = kNormal + 3;
  static constexpr int kMaxParameters = 16;
  template <typename Number>
  using Values = std::array<Number, kVariables + kMaxParameters>;

  enum class Measure { kMass, kVolume, kArea };

  std::string name;
  Measure per = Measure::kMass;
  std::vector<Expression> force;  // F: one for each axis, N per kg, m³ or m²
  EffectCard card;             // its first parameter is the amplitude, to which F is proportional
  Eigen::VectorXd parameters;  // in the order of the card, SI

  // The name of a variable or parameter, by its index in Values.
  std::string NameOf(int variable) const;
};

// `card` is the common part of the cards of all such laws. Throws InputError at the key that is
// wrong; also for a force that does not vanish with its amplitude, or whose derivative with respect
// to the amplitude vanishes there.
ExpressionLaw ReadExpressionLaw(const Config& config, const EffectCard& card);

// The YAML flow mapping that describes the law with its present parameter values.
std::string FormatExpressionLaw(const ExpressionLaw& law);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EXPRESSION_LAW_H_
