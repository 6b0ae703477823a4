#include "trials/follow_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/workers.h"
#include "diagnosis/decision_store.h"
#include "plan/planned_experiment.h"
#include "plan/planned_recording.h"
#include "plan/planner.h"
#include "prediction/prediction_study_reader.h"
#include "scan/marker_frames.h"
#include "scan/random_bits.h"
#include "scan/recorded_grip.h"
#include "trials/trial_recording.h"
#include "trials/trial_simulation.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kRandomProtocol = 80;  // stream of draws
// Numbers of the recordings, which draw their noise: a case has up to two of its own.
constexpr int kBestNumber = 2, kRandomNumber = 3;

fs::path FolderOf(const fs::path& own) { return own / "follow_up"; }

// A case whose model was fitted, with its plan.
struct PlannedCase {
  TrialCase trial;
  FittedRun fitted;
  double time_step = 0;  // s, of the diagnosis
  std::vector<Protocol> protocols;
  PlanRecord plan;
};

PlannedCase Plan(const fs::path& own) {
  Progress progress({.style = ProgressStyle::kSilent});
  PlannedCase planned;
  planned.trial = LoadCase(own / "truth.json");
  PredictionStudy study = ReadPredictionStudy(Config::Load(own / "experiment.yaml"));
  study.output = FolderOf(own) / "fit";
  RunCalibration(study, &progress);
  planned.fitted = OpenRun(study.output);
  const DiagnosisRecord diagnosis = ReadDiagnosisFile(own / "diagnosis.json");
  planned.time_step = diagnosis.time_step;
  planned.protocols = StockProtocols(planned.fitted.study, planned.fitted.mesh);
  const DecisionInput decision = LoadDecisionInput(DecisionOf(own));
  planned.plan = MakePlan({planned.fitted, diagnosis, decision}, planned.protocols, &progress);
  return planned;
}

// Another recording of the plan that lasts as long as the best one; null: there is none.
const PlannedOutcome* ChooseAtRandom(const PlannedCase& planned) {
  const std::vector<PlannedOutcome>& all = planned.plan.outcomes;
  std::vector<const PlannedOutcome*> others;
  for (const PlannedOutcome& outcome : all)
    if (&outcome != &all.front() && outcome.IsPlayable() &&
        std::abs(outcome.seconds - all.front().seconds) < 0.5 * kTrialSpacing)
      others.push_back(&outcome);
  if (others.empty()) return nullptr;
  return others[RandomBits({planned.trial.seed, kRandomProtocol}) % others.size()];
}

// The places of the markers on the true bar: those that the case has, then those that the protocol
// adds where the model has them.
Eigen::Matrix3Xd TruePlaces(const TrialCase& trial, const Markers& markers) {
  const Eigen::Vector3d stretch = trial.true_size.cwiseQuotient(trial.size);
  Eigen::Matrix3Xd places = stretch.asDiagonal() * markers.places;
  const Eigen::Matrix3Xd own = MarkerPlaces(trial.true_size);
  places.leftCols(own.cols()) = own;
  return places;
}

// Makes the recording of the true bar and diagnoses it together with those of the case.
FollowUp Follow(const PlannedCase& planned, const PlannedOutcome& outcome, int number,
                const fs::path& own, const fs::path& folder) {
  const Protocol& protocol =
      *std::find_if(planned.protocols.begin(), planned.protocols.end(),
                    [&](const Protocol& one) { return one.name == outcome.name; });
  WritePlannedExperiment(planned.fitted, planned.time_step, protocol, folder);
  // As docs/plan.md tells the user: what was measured replaces what was predicted.
  fs::remove_all(folder / "measured");
  fs::copy(folder / "predicted", folder / "measured");
  const PredictionStudy& study = planned.fitted.study;
  WriteMarkerFrames(folder / "measured",
                    PlanRecording(protocol, study, planned.fitted.mesh).item.recording.times,
                    RecordTruth(planned.trial, protocol, study, planned.fitted.mesh, number));

  FollowUp made;
  made.protocol = outcome.name;
  made.predicted = outcome.probability;
  for (size_t k = 0; k < planned.plan.rivals.size(); ++k)
    if (planned.trial.Hides(planned.plan.rivals[k].effect))
      made.predicted_for_truth = outcome.named[k];
  made.outcome = RunCase(own, folder / "experiment.yaml", folder);
  SaveOutcome(made.outcome, folder / "outcome.json");
  return made;
}

