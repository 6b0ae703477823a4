// The sentence of a headline about a load cell whose force the model does not meet.
#ifndef LACUNA_REPORT_MISSED_REACTION_H_
#define LACUNA_REPORT_MISSED_REACTION_H_

#include <string>

#include "report/reported_run.h"

namespace lacuna {

// Says which measured force or torque the model misses by far more than it misses the markers or
// scans, both in multiples of the noise, and, where the error is large compared with the reading,
// which mistake in the reading would explain it. Empty where there is none.
std::string MissedReactionSentence(const ReportedModel& model);

}  // namespace lacuna

#endif  // LACUNA_REPORT_MISSED_REACTION_H_
