// Writes the files of a comparison.
#ifndef LACUNA_COMPARISON_COMPARISON_FILES_H_
#define LACUNA_COMPARISON_COMPARISON_FILES_H_

#include <filesystem>

#include "comparison/comparison.h"

namespace lacuna {

// Writes into <run>/comparison/:
//   by_frame.csv, by_marker.csv   the error of each frame, and of each point in each part
//   by_quantity.csv               the error as a function of time, displacement, speed, …
//   unexplained_force.csv         force, torque, power and position over time; only if it was computed
//   comparison.json               the record and its description in words; written last
// Each file is complete or absent. Throws InputError when one cannot be written.
void WriteComparison(const Comparison& comparison, const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARISON_FILES_H_
