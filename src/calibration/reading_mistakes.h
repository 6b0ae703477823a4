// Which mistake in the reading of a load cell would explain its misfit.
#ifndef LACUNA_CALIBRATION_READING_MISTAKES_H_
#define LACUNA_CALIBRATION_READING_MISTAKES_H_

#include <vector>

#include "prediction/reaction_misfit.h"
#include "record/fitted_reaction.h"

namespace lacuna {

// Fits the reading m by the prediction f, in all frames of the misfit, whose times (s) are given:
//   a f            a factor, where a is negative or far from 1
//   a f + b        an offset b of each component
//   a f(t − d)     a delay d, up to a quarter of the time
// each by least squares. The modulus has followed the wrong reading, so that a is free; this is
// exact where forces are proportional to the modulus and the motion does not depend on it. Where
// `forces_are_known` on the object, these and not the modulus determine the reading: a must then be
// near 1, and an offset beside another factor is returned together with it. A mistake is likely if
// it leaves less than a twentieth of the squared misfit; the others are looked for only where a
// factor alone does not. Nothing is found where the prediction is 0.
ReadingMistakes FindReadingMistakes(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                                    const std::vector<double>& times, bool forces_are_known);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_READING_MISTAKES_H_
