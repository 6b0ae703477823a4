// Predicts which next recording would decide between the effects that a diagnosis has left.
//
// For each protocol one tangent-linear simulation of the fitted model gives the influence of the
// parameters and of all rivals on the recording that it would make; that of a pair of effects is
// the influence of both, each with a size of its own. Joined to the products that the
// diagnosis has kept (joined_space.h), it tells how far the rivals would be apart, how well their
// sizes would be known, and, by simulated recordings, how often the right one would be named. A
// simulated recording is drawn as it would be if a rival were missing: the size of the rival and
// the parameters from their posterior, the errors that are new in the planned recording from their
// priors. The evidence of each rival then grows by the difference of its log Bayes factors with and
// without the planned recording, and the rules of the diagnosis decide (decision_rules.h).
#ifndef LACUNA_PLAN_PLANNER_H_
#define LACUNA_PLAN_PLANNER_H_

#include <vector>

#include "calibration/calibration_run.h"
#include "core/progress.h"
#include "diagnosis/decision_input.h"
#include "plan/protocol.h"
#include "record/diagnosis_record.h"
#include "record/plan_record.h"

namespace lacuna {

// More rivals than this are not planned for; the least probable ones are left out.
inline constexpr size_t kMostPlannedRivals = 6;

// What a plan starts from: a fitted run and its diagnosis.
struct DiagnosedRun {
  const FittedRun& fitted;
  const DiagnosisRecord& diagnosis;
  const DecisionInput& decision;  // what the diagnosis has decided from
};

// The outcomes are sorted. A protocol that cannot be played is reported in its message. Throws
// InputError where the diagnosis has left fewer than two hypotheses that differ in their effects,
// or no effect among them, and where all that it keeps have an effect in common, alone or in pairs.
// Rivals that are not weighed are named in PlanRecord::not_predicted. Protocols are played side by
// side; the result does not depend on the number of threads. Throws Interrupted.
PlanRecord MakePlan(const DiagnosedRun& run, const std::vector<Protocol>& protocols,
                    Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PLANNER_H_