fs::path FileOf(const fs::path& own) { return FolderOf(own) / "follow_up.json"; }

nlohmann::json ToJson(const std::optional<FollowUp>& made, const std::string& folder) {
  if (!made) return {};
  return {
      {"protocol", made->protocol},
      {"predicted", made->predicted},
      {"predicted_for_truth",
       made->predicted_for_truth ? nlohmann::json(*made->predicted_for_truth) : nlohmann::json()},
      {"folder", folder}};
}

std::optional<FollowUp> FromJson(const nlohmann::json& json, const fs::path& folder) {
  if (json.is_null()) return std::nullopt;
  FollowUp made;
  made.protocol = json.at("protocol");
  made.predicted = json.at("predicted");
  if (!json.at("predicted_for_truth").is_null())
    made.predicted_for_truth = json.at("predicted_for_truth");
  made.outcome = LoadOutcome(folder / json.at("folder").get<std::string>() / "outcome.json");
  return made;
}

void SaveFollowUps(const CaseFollowUps& made, const fs::path& own) {
  const nlohmann::json all = {{"schema_version", 1},
                              {"message", made.message},
                              {"best", ToJson(made.best, "best")},
                              {"random", ToJson(made.random, "random")}};
  WriteFileAtomically(FileOf(own), all.dump(2) + "\n");
}

CaseFollowUps MakeFollowUps(const fs::path& own) {
  CaseFollowUps made;
  try {
    const PlannedCase planned = Plan(own);
    const PlannedOutcome& best = planned.plan.outcomes.front();
    if (!best.IsPlayable()) throw InputError("no recording of the plan can be played");
    made.best = Follow(planned, best, kBestNumber, own, FolderOf(own) / "best");
    if (const PlannedOutcome* random = ChooseAtRandom(planned))
      made.random = Follow(planned, *random, kRandomNumber, own, FolderOf(own) / "random");
  } catch (const InputError& problem) {
    made.message = problem.what();
  }
  return made;
}

void Count(const TrialCase& trial, const FollowUp& made, FollowUpTally* tally) {
  ++tally->cases;
  tally->predicted += made.predicted;
  const bool is_stated = made.outcome.verdict == Verdict::kMissing;
  const bool is_right =
      is_stated && made.outcome.named == std::vector<std::string>{trial.hidden.front().type};
  tally->named += is_right;
  tally->wrong += is_stated && !is_right;
}

}  // namespace

Markers RecordTruth(const TrialCase& trial, const Protocol& protocol, const PredictionStudy& study,
                    const TetMesh& mesh, int number, bool rough) {
  const PlannedRecording planned = PlanRecording(protocol, study, mesh);
  const auto changed =
      std::find_if(study.recordings.begin(), study.recordings.end(),
                   [&](const PredictedRecording& item) { return item.name == protocol.recording; });
  const Eigen::Vector3d& force =
      trial.hold_forces.at(static_cast<size_t>(changed - study.recordings.begin()));
  const RecordedGrip& clamp = planned.item.recording.object.grips.at(0);
  TrialProcedure procedure{planned.item.recording.times,
                           [&](double time) { return MotionAt(clamp, time); },
                           PlannedHoldForce(protocol, force)};
  if (protocol.weight)
    procedure.weight = {protocol.weight->mass, protocol.weight->place, protocol.weight->radius};
  Markers markers = planned.item.recording.markers;
  markers.positions = SeenMarkers(trial, number, SimulateTruth(trial, procedure, rough),
                                  TruePlaces(trial, markers));
  return markers;
}

