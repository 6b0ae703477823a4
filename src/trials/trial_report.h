// Statistics of the diagnosis over a suite of sealed cases.
#ifndef LACUNA_TRIALS_TRIAL_REPORT_H_
#define LACUNA_TRIALS_TRIAL_REPORT_H_

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "trials/follow_up.h"
#include "trials/trial_rates.h"

namespace lacuna {

// The counts of one group of cases. The verdicts "missing" are of three kinds: `top1` names all
// that is hidden and nothing else, `in_part` names one of two hidden effects and nothing else, and
// `wrong` has a name of something that is not hidden, whatever else it names. For an effect that is
// removed from the library every such verdict is wrong.
struct TrialTally {
  std::string group;  // e.g. "hard_control grip", "one_effect, 2 rec, 4 x"
  int cases = 0;
  int nameable = 0;  // cases that hide effects of the library; only `wrong` counts others, too
  int pairs = 0;     // cases that hide two
  int top1 = 0, in_part = 0, wrong = 0;
  // The cases of `top1` and `in_part`, and the verdicts "missing" and "ambiguous" where a hidden
  // effect is among the first two of the ranking or in the set of the ambiguous verdict.
  int top2 = 0;
  int ranked_first = 0;  // a hidden effect is first in the ranking, whatever the verdict
  std::map<std::string, int> verdicts;
  int fitted = 0;     // cases whose hidden effect, the first one of a pair, was fitted
  int at_noise = 0;   // fitted cases with a held-out error of at most 1.2 times the noise
  int within_15 = 0;  // fitted cases whose estimated size is within 15 % of the truth
  int intervals = 0, covered = 0;  // 95 % intervals of amplitudes, and those that contain the truth
  double median_before = 0, median_after = 0;  // held-out error without and with the hidden effect,
                                               // in multiples of the noise
};

struct TrialReport {
  std::vector<TrialTally> tallies;
  // Hidden effect ("nothing" for a control, "drag + gravity" for a pair) → each effect named, or
  // the verdict → number of cases. A verdict with two names is counted under both.
  std::map<std::string, std::map<std::string, int>> confusion;
  TrialRates rates;
  FollowUpReport follow_ups;
  double median_seconds = 0;            // time for the fit and the diagnosis of a case
  std::vector<std::string> unfinished;  // cases without an outcome
  std::vector<std::string> skipped;     // names of the cases that could not be made
};

// Reads the truth and the outcome of every case of a suite. Throws InputError if a file cannot be
// read.
TrialReport ReportTrials(const std::filesystem::path& folder);
// The tables as plain text.
std::string ReportInWords(const TrialReport& report);
// Writes report.json and report.txt into the folder.
void WriteTrialReport(const TrialReport& report, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_REPORT_H_
