#include "trials/follow_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/random_bits.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_store.h"
#include "plan/planned_experiment.h"
#include "plan/planner.h"
#include "prediction/prediction_study_reader.h"
#include "scan/marker_frames.h"
#include "scan/recorded_grip.h"
#include "trials/case_files.h"
#include "trials/trial_load_cell.h"
#include "trials/trial_recording.h"
#include "trials/trial_simulation.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kRandomProtocol = 80;  // stream of draws
// Numbers of the recordings, which draw their noise: a case has up to two of its own.
constexpr int kBestNumber = 2, kRandomNumber = 3;

constexpr char kFollowUpFolder[] = "follow_up", kFollowUpFile[] = "follow_up/follow_up.json";

// A case whose model was fitted, with its plan.
struct PlannedCase {
  TrialCase trial;
  FittedRun fitted;
  DecisionInput decision;
  DiagnosisRecord diagnosis;  // that the case keeps, decided with the rules as they are now
  std::vector<Protocol> protocols;
  PlanRecord plan;
};

// Without the plan.
PlannedCase FitAgain(const fs::path& own) {
  Progress progress({.style = ProgressStyle::kSilent});
  PlannedCase planned;
  planned.trial = ReadCase(own);
  PredictionStudy study = ReadPredictionStudy(Config::Load(own / kExperimentFile));
  study.output = own / kFollowUpFolder / "fit";
  RunCalibration(study, &progress);
  planned.fitted = OpenRun(study.output);
  planned.decision = ReadDecisionInput(own / kDecisionFolder);
  planned.diagnosis = ReadDiagnosisFile(own / kDiagnosisFile);
  planned.diagnosis.decision = Decide(planned.decision).record;
  planned.protocols = StockProtocols(planned.fitted.study, planned.fitted.mesh);
  return planned;
}

// Throws InputError where there is no plan, or none of its recordings can be played.
PlanRecord PlanOf(const PlannedCase& planned) {
  Progress progress({.style = ProgressStyle::kSilent});
  PlanRecord plan =
      MakePlan({planned.fitted, planned.diagnosis, planned.decision}, planned.protocols, &progress);
  if (!plan.outcomes.front().IsPlayable())
    throw InputError("no recording of the plan can be played");
  return plan;
}

// Another recording of the plan that lasts as long as the best one. Throws InputError where there
// is none.
const PlannedOutcome& ChooseAtRandom(const PlannedCase& planned) {
  const std::vector<PlannedOutcome>& all = planned.plan.outcomes;
  std::vector<const PlannedOutcome*> others;
  for (const PlannedOutcome& outcome : all)
    if (&outcome != &all.front() && outcome.IsPlayable() &&
        std::abs(outcome.seconds - all.front().seconds) < 0.5 * kTrialSpacing)
      others.push_back(&outcome);
  if (others.empty()) throw InputError("no other recording of the plan lasts as long");
  return *others[RandomBits({planned.trial.seed, kRandomProtocol}) % others.size()];
}

// The places of the markers on the true bar. Those that the case has stand where it has put them;
// those that the protocol adds stand beside their recorded places like the others.
Eigen::Matrix3Xd TruePlaces(const TrialCase& trial, const Markers& markers) {
  const Eigen::Vector3d stretch = trial.true_size.cwiseQuotient(trial.size);
  Eigen::Matrix3Xd places = stretch.asDiagonal() * markers.places;
  const Eigen::Matrix3Xd own = MarkerPlaces(trial.true_size);
  places.leftCols(own.cols()) = own;
  for (Eigen::Index m = own.cols(); m < places.cols(); ++m) places.col(m) -= PlaceError(trial, m);
  return places;
}

