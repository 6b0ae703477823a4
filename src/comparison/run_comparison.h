// Compares the predictions of a finished fit with its recordings.
#ifndef LACUNA_COMPARISON_RUN_COMPARISON_H_
#define LACUNA_COMPARISON_RUN_COMPARISON_H_

#include <filesystem>

#include "comparison/comparison.h"

namespace lacuna {

// Reads the residuals that the fit has written; the model is not needed. If the experiment and its
// recordings are still as they were, points have their names and a distance from the grip; if not,
// a note says so. Throws InputError when the folder is not a finished run of `lacuna fit`, or when
// its files are damaged.
Comparison CompareRun(const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_RUN_COMPARISON_H_
