// A suite of sealed cases: controls, single hidden effects at multiples of what the recording can
// show, pairs, and effects that the library is not allowed to name.
#ifndef LACUNA_TRIALS_TRIAL_SUITE_H_
#define LACUNA_TRIALS_TRIAL_SUITE_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "core/progress.h"
#include "trials/trial_case.h"

namespace lacuna {

struct TrialSuite {
  std::string name;
  uint64_t seed = 0;  // of tuning and of reported suites never the same
  int controls = 0, hard_controls = 0;
  std::vector<std::string> effects;  // hidden one at a time,
  std::vector<int> factors;          // at these multiples of their detectable sizes,
  std::vector<int> recordings;       // seen in so many recordings
  bool is_scanned = false;           // by depth cameras; else markers are tracked
  std::vector<std::string> removed;  // hidden at the largest factor, and taken from the library
  int pairs = 0;                     // of two effects, at the largest factor each
};
TrialSuite ReadTrialSuite(const Config& config);

// The cases, their hidden effects' kinds and factors drawn, sizes not yet.
std::vector<TrialCase> CasesOf(const TrialSuite& suite);

// Makes a case in <folder>/<case>: sizes its hidden effects, films it and writes truth.json last. A
// case that is there already stays; one of which only truth.json is there is filmed again as it
// was. Where an effect would have to be larger than is plausible to be
// seen the case is drawn again; after some draws it is given up (skipped.txt) and false returned.
bool MakeCase(TrialCase trial, const std::filesystem::path& folder);

// All cases of a suite that are not there yet. Returns what ShareOut does.
int MakeTrials(const TrialSuite& suite, const std::filesystem::path& folder, int workers);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_SUITE_H_
