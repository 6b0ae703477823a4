// How well the diagnosis does on a suite of sealed cases: how often it names an effect, how often
// rightly, beside what these recordings allow, and whether its probabilities are frequencies.
#ifndef LACUNA_TRIALS_TRIAL_RATES_H_
#define LACUNA_TRIALS_TRIAL_RATES_H_

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trials/trial_case.h"
#include "trials/trial_run.h"

namespace lacuna {

// A case is decidable if the rules give the right answer in so many of the recordings that were
// simulated for it (TrialOutcome::simulated).
inline constexpr double kDecidable = 0.8;

struct Rate {
  int part = 0, whole = 0;
  // The sum of the frequencies with which the simulated rules (TrialOutcome::simulated) do what is
  // counted, over `simulated_cases` cases; 0 cases where they do not predict it.
  double simulated = 0;
  int simulated_cases = 0;
};

// Statements (which effects are missing, or which nuisance) whose probability lies in one interval,
// of all cases.
struct ReliabilityBin {
  double low = 0, high = 0;
  int statements = 0;
  double stated = 0;  // sum of their probabilities
  int right = 0;      // how many of them were true
};

struct TrialRates {
  // Verdicts "missing" although nothing is.
  Rate named_in_controls, named_in_hard_controls;
  // Cases with one hidden effect of the catalogue.
  Rate named;            // the verdict "missing" names the effect and no other
  Rate decidable_named;  // `named`, of the decidable cases (kDecidable)
  Rate family;           // of the verdicts that name effects, those that name one of its family
  Rate wrong_member;     // the verdict "missing" names another effect of its family
  Rate outside_family;   // the verdict "missing" names an effect of another family
  // Cases whose effect was removed from the catalogue.
  Rate removed_member, removed_outside;  // an effect of its family, of another family was named
  Rate not_in_library;                   // the verdict is "not in library"
  Rate decidable_not_in_library;         // `not_in_library`, of the decidable cases
  // All cases but those with a removed effect, and those with the verdict "not in library", which
  // says that the truth is not among the hypotheses.
  std::array<ReliabilityBin, 5> reliability = {
      {{0.01, 0.2}, {0.2, 0.4}, {0.4, 0.6}, {0.6, 0.8}, {0.8, 1.0}}};
};

struct FinishedTrial {
  TrialCase trial;
  TrialOutcome outcome;
};
TrialRates RatesOf(const std::vector<FinishedTrial>& finished);
std::string RatesInWords(const TrialRates& rates);
// {"rates": one entry for each line of the words, "calibration": one for each interval}
nlohmann::json RatesToJson(const TrialRates& rates);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_RATES_H_
