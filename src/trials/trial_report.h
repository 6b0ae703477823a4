// What a suite of trials says about the diagnosis.
#ifndef LACUNA_TRIALS_TRIAL_REPORT_H_
#define LACUNA_TRIALS_TRIAL_REPORT_H_

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lacuna {

// Shares are of `cases`. Right means: named alone (top 1), or in the set that the verdict declares
// or second in the ranking (top 2). A wrong name is a verdict "missing" that names another effect.
struct TrialTally {
  std::string group;  // "control", "one_effect, 2 recordings, 4 x"
  int cases = 0;
  int top1 = 0, top2 = 0, wrong = 0;
  int ranked_first = 0;  // first in the ranking, whatever the verdict
  std::map<std::string, int> verdicts;
  int fitted = 0;                              // cases whose hidden effect was fitted
  int at_noise = 0;                            // of them, held-out error ≤ 1.2 × the noise
  int within_15 = 0;                           // its size within 15 %
  int intervals = 0, covered = 0;              // 95 % intervals of amplitudes
  double median_before = 0, median_after = 0;  // held out, multiples of the noise
};

struct TrialReport {
  std::vector<TrialTally> tallies;
  // Hidden effect → what was said of it → how often.
  std::map<std::string, std::map<std::string, int>> confusion;
  std::vector<std::string> unfinished;  // cases without an outcome
};

TrialReport ReportTrials(const std::filesystem::path& folder);
std::string ReportInWords(const TrialReport& report);
// report.json and report.txt in the folder.
void SaveTrialReport(const TrialReport& report, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_REPORT_H_