// Makes the recording with the true bar and diagnoses it together with those of the case, unless
// that was done before.
FollowUp Follow(const PlannedCase& planned, const PlannedOutcome& outcome, int number,
                const fs::path& own, const fs::path& folder) {
  FollowUp made;
  made.protocol = outcome.name;
  for (size_t k = 0; k < planned.plan.rivals.size(); ++k)
    if (planned.trial.Hides(planned.plan.rivals[k].effect)) made.predicted = outcome.named[k];
  if (fs::exists(folder / kOutcomeFile)) {
    made.outcome = ReadTrialOutcome(folder);
    return made;
  }
  const Protocol& protocol =
      *std::find_if(planned.protocols.begin(), planned.protocols.end(),
                    [&](const Protocol& one) { return one.name == outcome.name; });
  const PredictionStudy& study = planned.fitted.study;
  size_t changed = 0;
  while (study.recordings.at(changed).name != protocol.recording) ++changed;
  const PlannedRecording recording = PlanRecording(protocol, study, planned.fitted.mesh);
  const TrueRecording seen = RecordTruth(planned.trial, protocol, recording,
                                         planned.trial.hold_forces.at(changed), number);
  WritePlannedExperiment(planned.fitted, planned.diagnosis.time_step, protocol, folder);
  // As docs/plan.md tells the user: what was measured replaces what was predicted.
  fs::remove_all(folder / "measured");
  fs::copy(folder / "predicted", folder / "measured");
  WriteMarkerFrames(folder / "measured", recording.item.recording.times, seen.markers);
  // Its only reading, which recording.yaml describes already.
  if (seen.reading) WriteReaction(folder / "measured", *seen.reading, 1);
  made.outcome = RunCase(own, folder);
  WriteTrialOutcome(made.outcome, folder);
  return made;
}

nlohmann::json ToJson(const std::optional<FollowUp>& made) {
  if (!made) return {};
  return {{"protocol", made->protocol},
          {"predicted", made->predicted ? nlohmann::json(*made->predicted) : nlohmann::json()}};
}

std::optional<FollowUp> FromJson(const nlohmann::json& json, const fs::path& folder) {
  if (json.is_null()) return std::nullopt;
  FollowUp made;
  made.protocol = json.at("protocol");
  if (!json.at("predicted").is_null()) made.predicted = json.at("predicted");
  made.outcome = ReadTrialOutcome(folder);
  return made;
}

// Throws InputError for what is not a result: files that are absent or of another version, and fits
// that fail.
CaseFollowUps MakeFollowUps(const fs::path& own) {
  const fs::path best = FollowUpFolders(own)[0], random = FollowUpFolders(own)[1];
  CaseFollowUps made;
  PlannedCase planned = FitAgain(own);
  const PlannedOutcome* other = nullptr;
  try {
    planned.plan = PlanOf(planned);
  } catch (const InputError& problem) {
    made.message = problem.what();
    return made;
  }
  try {
    other = &ChooseAtRandom(planned);
  } catch (const InputError& problem) {
    made.message = problem.what();
  }
  try {
    made.best = Follow(planned, planned.plan.outcomes.front(), kBestNumber, own, best);
    if (other != nullptr) made.random = Follow(planned, *other, kRandomNumber, own, random);
  } catch (const SimulationFailure& problem) {
    made.message = problem.what();
  }
  return made;
}

std::vector<fs::path> OpenCasesIn(const fs::path& folder) {
  std::vector<fs::path> open;
  for (const fs::path& own : CasesIn(folder))
    if (fs::exists(own / kOutcomeFile) && IsOpen(ReadCase(own), ReadTrialOutcome(own)))
      open.push_back(own);
  return open;
}

void Count(const TrialCase& trial, const FollowUp& made, FollowUpTally* tally) {
  ++tally->cases;
  const bool is_stated = made.outcome.verdict == Verdict::kMissing;
  const bool is_right =
      is_stated && made.outcome.named == std::vector<std::string>{trial.hidden.front().type};
  tally->named += is_right;
  tally->wrong += is_stated && !is_right;
  if (!made.predicted) return;
  ++tally->predicted_cases;
  tally->predicted += *made.predicted;
}

}  // namespace

TrueRecording RecordTruth(const TrialCase& trial, const Protocol& protocol,
                          const PlannedRecording& planned, const Eigen::Vector3d& hold_force,
                          int number, bool rough) {
  const RecordedGrip& clamp = planned.item.recording.object.grips.at(0);
  const std::vector<double>& times = planned.item.recording.times;
  const auto motion_of_clamp = [&](double time) { return MotionAt(clamp, time); };
  const TrialProcedure procedure{times, motion_of_clamp, PlannedHoldForce(protocol, hold_force),
                                 protocol.weight, CellTimes(trial, number, times)};
  const TrueMotion motion = SimulateTruth(trial, procedure, rough);
  TrueRecording recorded{planned.item.recording.markers, {}};
  Markers& markers = recorded.markers;
  markers.positions = SeenMarkers(trial, number, motion, TruePlaces(trial, markers));
  if (trial.load_cell) recorded.reading = CellReading(trial, number, times, motion.forces);
  return recorded;
}

