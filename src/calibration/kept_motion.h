// Keeps the motion of a fitted model in the run's folder, for its report.
#ifndef LACUNA_CALIBRATION_KEPT_MOTION_H_
#define LACUNA_CALIBRATION_KEPT_MOTION_H_

#include <filesystem>

#include "core/progress.h"

namespace lacuna {

// Predicts each recording of a finished fit once more and writes MotionFile(run, number), unless
// the folder holds the motion of this fit already. A prediction that stops early is kept as far as
// it goes, with a note. Throws InputError as OpenRun does, and Interrupted.
void KeepMotion(const std::filesystem::path& run, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_KEPT_MOTION_H_
