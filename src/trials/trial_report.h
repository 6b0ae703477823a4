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

// The counts of one group of cases. Top 1: the verdict "missing" names the hidden effect. Top 2:
// the hidden effect is also counted when the verdict is "ambiguous" and lists it, or when a verdict
// of either kind ranks it among the first two. Wrong: the verdict "missing" names another effect.
struct TrialTally {
  std::string group;  // e.g. "hard_control grip", "one_effect, 2 rec, 4 x"
  int cases = 0;
  int nameable = 0;  // cases that hide an effect of the library; top1 and top2 are among them
  int top1 = 0, top2 = 0, wrong = 0;
  int ranked_first = 0;  // the hidden effect is first in the ranking, whatever the verdict
  std::map<std::string, int> verdicts;
  int fitted = 0;     // cases whose hidden effect was fitted
  int at_noise = 0;   // fitted cases with a held-out error of at most 1.2 times the noise
  int within_15 = 0;  // fitted cases whose estimated size is within 15 % of the truth
  int intervals = 0, covered = 0;  // 95 % intervals of amplitudes, and those that contain the truth
  double median_before = 0, median_after = 0;  // held-out error without and with the hidden effect,
                                               // in multiples of the noise
};

struct TrialReport {
  std::vector<TrialTally> tallies;
  // Hidden effect ("nothing" for a control) → the effect named, or the verdict → number of cases.
  std::map<std::string, std::map<std::string, int>> confusion;
  TrialRates rates;
  FollowUpReport follow_ups;
  std::vector<std::string> unfinished;  // cases without an outcome
};

// Reads the truth and the outcome of every case of a suite. Throws InputError if a file cannot be
// read.
TrialReport ReportTrials(const std::filesystem::path& folder);
// The tables as plain text.
std::string ReportInWords(const TrialReport& report);
// Writes report.json and report.txt into the folder.
void SaveTrialReport(const TrialReport& report, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_REPORT_H_
