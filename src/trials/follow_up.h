// Do the recordings that a plan proposes decide?
//
// For each case whose diagnosis has left one hidden effect open, the recording that the plan
// (plan/planner.h) ranks first is made with the true bar, and both recordings are diagnosed
// together. For comparison the same is done with a recording that is chosen at random among those
// of the plan that last as long.
#ifndef LACUNA_TRIALS_FOLLOW_UP_H_
#define LACUNA_TRIALS_FOLLOW_UP_H_

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "plan/planned_recording.h"
#include "scan/marker_tracks.h"
#include "scan/measured_reaction.h"
#include "trials/trial_case.h"
#include "trials/trial_run.h"

namespace lacuna {

// A planned recording and what became of it.
struct FollowUp {
  std::string protocol;
  // The plan's probability of the right name if what is hidden is missing; nothing where that is
  // not among the rivals for which was planned.
  std::optional<double> predicted;
  TrialOutcome outcome;  // of all recordings together
};

// Both kinds of a case. Where one is absent, `message` says why: the diagnosis has left no rivals,
// or none that can be planned for, or no (other) recording can be made so with the true bar.
struct CaseFollowUps {
  std::string message;
  std::optional<FollowUp> best, random;
};

// The planned recording, which is a variant of one of the case's recordings that the hand held with
// `hold_force` (N), as the true bar shows it: the markers, and the reading of the load cell where
// the case has one, with noise. `number` draws the noise; `rough` as for SimulateTruth(). Throws
// SimulationFailure (trials/trial_simulation.h) where the true motion cannot be simulated.
struct TrueRecording {
  Markers markers;
  std::optional<MeasuredReaction> reading;
};
TrueRecording RecordTruth(const TrialCase& trial, const Protocol& protocol,
                          const PlannedRecording& planned, const Eigen::Vector3d& hold_force,
                          int number, bool rough = false);

// Whether a case with one hidden effect, seen by markers, was left open: the verdict is
// "ambiguous", "no power" or "adequate".
bool IsOpen(const TrialCase& trial, const TrialOutcome& outcome);

// Makes the follow-ups of all open cases of a folder that have none yet, in <case>/follow_up: see
// WorkOn (trials/case_files.h), which keeps other failures than those of CaseFollowUps.
bool RunFollowUps(const std::filesystem::path& folder, int workers);

// Writes and reads what a case's folder keeps; the outcomes of its follow-ups stand in folders of
// their own, best/ and random/. Nothing is read where no follow-ups were made. Throw InputError.
void WriteFollowUps(const CaseFollowUps& made, const std::filesystem::path& own);
std::optional<CaseFollowUps> ReadFollowUps(const std::filesystem::path& own);
// The folders in which outcomes of follow-ups of a case stand or will stand.
std::vector<std::filesystem::path> FollowUpFolders(const std::filesystem::path& own);

// One row of the report, over the cases that have both kinds of recordings.
struct FollowUpTally {
  std::string choice;       // "best of the plan", "another one at random"
  int cases = 0;            // that were recorded again
  int named = 0;            // the right name alone
  int wrong = 0;            // a verdict "missing" with another name
  int predicted_cases = 0;  // whose hidden effect is among the rivals
  double predicted = 0;     // sum of FollowUp::predicted over these
};
struct FollowUpReport {
  int open = 0;                        // cases
  int waiting = 0;                     // of these: not followed yet
  int unpaired = 0;                    // of these: one of the two recordings cannot be made
  std::vector<FollowUpTally> tallies;  // empty: no case was followed
};
FollowUpReport ReportFollowUps(const std::filesystem::path& folder);
std::string FollowUpsInWords(const FollowUpReport& report);
nlohmann::json FollowUpsToJson(const FollowUpReport& report);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_FOLLOW_UP_H_
