// Sentences and lines about the measured forces of grips.
#ifndef LACUNA_REPORT_REACTION_TEXT_H_
#define LACUNA_REPORT_REACTION_TEXT_H_

#include <string>

#include "record/calibration_record.h"

namespace lacuna {

// The lines of one reading in the table of a fit's recordings, with final line breaks.
std::string ReactionLines(const FittedReaction& reaction);

// A paragraph about how well a model predicts a reading of the recording.
std::string DescribeReactionFit(const FittedReaction& reaction, const std::string& recording);

}  // namespace lacuna

#endif  // LACUNA_REPORT_REACTION_TEXT_H_
