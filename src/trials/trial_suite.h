// A suite of sealed cases: controls, single hidden effects at multiples of their detectable sizes,
// pairs of effects, and effects that are removed from the library of the diagnosis.
#ifndef LACUNA_TRIALS_TRIAL_SUITE_H_
#define LACUNA_TRIALS_TRIAL_SUITE_H_

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "trials/trial_case.h"

namespace lacuna {

struct TrialSuite {
  // Suites that tune the diagnosis and suites that are reported must have different seeds.
  uint64_t seed = 0;
  int controls = 0, hard_controls = 0;  // number of cases without a hidden effect
  std::vector<std::string> effects;     // hidden one at a time
  std::vector<int> factors;             // sizes of hidden effects over their detectable sizes
  std::vector<int> recordings;          // numbers of recordings per case
  bool is_scanned = false;              // observed by depth cameras instead of markers
  std::vector<std::string> removed;     // hidden at the largest factor and removed from the library
  int pairs = 0;                        // number of cases with two effects, at the largest factor
  // The probability that the clamp of a case has a load cell. 0: there is none, and the cases are
  // those of a suite without this key.
  double load_cells = 0;
};
// The types of effects listed under the key; none if it is absent. Throws InputError, which
// lists the possible types, for an effect that cannot be hidden: one that the catalogue does not
// have, one that numbers alone do not describe, and the law of every model; and for one that is
// listed twice.
std::vector<std::string> ReadEffectTypes(const Config& config, const std::string& key);

// Throws InputError at the key that is wrong.
TrialSuite ReadTrialSuite(const Config& config);

// The cases of a suite with the types and factors of their hidden effects, whose sizes are not
// determined yet. The same suite gives the same cases.
std::vector<TrialCase> CasesOf(const TrialSuite& suite);

// Makes a case in <folder>/<case>: determines the sizes of its hidden effects, simulates the
// recordings and writes truth.json last. An existing case is kept; if only its truth.json exists,
// its recordings are simulated again as they were. If a detectable effect would be implausibly
// large, or the truth cannot be simulated, a case with hidden effects is drawn again, up to eight
// draws in all. Then, and for a case without hidden effects at once, it is abandoned: skipped.txt
// has the reasons, and false is returned. Throws InputError if a file cannot be read or written.
bool MakeCase(TrialCase trial, const std::filesystem::path& folder);

// Makes all cases of a suite that do not exist yet, in `workers` processes. Returns the result of
// ShareCases (case_files.h), for which an abandoned case is no failure, and an InputError of
// MakeCase is one.
bool MakeTrials(const TrialSuite& suite, const std::filesystem::path& folder, int workers);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_SUITE_H_
