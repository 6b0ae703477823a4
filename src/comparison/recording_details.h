// Details that must be read from the recordings themselves: the names of the markers and their
// distance from the grip.
#ifndef LACUNA_COMPARISON_RECORDING_DETAILS_H_
#define LACUNA_COMPARISON_RECORDING_DETAILS_H_

#include <filesystem>
#include <vector>

#include "comparison/comparison.h"
#include "record/calibration_record.h"

namespace lacuna {

// Reads the experiment and the recordings of the run again. Where they are absent or have changed
// since the fit, the details stay as they are and a note is added. Returns for each recording
// whether its points are known to be markers, whose names identify them in other recordings too;
// tracked points are named after their rows.
std::vector<char> AddRecordingDetails(const std::filesystem::path& run,
                                      const CalibrationRecord& record, Comparison* comparison);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_RECORDING_DETAILS_H_
