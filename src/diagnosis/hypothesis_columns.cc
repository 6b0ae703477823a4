#include "diagnosis/hypothesis_columns.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <functional>
#include <utility>

#include "diagnosis/candidates.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/hypothesis_score.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/pilot_hypotheses.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/unknown_force.h"

namespace lacuna {
namespace {

std::vector<LinearPrior> PriorsOfAmounts(const CandidateEffect& candidate) {
  std::vector<LinearPrior> priors;
  for (const CandidateAmount& amount : AmountsOf(candidate))
    priors.push_back({0, amount.plausible, amount.is_positive});
  return priors;
}

// Adds one kind of hypotheses after another. MakeHypothesisColumns() has the order: it is that of
// the columns, and each step may use what stands before it.
class ColumnsBuilder {
 public:
  // `on_frame`: LineariseOptions::on_frame of the model's own prediction.
  ColumnsBuilder(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                 const std::vector<std::string>& without, const SceneColumns& known,
                 const DecidedBase* decided, const std::function<void()>& on_frame);

  void AddParameters();
  void AddDecided();
  // `on_frame`: that of the pilots.
  void AddEffects(const std::function<void()>& on_frame);
  void AddModelNuisances();
  void EstimateNoise();
  void AddGripNuisances();
  void AddRecordingNuisances();
  void AddUnknownForce();
  // Makes the base of the parameters, the nuisances of every model and the decided ones, as far as
  // they have been added.
  void SetBase();

  HypothesisColumns Finish() &&;

 private:
  // A nuisance that an earlier ranking has adopted: with its columns along this motion, or along
  // that of the earlier ranking where it cannot be made anew.
  struct DecidedNuisance {
    const NuisanceCandidate* before;
    std::vector<int> columns;

    bool Is(const NuisanceCandidate& candidate) const {
      return before->card.name == candidate.card.name && before->what == candidate.what;
    }
  };

  // Appends columns and returns their indices.
  std::vector<int> Add(const Eigen::MatrixXd& columns, const std::vector<LinearPrior>& priors);
  void AddNuisance(NuisanceCandidate candidate);
  // The residual, m, after a fit of these columns to white noise.
  Eigen::VectorXd ResidualAfter(const std::vector<int>& chosen) const;

