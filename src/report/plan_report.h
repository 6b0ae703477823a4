// The text of a plan: which next recording would tell the rivals of a diagnosis apart.
#ifndef LACUNA_REPORT_PLAN_REPORT_H_
#define LACUNA_REPORT_PLAN_REPORT_H_

#include <string>

#include "record/plan_record.h"

namespace lacuna {

// What has to be decided, and the best recording in words; for 100 columns.
std::string PlanSummary(const PlanRecord& plan);

// PlanSummary() with a table of all recordings, the intervals that the best one would give, and why
// others cannot be made.
std::string PlanReport(const PlanRecord& plan);

}  // namespace lacuna

#endif  // LACUNA_REPORT_PLAN_REPORT_H_
