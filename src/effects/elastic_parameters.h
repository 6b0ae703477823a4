// The two parameters that all isotropic elasticity laws have in common: Young's modulus E (Pa) and
// Poisson's ratio ν, both at small strain (A. E. H. Love, A Treatise on the Mathematical Theory of
// Elasticity, 4th ed., 1927, §69).
#ifndef LACUNA_EFFECTS_ELASTIC_PARAMETERS_H_
#define LACUNA_EFFECTS_ELASTIC_PARAMETERS_H_

#include <vector>

#include "record/effect_card.h"

namespace lacuna {

// young_modulus and poisson_ratio, in the order that ElasticSolid (fem/elastic_solid.h) expects.
// The bounds exclude ν = ½, where the bulk modulus is infinite.
inline std::vector<ParameterCard> ElasticParameters() {
  return {{.name = "young_modulus",
           .meaning = "Young's modulus at small strain",
           .dimension = kPressure,
           .bounds = {0, 1e15, true, false},
           .null_value = 0,
           .plausible_min = 1e3,
           .plausible_max = 1e7,
           .default_value = kMustBeGiven,
           .log_scale = true},
          {.name = "poisson_ratio",
           .meaning = "Poisson's ratio at small strain; 0.5 would be incompressible, which a "
                      "displacement formulation cannot represent (0.49 comes close; use quadratic "
                      "elements above 0.45, linear ones lock)",
           .dimension = kDimensionless,
           .bounds = {-1, 0.5, true, true},
           .null_value = kNoNullValue,
           .plausible_min = 0.2,
           .plausible_max = 0.499,
           .default_value = kMustBeGiven,
           .log_scale = false}};
}

// Poisson's ratio as a setting of an effect, which takes an omitted value from the material.
inline ParameterCard PoissonRatioSetting() {
  ParameterCard ratio = ElasticParameters().back();
  ratio.meaning += "; if omitted, that of the material";
  ratio.setting = true;
  return ratio;
}

// Young's modulus m (Pa) that a branch adds to the material. `meaning`: the text of its card, which
// introduces the symbol m.
inline ParameterCard BranchModulus(const char* meaning) {
  return {.name = "modulus",
          .meaning = meaning,
          .dimension = kPressure,
          .bounds = kNotNegative,
          .null_value = 0,
          .plausible_min = 0,
          .plausible_max = 3e5,
          .of_body = true,
          .default_value = kMustBeGiven,
          .log_scale = false};
}

// Poisson's ratio of such a branch, a setting.
inline ParameterCard BranchPoissonRatio() {
  ParameterCard ratio = ElasticParameters().back();
  ratio.meaning = "Poisson's ratio of the branch (of the material if omitted)";
  ratio.setting = true;
  return ratio;
}

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_ELASTIC_PARAMETERS_H_
