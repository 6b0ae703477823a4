// The posterior of a diagnosis, and how well the recordings could have distinguished its
// hypotheses: the part of diagnosis/diagnosis.json from which the verdict follows.
#ifndef LACUNA_RECORD_DECISION_RECORD_H_
#define LACUNA_RECORD_DECISION_RECORD_H_

#include <algorithm>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "record/effect_card.h"
#include "record/run_record.h"

namespace lacuna {

// What is stated about missing physics has at least this posterior probability: the hypotheses that
// reach it together are kept, the most probable ones first. By definition one statement in twenty
// may be wrong where the assumptions hold.
inline constexpr double kStatedProbability = 0.95;

// The posterior probability of one hypothesis about what is missing.
struct HypothesisProbability {
  enum class Kind { kNothing, kEffect, kNuisance, kPair };
  Kind kind = Kind::kNothing;
  // Empty for "nothing", two effects for a pair, or one effect twice. Nuisances beside an effect
  // stand behind it.
  std::vector<std::string> names;
  EffectFamily family = EffectFamily::kOther;  // of an effect
  // Evidence as in record/diagnosis_record.h, variants summed; of effects, less the evidence that
  // the unknown error of the model could give to one.
  double evidence = 0;
  double probability = 0;
  // An effect that predicts the held-out frames more than 100 times less probably than the model
  // without it, or a pair that predicts them more than 300 times less probably than the model
  // without an effect or with one of the two alone. It counts as refuted, whatever its evidence:
  // its probability is 0.
  bool is_refuted = false;

  bool Contains(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
};

// Whether a hypothesis leaves what noise leaves: tail probabilities under noise alone
// (diagnosis/adequacy.h). It is the most probable one or, where that leaves more, the most probable
// one of the others that are kept and leave no more.
struct RecordedAdequacy {
  std::vector<std::string> beside;        // the hypothesis that was tested; empty: nothing
  double p_unknown_force = kNotMeasured;  // not measured where no recording shows such a force
  double p_further = 1;
  double p_variance = kNotMeasured;  // not measured where the noise is not known
  double p = 1;                      // of the smallest of those that there are
  bool is_adequate = true;  // p is not below the level of the test, or what is left not probable
  std::string further;      // the best further effect or nuisance beside it
  double further_evidence = 0;  // its evidence
  double rms_over_sigma = 0;    // of the whitened residual of all frames
  // What could still be removed from the misfit, as a share of what the hypothesis and the effects
  // that were added before have removed; infinite where there is neither.
  double left_share = 0;
  bool is_tolerated = false;  // left_share is within the error of any model
};

// What these recordings would have said, had this hypothesis been true at the size that was found:
// frequencies among simulated recordings. They sum to 1.
struct RecordedPower {
  std::vector<std::string> truth;  // empty: nothing is missing
  double named = 0;                // this hypothesis was named (or nothing, where that is true)
  double wrong_member = 0;         // another effect of its family was named
  double wrong = 0;                // an effect of another family, or a nuisance, was named
  double open = 0;                 // several hypotheses were left
  double unknown = 0;              // something unknown was reported to be left
  std::string most_wrong;          // the wrong name that occurred most often; empty: none did
};

// How well the recordings separate two effects at the sizes that were found: λ is the squared
// distance of their predictions in units of the noise, after everything that is fitted has been
// projected out. λ = 12 gives a right decision in four cases of five.
struct RecordedSeparation {
  std::string first, second;
  double lambda = 0;
};

// The name of a kind in files, e.g. "nothing".
std::string HypothesisKindName(HypothesisProbability::Kind kind);

struct DecisionRecord {
  std::vector<HypothesisProbability> probabilities;  // the most probable one first
  RecordedAdequacy adequacy;
  std::vector<RecordedPower> power;
  std::vector<RecordedSeparation> separations;
  double chance = 0;  // the evidence that noise gives to the best effect in 1 of 20 recordings

  // The probability that one effect is missing and belongs to the family; pairs are not counted.
  double FamilyProbability(EffectFamily family) const;
};

nlohmann::json PowerToJson(const RecordedPower& power);
RecordedPower PowerFromJson(const nlohmann::json& value);
nlohmann::json DecisionToJson(const DecisionRecord& decision);
nlohmann::json ProbabilitiesToJson(const std::vector<HypothesisProbability>& probabilities);
// Both throw nlohmann::json::exception and InputError. The first reads the list under the key
// "probabilities" alone.
std::vector<HypothesisProbability> ProbabilitiesFromJson(const nlohmann::json& value);
DecisionRecord DecisionFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_DECISION_RECORD_H_
