// The part of a comparison for which the fitted model must be run again.
#ifndef LACUNA_COMPARISON_COMPARED_MOTION_H_
#define LACUNA_COMPARISON_COMPARED_MOTION_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "comparison/comparison.h"
#include "core/progress.h"
#include "record/calibration_record.h"

namespace lacuna {

// Adds the trends of the error with strain, strain rate and height, the places that are loaded most
// and the unexplained force, and writes fields for ParaView to <run>/comparison/<number of the
// recording> and the motion with the force for a report (MotionFile). Where the experiment or a
// recording has changed since the fit, or the prediction is no longer that of the fit, a note is
// added instead. Throws InputError when files cannot be written, and Interrupted.
void CompareMotion(const std::filesystem::path& run, Progress* progress, Comparison* comparison);

// What follows for stresses and forces where the recordings do not determine a fitted modulus, as
// displacements without a known force do not; nothing where they determine all.
std::optional<std::string> NoteOnScale(const std::vector<FittedParameter>& parameters);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARED_MOTION_H_
