// What the YAML file says of a force law of the user's own (docs/expression.md).
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
  // Where the variables that every law may use stand; the parameters follow.
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
  std::vector<Expression> force;  // one for each axis
  EffectCard card;                // the amplitude first
  Eigen::VectorXd parameters;     // in the order of the card

  // Of a variable or parameter, as it stands in Values.
  std::string NameOf(int variable) const;
};

// `card`: what is said of all such laws. Throws InputError at the key that is wrong; so it does for
// a force that does not vanish with its amplitude, or not in proportion to it.
ExpressionLaw ReadExpressionLaw(const Config& config, const EffectCard& card);

// The flow mapping that is read back to the same law, with its present parameter values.
std::string FormatExpressionLaw(const ExpressionLaw& law);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_EXPRESSION_LAW_H_
