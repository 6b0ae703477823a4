// The diagnosis of a bar that was held aside and let go (support/held_bar.h).
#ifndef LACUNA_TESTS_DIAGNOSIS_DIAGNOSED_BAR_H_
#define LACUNA_TESTS_DIAGNOSIS_DIAGNOSED_BAR_H_

#include <array>
#include <map>
#include <string>

#include "diagnosis/diagnosis.h"
#include "support/held_bar.h"

namespace lacuna {

// Films the bar, fits the experiment, with texts replaced, on a mesh with these cells, and
// diagnoses it.
Diagnosis DiagnoseBar(const HeldBarTruth& truth, const std::map<std::string, std::string>& replaced,
                      const DiagnosisOptions& options = {},
                      const std::array<int, 3>& cells = {7, 1, 1});

}  // namespace lacuna

#endif  // LACUNA_TESTS_DIAGNOSIS_DIAGNOSED_BAR_H_