bool IsOpen(const TrialCase& trial, const TrialOutcome& outcome) {
  const std::vector<Verdict> open = {Verdict::kAmbiguous, Verdict::kNoPower, Verdict::kAdequate};
  return trial.group == TrialGroup::kOneEffect && !trial.is_scanned &&
         std::find(open.begin(), open.end(), outcome.verdict) != open.end();
}

std::vector<fs::path> FollowUpFolders(const fs::path& own) {
  return {own / kFollowUpFolder / "best", own / kFollowUpFolder / "random"};
}

bool RunFollowUps(const fs::path& folder, int workers) {
  const std::vector<fs::path> open = OpenCasesIn(folder);
  return WorkOn(open, kFollowUpFile, workers,
                [&](size_t k) { WriteFollowUps(MakeFollowUps(open[k]), open[k]); });
}

void WriteFollowUps(const CaseFollowUps& made, const fs::path& own) {
  const nlohmann::json all = {{"schema_version", 1},
                              {"message", made.message},
                              {"best", ToJson(made.best)},
                              {"random", ToJson(made.random)}};
  WriteFileAtomically(own / kFollowUpFile, all.dump(2) + "\n");
}

std::optional<CaseFollowUps> ReadFollowUps(const fs::path& own) {
  const fs::path file = own / kFollowUpFile;
  if (!fs::exists(file)) return std::nullopt;
  return ReadJsonFile(file, [&](const nlohmann::json& json) {
    return CaseFollowUps{json.at("message"), FromJson(json.at("best"), FollowUpFolders(own)[0]),
                         FromJson(json.at("random"), FollowUpFolders(own)[1])};
  });
}

FollowUpReport ReportFollowUps(const fs::path& folder) {
  FollowUpReport report;
  FollowUpTally best{.choice = "best of the plan"}, random{.choice = "another one at random"};
  for (const fs::path& own : OpenCasesIn(folder)) {
    ++report.open;
    const std::optional<CaseFollowUps> made = ReadFollowUps(own);
    report.waiting += !made;
    if (!made) continue;
    if (!made->best || !made->random) {
      ++report.unpaired;
      continue;
    }
    const TrialCase trial = ReadCase(own);
    Count(trial, *made->best, &best);
    Count(trial, *made->random, &random);
  }
  if (report.waiting < report.open) report.tallies = {best, random};
  return report;
}

std::string FollowUpsInWords(const FollowUpReport& report) {
  if (report.tallies.empty()) return "";
  std::string text = fmt::format(
      "one effect is missing and left open: diagnosed with one more recording\n"
      "  {} cases, {} of them not followed yet, {} without two recordings to compare\n",
      report.open, report.waiting, report.unpaired);
  for (const FollowUpTally& tally : report.tallies) {
    text += fmt::format("  {:54}", tally.choice + ": it is named, and no other");
    if (tally.cases == 0) {
      text += " no such case\n";
      continue;
    }
    text += fmt::format(" {:3} of {:3} ({:.0f} %), another in {}", tally.named, tally.cases,
                        100.0 * tally.named / tally.cases, tally.wrong);
    if (tally.predicted_cases > 0)
      text += fmt::format("; predicted {:.0f} % on average over {} cases",
                          100 * tally.predicted / tally.predicted_cases, tally.predicted_cases);
    text += "\n";
  }
  return text;
}

nlohmann::json FollowUpsToJson(const FollowUpReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (const FollowUpTally& tally : report.tallies)
    rows.push_back({{"choice", tally.choice},
                    {"cases", tally.cases},
                    {"named", tally.named},
                    {"wrong", tally.wrong},
                    {"predicted_cases", tally.predicted_cases},
                    {"predicted", tally.predicted_cases > 0
                                      ? nlohmann::json(tally.predicted / tally.predicted_cases)
                                      : nlohmann::json()}});
  return {{"open", report.open},
          {"waiting", report.waiting},
          {"unpaired", report.unpaired},
          {"recordings", rows}};
}

}  // namespace lacuna
