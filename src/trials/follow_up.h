// Do the recordings that a plan proposes decide?
//
// Of each case whose diagnosis has left one hidden effect open, the recording that the plan
// (plan/planner.h) ranks first is made with the true bar, and both recordings are diagnosed
// together. For comparison the same is done with a recording that is chosen at random among those
// of the plan that last as long.
#ifndef LACUNA_TRIALS_FOLLOW_UP_H_
#define LACUNA_TRIALS_FOLLOW_UP_H_

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/tet_mesh.h"
#include "plan/protocol.h"
#include "prediction/prediction_study.h"
#include "scan/marker_tracks.h"
#include "trials/trial_case.h"
#include "trials/trial_run.h"

namespace lacuna {

// A planned recording and what became of it.
struct FollowUp {
  std::string protocol;
  double predicted = 0;  // the plan's probability of the right name, rivals weighted
  // The same if what is hidden is missing; nothing where the plan has no such rival.
  std::optional<double> predicted_for_truth;
  TrialOutcome outcome;  // of both recordings together
};

// Both kinds of a case, or why there are none: the diagnosis has left no rivals, or the true bar
// cannot be recorded so.
struct CaseFollowUps {
  std::string message;
  std::optional<FollowUp> best, random;
};

// The markers of the planned recording as the true bar moves them, with noise. `study` and `mesh`
// are the model's, to one of whose recordings the protocol applies; `number` draws the noise.
// `rough` as for SimulateTruth(). Throws InputError where the protocol cannot be made.
Markers RecordTruth(const TrialCase& trial, const Protocol& protocol, const PredictionStudy& study,
                    const TetMesh& mesh, int number, bool rough = false);

// Whether the diagnosis of a case with one hidden effect names none, although it does not say that
// something unknown is left either.
bool IsOpen(const TrialCase& trial, const TrialOutcome& outcome);

// Makes the follow-ups of all open cases of a folder that have none yet, each in a process of its
// own, `workers` at a time, in <case>/follow_up. Returns the result of ShareOut (core/workers.h).
int RunFollowUps(const std::filesystem::path& folder, int workers);

// What a case's folder keeps; nothing where its follow-ups were not made. Throws InputError.
std::optional<CaseFollowUps> LoadFollowUps(const std::filesystem::path& own);

// One row of the report.
struct FollowUpTally {
  std::string choice;    // "best of the plan", "random"
  int cases = 0;         // that were recorded again
  double predicted = 0;  // sum of FollowUp::predicted
  int named = 0;         // the right name alone
  int wrong = 0;         // a verdict "missing" with another name
};
struct FollowUpReport {
  int open = 0;      // cases
  int not_made = 0;  // of these: without a recording, for the reason in CaseFollowUps::message
  std::vector<FollowUpTally> tallies;  // empty: no follow-ups were made
};
FollowUpReport ReportFollowUps(const std::filesystem::path& folder);
std::string FollowUpsInWords(const FollowUpReport& report);
nlohmann::json FollowUpsToJson(const FollowUpReport& report);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_FOLLOW_UP_H_
