#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibration/calibration_fits.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_maker.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/nuisance_refits.h"
#include "diagnosis/open_decision.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/recording_power.h"
#include "diagnosis/refit_comparison.h"
#include "diagnosis/refits.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/step_refinement.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/variant_refit.h"
#include "diagnosis/verdict.h"

namespace lacuna {
namespace {

// What all steps of a diagnosis share.
struct DiagnosisSetting {
  const DiagnosisOptions& options;
  Progress* progress;
  FitStore* kept;
};

// The study, restricted to the first part of each fitted recording.
PredictionStudy EarlyPart(const CalibrationProblem& problem) {
  PredictionStudy early = problem.WithEstimatedNoise();
  for (PredictedRecording& item : early.recordings) {
    const std::vector<double>& times = item.recording.times;
    const double start = item.StartTime();
    const double end = start + kThresholds.refit.early_share *
                                   (std::min(item.fit_until, times[item.frames.back()]) - start);
    std::erase_if(item.frames, [&](int frame) { return times[frame] > end; });
  }
  std::erase_if(early.recordings, [](const PredictedRecording& item) { return !item.fitted; });
  return early;
}

// The effects ranked along a fit of the early part; none if that cannot be fitted. `whole`: the
// ranking of all frames.
std::vector<ScoredEffect> RankEarly(const CalibrationProblem& problem,
                                    const Eigen::VectorXd& values, const EffectRanking& whole,
                                    const DiagnosisSetting& setting) {
  const PredictionStudy early = EarlyPart(problem);
  const CalibrationProblem of_early(early, problem.body()->mesh);
  const Calibration first = FitFromStart(of_early, setting.progress);
  std::vector<ScoredEffect> found;
  if (first.parameters.size() == values.size())
    found = RankEffects(of_early, first.parameters, setting.progress, setting.options.without,
                        whole.scene.ForFirstFrames(whole.misfit.parts, early.recordings))
                .effects;
  return found;
}

// The effects whose power is simulated: those that were refitted, the most probable first.
std::vector<std::string> EffectsOfInterest(const Decision& decision, const DecisionInput& input) {
  constexpr size_t kMost = 4;
  std::vector<std::string> effects;
  for (const HypothesisProbability& one : decision.record.probabilities) {
    const bool refitted =
        one.kind == HypothesisProbability::Kind::kEffect &&
        std::any_of(input.refits.begin(), input.refits.end(),
                    [&](const WeighedRefit& refit) { return refit.effect == one.names.front(); });
    // An effect stands in several hypotheses: alone, and with a nuisance.
    if (refitted && effects.size() < kMost &&
        std::count(effects.begin(), effects.end(), one.names.front()) == 0)
      effects.push_back(one.names.front());
  }
  return effects;
}

// Looks closer where that may change the decision: along the motion of the best effect, at pairs
// that could be taken for the best one and, where nuisances explain the residual, at effects in
// their place.
void DecideUpon(const RefitContext& context, const DiagnosisOptions& options,
                RefittedRanking ranked, const RefitNoise& noise, Diagnosis* diagnosis) {
  OpenDecision open{context, options.without, std::move(ranked), noise, context.ranking.nuisances};
  open.DecideAgain();
  RankAlongBest(&open);
  FitRivalPairs(&open);
  Decision decision = Decide(open.input);
  if (decision.verdict == Verdict::kNuisance && context.ranking.adopted.HasMore()) {
    diagnosis->alternatives =
        RefitInPlaceOfNuisances(context, open.ranked, open.noise, options.refits);
    AddAlternatives(diagnosis->alternatives, &open.input);
    decision = Decide(open.input);
  }
  const std::vector<std::string> effects = EffectsOfInterest(decision, open.input);
  decision.record.power = SimulatePower(open.input, effects);
  decision.record.separations = Separations(open.input, effects);
  diagnosis->noise_level = open.noise.level;
  diagnosis->best_rms_over_sigma = open.noise.least_rms_over_sigma;
  diagnosis->ranking = std::move(open.ranked.effects);
  diagnosis->nuisances = std::move(open.nuisances);
  diagnosis->decision_input = std::move(open.input);
  Conclude(decision, diagnosis);
}

Diagnosis DiagnoseRanked(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                         EffectRanking ranking, const DiagnosisSetting& setting) {
  const DiagnosisOptions& options = setting.options;
  Diagnosis diagnosis;
  diagnosis.noise = problem.noise();
  diagnosis.scan_noise = problem.scan_noise();
  diagnosis.time_step = problem.study().time_step;
  diagnosis.errors = ErrorsOf(problem, fitted, &ranking.misfit);
  diagnosis.scored = ranking.variants;
  diagnosis.untried = std::move(ranking.untried);
  diagnosis.agreement = ranking.agreement;

  const BaselineModel model =
      RankedBaseline(problem, fitted, ranking, setting.progress, setting.kept);
  const RefitContext context{model, ranking};
  RefittedRanking ranked = StartRefits(context, ranking.effects, options.refits);
  diagnosis.errors.without_nuisances = ranked.baseline.errors.without_nuisances;
  diagnosis.baseline_rms_over_sigma = RmsOverSigma(ranked.baseline.hypothesis);
  RefitAll(context, MostPromising(ranked.effects, options.refits), &ranked);
  // A refit that comes down to the noise shows that first order led to the right minimum.
  const bool is_found =
      WeighRefits(context, &ranked).least_rms_over_sigma <= kThresholds.refit.rms_at_noise;
  if (diagnosis.baseline_rms_over_sigma > kFarFromTruth && !is_found) {
    RefitAsRankedEarly(context, RankEarly(problem, fitted, ranking, setting), options.refits,
                       &ranked);
    WeighRefits(context, &ranked);
  }
  RefitAll(context, LookAlikesOfBest(ranked.effects), &ranked);
  const RefitNoise noise = WeighRefits(context, &ranked);
  RefitRivalNuisances(context, &ranked);
  DecideUpon(context, options, std::move(ranked), noise, &diagnosis);
  return diagnosis;
}

}  // namespace

Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, FitStore* kept,
                   const std::optional<OtherMesh>& other_mesh) {
  const DiagnosisSetting setting{options, progress, kept};
  SceneColumns known;
  known.other_mesh = other_mesh;
  EffectRanking ranking = RankEffects(problem, fitted, progress, options.without, known);
  std::optional<ShorterStep> shorter;
  if (problem.study().chooses_time_step) shorter = ShortenStep(problem, fitted, ranking, progress);
  if (!shorter) return DiagnoseRanked(problem, fitted, std::move(ranking), setting);
  ranking = RankEffects(*shorter->problem, shorter->values, progress, options.without,
                        ranking.scene.ForOtherStep());
  return DiagnoseRanked(*shorter->problem, shorter->values, std::move(ranking), setting);
}

DecisionInput FirstOrderInput(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                              Progress* progress) {
  const EffectRanking ranking = RankEffects(problem, fitted, progress);
  const BaselineModel model = RankedBaseline(problem, fitted, ranking, progress);
  const RefitContext context{model, ranking};
  const RefittedRanking ranked = StartRefits(context, ranking.effects, 0);
  // Without a refit, the residual may contain the effect that is missing. The noise of the ranking
  // is what remains when every hypothesis explains as much as it can.
  const RefitNoise noise{ranking.noise, 0};
  return MakeDecisionInput(context, ranked, noise, ranking.nuisances);
}

}  // namespace lacuna
