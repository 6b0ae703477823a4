// What a decision is made from: plain data, which can be stored and decided upon again.
#ifndef LACUNA_DIAGNOSIS_DECISION_INPUT_H_
#define LACUNA_DIAGNOSIS_DECISION_INPUT_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/hypothesis_space.h"
#include "record/effect_card.h"

namespace lacuna {

// The model fitted again with one effect.
struct WeighedRefit {
  std::string effect;
  double evidence = 0;    // log Bayes factor against the baseline at its best, at the refit
  HypothesisSpace space;  // along the refit; the effect's parameters are in its base
  bool predicts = true;   // as Predicts (effect_refit.h) says
};

// Whether a and b are these two effects, in either order.
inline bool IsSamePair(const std::string& first, const std::string& second, const std::string& a,
                       const std::string& b) {
  return (first == a && second == b) || (first == b && second == a);
}

// The model fitted again with two effects at once.
struct WeighedPair {
  std::string first, second;
  // Log evidence minus that of the refit with the first effect alone (WeighedRefit), beside the
  // same nuisances, and minus the selection penalty of the second effect's variant
  // (scored_effect.h). Contains the evidence for the natural values of both effects, as this fit
  // estimates them, less that of the first one alone.
  double gain = 0;
  HypothesisSpace space;  // along the refit; the parameters of both are in its base
  bool predicts = true;   // beyond the model without an effect, and beyond either of the two alone
};

// The model fitted again with one nuisance beside those of the baseline.
struct WeighedNuisance {
  std::string name;
  double evidence = 0;  // log Bayes factor, as above
};

struct DecisionInput {
  HypothesisSpace baseline;  // along the motion of the fitted model
  std::vector<WeighedRefit> refits;
  std::vector<WeighedPair> pairs;
  std::vector<std::array<std::string, 2>> failed_pairs;  // could not be fitted
  std::vector<WeighedNuisance> nuisances;
  // Nuisances that the ranking has taken into the base because they are so certain, with their log
  // Bayes factor against the model without them, and effects refitted in their place, with theirs.
  std::vector<std::string> adopted;
  double adopted_evidence = 0;
  std::vector<WeighedRefit> in_place_of_adopted;
  std::map<std::string, EffectFamily> families;  // of every effect
  // A value that nature fixes, such as the acceleration of gravity: the logarithm of the Bayes
  // factor between a prior half of which is concentrated there and the broad prior.
  std::map<std::string, double> natural_value;
  // The squared misfit, σ², that effects of the model have removed, found by earlier diagnoses.
  double explained_misfit = 0;
  bool noise_is_known = false;         // the standard deviation of the noise was given
  bool is_anything_detectable = true;  // some effect of plausible size would be visible
  uint64_t seed = 1;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_INPUT_H_