  const CalibrationProblem& problem_;
  const std::vector<std::string>& without_;
  const SceneColumns& known_;
  const DecidedBase* const decided_;
  LinearisedWithGrips linearised_;
  Eigen::MatrixXd grip_columns_;
  std::vector<DecidedNuisance> decided_nuisances_;
  HypothesisColumns all_;
};

ColumnsBuilder::ColumnsBuilder(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                               const std::vector<std::string>& without, const SceneColumns& known,
                               const DecidedBase* decided, const std::function<void()>& on_frame)
    : problem_(problem), without_(without), known_(known), decided_(decided) {
  const PredictionStudy study = problem.StudyAt(values);  // candidates take moduli from its effects
  all_.values = values;
  all_.explained_misfit = study.explained_misfit;
  all_.candidates = MakeCandidates({*problem.body(), study.effects, ScaleOf(study), study.time_step,
                                    Duration(study), without, study.candidates,
                                    GrippedNodes(problem.models().front().model())});
  linearised_ = LineariseWithGrips(problem, values, DirectionsOf(all_.candidates), on_frame);
  CHECK(linearised_.misfit.usable)
      << "the fitted model could be predicted before, but not now: " << linearised_.misfit.message;
  grip_columns_ = linearised_.OfGrips();
}

std::vector<int> ColumnsBuilder::Add(const Eigen::MatrixXd& columns,
                                     const std::vector<LinearPrior>& priors) {
  const Eigen::Index first = all_.columns.cols();
  AppendColumns(columns, priors, &all_.columns, &all_.priors);
  return IndexRange(first, columns.cols());
}

void ColumnsBuilder::AddParameters() {
  all_.parameters = Add(linearised_.misfit.jacobian.leftCols(linearised_.parameters),
                        PriorsAbout(problem_.parameters(), all_.values));
}

void ColumnsBuilder::AddDecided() {
  if (decided_ == nullptr) return;
  for (const ScoredNuisance& nuisance : decided_->ranking.nuisances) {
    const NuisanceCandidate& before = nuisance.candidate;
    if (nuisance.adopted && !before.card.is_always_in_model)
      decided_nuisances_.push_back({&before, Add(before.columns, before.priors)});
  }
}

void ColumnsBuilder::AddEffects(const std::function<void()>& on_frame) {
  const Eigen::MatrixXd columns = linearised_.OfDirections();
  Eigen::Index column = 0;
  for (const CandidateEffect& candidate : all_.candidates) {
    const Eigen::Index width = static_cast<Eigen::Index>(candidate.amplitude.size());
    all_.of_candidate.push_back(Add(columns.middleCols(column, width), PriorsOfAmounts(candidate)));
    column += width;
  }
  all_.scene.pilots =
      known_.pilots ? *known_.pilots
                    : RunPilots(problem_, all_.values, linearised_.misfit, without_, on_frame);
  for (const PilotHypothesis& pilot : all_.scene.pilots->tried) {
    all_.of_candidate.push_back(Add(pilot.change, PriorsOfAmounts(pilot.candidate)));
    all_.candidates.push_back(pilot.candidate);
  }
  all_.untried = all_.scene.pilots->untried;
}

void ColumnsBuilder::AddNuisance(NuisanceCandidate candidate) {
  for (DecidedNuisance& decided : decided_nuisances_) {
    if (!decided.Is(candidate)) continue;
    if (candidate.columns.cols() > 0) decided.columns = Add(candidate.columns, candidate.priors);
    return;
  }
  for (const std::string& recording : candidate.left_out)
    all_.untried.push_back(
        {candidate.card.name, fmt::format("{} has more than {} frames: thin them out with `every`",
                                          recording, kThresholds.nuisances.most_single_frames)});
  // What holds for all recordings is said once.
  const auto is_said = [&](const auto& other) {
    return other.type == candidate.card.name && other.why == candidate.untried;
  };
  if (!candidate.untried.empty() && std::none_of(all_.untried.begin(), all_.untried.end(), is_said))
    all_.untried.push_back({candidate.card.name, candidate.untried});
  if (candidate.columns.cols() == 0) return;
  all_.of_nuisance.push_back(Add(candidate.columns, candidate.priors));
  if (candidate.card.is_always_in_model) all_.always = Joined(all_.always, all_.of_nuisance.back());
  all_.nuisances.push_back(std::move(candidate));
}

void ColumnsBuilder::AddModelNuisances() {
  for (NuisanceCandidate& nuisance :
       ModelNuisances({problem_, all_.values, linearised_.misfit, linearised_.grips, grip_columns_,
                       known_.other_mesh ? &*known_.other_mesh : nullptr},
                      known_.nuisances)) {
    if (nuisance.card.is_shared_in_scene) all_.scene.nuisances.push_back(nuisance);
    AddNuisance(std::move(nuisance));
  }
}

void ColumnsBuilder::EstimateNoise() {
  if (decided_ != nullptr) {
    all_.noise = decided_->noise;
    return;
  }
  // The noise is what remains when every hypothesis explains as much as it can.
  const Eigen::Index count = all_.columns.cols();
  all_.noise = LevelOf(ResidualAfter(IndexRange(0, count)), linearised_.misfit, count,
                       problem_.LeastNoiseVariance());
}

void ColumnsBuilder::AddGripNuisances() {
  for (NuisanceCandidate& nuisance : GripNuisances(linearised_.grips, grip_columns_))
    AddNuisance(std::move(nuisance));
}

void ColumnsBuilder::AddRecordingNuisances() {
  const LinearisedMisfit& misfit = linearised_.misfit;
  const Eigen::VectorXd whitened = WhitenedRows(ResidualAfter(all_.base), misfit,
                                                {.correlation_time = all_.noise.correlation_time});
  for (NuisanceCandidate& nuisance : RecordingNuisances(problem_, misfit, whitened))
    AddNuisance(std::move(nuisance));
}

void ColumnsBuilder::AddUnknownForce() {
  UnknownForce force = UnknownForceColumns(problem_, all_.values, linearised_.misfit);
  all_.unknown_force = std::move(force.columns);
  for (std::string& why : force.untried) all_.untried.push_back({"unknown force", std::move(why)});
}

void ColumnsBuilder::SetBase() {
  all_.base = Joined(all_.parameters, all_.always);
  for (const DecidedNuisance& decided : decided_nuisances_)
    all_.base = Joined(all_.base, decided.columns);
}

Eigen::VectorXd ColumnsBuilder::ResidualAfter(const std::vector<int>& chosen) const {
  const LinearisedMisfit& misfit = linearised_.misfit;
  const Eigen::MatrixXd columns = all_.ColumnsOf(chosen);
  const LinearFit fit = LinearGaussianModel(WhitenedRows(misfit.residual, misfit),
                                            WhitenedRows(columns, misfit), all_.PriorsOf(chosen))
                            .FitAll(1);
  return misfit.residual + columns * fit.change;
}

HypothesisColumns ColumnsBuilder::Finish() && {
  all_.misfit = std::move(linearised_.misfit);
  return std::move(all_);
}

}  // namespace

std::vector<LinearPrior> HypothesisColumns::PriorsOf(const std::vector<int>& indices) const {
  std::vector<LinearPrior> chosen;
  for (const int index : indices) chosen.push_back(priors[static_cast<size_t>(index)]);
  return chosen;
}

HypothesisColumns MakeHypothesisColumns(const CalibrationProblem& problem,
                                        const Eigen::VectorXd& values, Progress* progress,
                                        const std::vector<std::string>& without,
                                        const SceneColumns& known, const DecidedBase* decided) {
  progress->Begin("effects", problem.LinearisedFrames());
  ColumnsBuilder builder(problem, values, without, known, decided, StageCounter(progress));
  progress->Begin("score", 0);
  builder.AddParameters();
  builder.AddDecided();
  builder.AddEffects(StageCounter(progress));
  builder.AddModelNuisances();
  builder.EstimateNoise();
  builder.AddGripNuisances();
  // The nuisances of recordings are made from the residual beside the base: the frame that may be
  // misplaced is the one that stands out when everything that belongs to the model explains what it
  // can. The base must therefore have the nuisances of the model and of the grips by then, and be
  // made again afterwards: nuisances of recordings may belong to it, and one that was decided now
  // has its columns along this motion.
  builder.SetBase();
  builder.AddRecordingNuisances();
  builder.SetBase();
  builder.AddUnknownForce();
  return std::move(builder).Finish();
}

}  // namespace lacuna