bool IsOpen(const TrialCase& trial, const TrialOutcome& outcome) {
  const std::vector<Verdict> open = {Verdict::kAmbiguous, Verdict::kNoPower, Verdict::kAdequate};
  return trial.group == "one_effect" && !trial.is_scanned &&
         std::find(open.begin(), open.end(), outcome.verdict) != open.end();
}

int RunFollowUps(const fs::path& folder, int workers) {
  std::vector<fs::path> open;
  for (const fs::path& own : CasesIn(folder))
    if (fs::exists(own / "outcome.json") &&
        IsOpen(LoadCase(own / "truth.json"), LoadOutcome(own / "outcome.json")))
      open.push_back(own);
  const auto keep_failure = [&](size_t k, const std::string& reason) {
    SaveFollowUps({.message = reason, .best = {}, .random = {}}, open[k]);
  };
  return ShareOut(open.size(), {.workers = workers, .crashed = keep_failure}, [&](size_t k) {
    MakeFolder(FolderOf(open[k]));
    const Claim claim(FolderOf(open[k]) / "claimed");
    if (!claim.holds() || fs::exists(FileOf(open[k]))) return;
    SaveFollowUps(MakeFollowUps(open[k]), open[k]);
  });
}

std::optional<CaseFollowUps> LoadFollowUps(const fs::path& own) {
  std::ifstream stream(FileOf(own));
  if (!stream) return std::nullopt;
  try {
    const auto json = nlohmann::json::parse(stream);
    return CaseFollowUps{json.at("message"), FromJson(json.at("best"), FolderOf(own)),
                         FromJson(json.at("random"), FolderOf(own))};
  } catch (const nlohmann::json::exception& problem) {
    throw InputError(fmt::format("{}: {}", FileOf(own).string(), problem.what()));
  }
}

FollowUpReport ReportFollowUps(const fs::path& folder) {
  FollowUpReport report;
  FollowUpTally best{.choice = "best of the plan"}, random{.choice = "random"};
  for (const fs::path& own : CasesIn(folder)) {
    const std::optional<CaseFollowUps> made = LoadFollowUps(own);
    if (!made) continue;
    const TrialCase trial = LoadCase(own / "truth.json");
    ++report.open;
    report.not_made += !made->best;
    if (made->best) Count(trial, *made->best, &best);
    if (made->random) Count(trial, *made->random, &random);
  }
  if (report.open > 0) report.tallies = {best, random};
  return report;
}

std::string FollowUpsInWords(const FollowUpReport& report) {
  if (report.tallies.empty()) return "";
  std::string text = fmt::format(
      "one effect is missing and left open: diagnosed with one more recording\n"
      "  {} cases, {} of them without a further recording\n",
      report.open, report.not_made);
  for (const FollowUpTally& tally : report.tallies) {
    text += fmt::format("  {:54}", tally.choice + ": it is named, and no other");
    if (tally.cases == 0) {
      text += " no such case\n";
      continue;
    }
    text += fmt::format(" {:3} of {:3} ({:.0f} %), another in {}; predicted {:.0f} %\n",
                        tally.named, tally.cases, 100.0 * tally.named / tally.cases, tally.wrong,
                        100 * tally.predicted / tally.cases);
  }
  return text;
}

nlohmann::json FollowUpsToJson(const FollowUpReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (const FollowUpTally& tally : report.tallies)
    rows.push_back({{"choice", tally.choice},
                    {"cases", tally.cases},
                    {"predicted", tally.cases > 0 ? tally.predicted / tally.cases : 0},
                    {"named", tally.named},
                    {"wrong", tally.wrong}});
  return {{"open", report.open}, {"not_made", report.not_made}, {"recordings", rows}};
}

}  // namespace lacuna
