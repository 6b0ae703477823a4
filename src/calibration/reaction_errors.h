// How well a model predicts the measured reaction of a grip.
#ifndef LACUNA_CALIBRATION_REACTION_ERRORS_H_
#define LACUNA_CALIBRATION_REACTION_ERRORS_H_

#include <vector>

#include "prediction/reaction_misfit.h"
#include "record/fitted_reaction.h"

namespace lacuna {

// The errors of one reading without its tare, which is determined from the frames `tells_tare`.
// The lists have one entry per frame of the misfit: its time, s, and flags. Where the rms error
// exceeds kConsiderableReactionError, mistakes in the reading are looked for (reading_mistakes.h,
// which says what `forces_are_known` means).
FittedReaction MeasureReaction(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                               const std::vector<double>& times, const std::vector<char>& fitted,
                               const std::vector<char>& tells_tare, bool forces_are_known);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_REACTION_ERRORS_H_
