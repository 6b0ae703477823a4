#include "diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "calibration/calibration_fits.h"
#include "diagnosis/decision_maker.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/pair_refit.h"
#include "diagnosis/recording_power.h"
#include "diagnosis/refits.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/verdict.h"

namespace lacuna {
namespace {

// DecideAlongBest() computes columns anew or fits a pair so many times at most. Higher: slower,
// where several hypotheses are nearly equal.
constexpr int kMostLooks = 4;
// So many pairs are fitted, at most, that could be taken for the most probable one. Higher: slower,
// where many members of a family explain the same residual.
constexpr int kMostRivalPairs = 3;
// A halving of the time step divides the evidence of the unknown part of its error by about this
// number: an error of second order becomes a quarter, and evidence grows with its square.
constexpr double kEvidencePerHalving = 16;

// What all steps of a diagnosis share.
struct DiagnosisSetting {
  const DiagnosisOptions& options;
  Progress* progress;
  RefitStore* kept;
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

// By how many halvings the time step is too long: 0 unless there is evidence for an effect which
// the unknown part of the step's error could explain. A step whose unknown error is smaller than
// that of the elements is short enough: what remains unknown is then that of the elements, however
// short the step.
int HalvingsNeeded(const EffectRanking& ranking) {
  double of_step = 0, of_others = 0;
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    (nuisance.candidate.card.shrinks_with_time_step ? of_step : of_others) +=
        nuisance.uncertain_evidence;
  const double tolerated = std::max(kThresholds.refit.uncertain_step_evidence, of_others);
  if (!(of_step > tolerated) || ranking.effects.empty() ||
      ranking.effects.front().score.evidence <= kThresholds.refit.least_evidence)
    return 0;
  return std::max(1, static_cast<int>(std::floor(std::log(of_step / tolerated) /
                                                 std::log(kEvidencePerHalving))));
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
    if (refitted && effects.size() < kMost) effects.push_back(one.names.front());
  }
  return effects;
}

// The effects that the hypotheses of a statement contain, but that were not refitted.
std::vector<size_t> WithoutRefit(const Decision& decision, const RefittedRanking& ranked) {
  std::vector<size_t> effects;
  for (const size_t k : NameFrom(decision.record.probabilities).kept)
    for (const std::string& name : decision.record.probabilities[k].names)
      for (size_t e = 0; e < ranked.effects.size(); ++e)
        if (ranked.effects[e].scored.candidate.type == name && !ranked.effects[e].refitted)
          effects.push_back(e);
  return effects;
}

// Refits what the decision would state without a refit, and so on: only refits are believed.
// Returns the decision, and sets the noise and the input that belong to it.
Decision RefitWhatIsStated(const RefitContext& context, RefittedRanking* ranked, RefitNoise* noise,
                           Diagnosis* diagnosis) {
  for (;;) {
    WeighNuisances(*ranked, *noise, &diagnosis->nuisances);
    diagnosis->decision_input = MakeDecisionInput(context, *ranked, *noise, *diagnosis);
    Decision decision = Decide(diagnosis->decision_input);
    const int before = ranked->count;
    RefitAll(context, WithoutRefit(decision, *ranked), ranked);
    if (ranked->count == before) return decision;
    *noise = WeighRefits(context, ranked);
  }
}

bool IsRefitted(const std::vector<WeighedPair>& pairs, const std::string& a, const std::string& b) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const WeighedPair& one) { return one.IsOf(a, b); });
}

// The index of the effect of this type, if it has a usable refit.
std::optional<size_t> FindUsableRefit(const RefittedRanking& ranked, const std::string& type) {
  for (size_t k = 0; k < ranked.effects.size(); ++k)
    if (ranked.effects[k].scored.candidate.type == type && ranked.IsUsable(k)) return k;
  return std::nullopt;
}

// The refit with this effect, as a model along whose motion everything is ranked anew; null: there
// is no such refit.
std::unique_ptr<RefittedModel> ModelWith(const std::string& effect, const RefitContext& context,
                                         const RefittedRanking& ranked, const NoiseLevel& noise,
                                         const DiagnosisOptions& options) {
  const std::optional<size_t> k = FindUsableRefit(ranked, effect);
  if (!k) return nullptr;
  return std::make_unique<RefittedModel>(context.model, ranked.effects[*k].scored,
                                         ranked.refits[*k], options.without,
                                         DecidedBase{context.ranking, noise});
}

// Fits the model with a further effect. Returns whether that succeeded.
bool FitPair(const RefittedModel& model, const std::string& further, const NoiseLevel& noise,
             RefittedRanking* ranked) {
  const std::optional<size_t> first = FindUsableRefit(*ranked, model.effect());
  if (!first) return false;
  const double alone = EvidenceOf(ranked->refits[*first], noise).all;
  std::optional<WeighedPair> pair = model.RefitWith(further, alone, noise);
  if (pair) ranked->pairs.push_back(*std::move(pair));
  return pair.has_value();
}

// Where an effect is most probable, decides anew with the columns of its own motion and, where that
// is a pair, with the fit of both, until the most probable hypothesis has been looked at in this
// way. Sets the noise and the input that belong to the decision.
Decision DecideAlongBest(const RefitContext& context, const DiagnosisOptions& options,
                         Decision decision, RefittedRanking* ranked, RefitNoise* noise,
                         Diagnosis* diagnosis) {
  using Kind = HypothesisProbability::Kind;
  std::unique_ptr<RefittedModel> model;
  for (int look = 0; look < kMostLooks; ++look) {
    const HypothesisProbability best = decision.record.probabilities.front();
    if (best.kind != Kind::kEffect && best.kind != Kind::kPair) break;
    if (model == nullptr || !best.Contains(model->effect())) {
      model = ModelWith(best.names.front(), context, *ranked, noise->level, options);
      if (model == nullptr) break;
      LookAlong(context, model->effect(), model->ranking(), ranked);
      *noise = WeighRefits(context, ranked);
    } else if (best.kind == Kind::kPair &&
               !IsRefitted(ranked->pairs, best.names[0], best.names[1])) {
      const std::string& further = best.names[0] == model->effect() ? best.names[1] : best.names[0];
      if (!FitPair(*model, further, noise->level, ranked)) break;
    } else {
      break;
    }
    decision = RefitWhatIsStated(context, ranked, noise, diagnosis);
  }
  return decision;
}

// A pair that could be taken for another one: `other` in place of the effect that is not `kept`.
struct RivalPair {
  std::string kept, other;
  double evidence = 0;  // of `other` alone
};

// The pairs in which another member of its family stands in place of one effect of `pair`, the most
// probable members first. Members that have not been refitted, or that are refuted, do not count.
std::vector<RivalPair> RivalsOf(const HypothesisProbability& pair, const RefittedRanking& ranked,
                                const std::map<std::string, EffectFamily>& families) {
  std::vector<RivalPair> rivals;
  for (const bool first : {true, false}) {
    const std::string &replaced = pair.names[first ? 0 : 1], &kept = pair.names[first ? 1 : 0];
    const EffectFamily family = FamilyOf(families, replaced);
    if (family == EffectFamily::kOther) continue;
    for (size_t k = 0; k < ranked.effects.size(); ++k) {
      const RankedEffect& effect = ranked.effects[k];
      const std::string& type = effect.scored.candidate.type;
      if (ranked.IsUsable(k) && effect.predicts && !pair.Contains(type) &&
          FamilyOf(families, type) == family)
        rivals.push_back({kept, type, effect.evidence});
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const RivalPair& a, const RivalPair& b) { return a.evidence > b.evidence; });
  return rivals;
}

// A pair that was fitted has the advantage of the fit over those that first order weighs. If one is
// most probable, fits its rivals, too.
Decision FitRivalPairs(const RefitContext& context, const DiagnosisOptions& options,
                       Decision decision, RefittedRanking* ranked, RefitNoise* noise,
                       Diagnosis* diagnosis) {
  std::set<std::set<std::string>> tried;
  while (tried.size() < kMostRivalPairs) {
    const HypothesisProbability best = decision.record.probabilities.front();
    if (best.kind != HypothesisProbability::Kind::kPair ||
        !IsRefitted(ranked->pairs, best.names[0], best.names[1]))
      break;
    const std::vector<RivalPair> rivals =
        RivalsOf(best, *ranked, diagnosis->decision_input.families);
    const auto next = std::find_if(rivals.begin(), rivals.end(), [&](const RivalPair& rival) {
      return !IsRefitted(ranked->pairs, rival.kept, rival.other) &&
             tried.count({rival.kept, rival.other}) == 0;
    });
    if (next == rivals.end()) break;
    tried.insert({next->kept, next->other});
    const auto model = ModelWith(next->other, context, *ranked, noise->level, options);
    if (FitPair(*model, next->kept, noise->level, ranked))
      decision = RefitWhatIsStated(context, ranked, noise, diagnosis);
  }
  return decision;
}

// Looks closer where that may change the decision: along the motion of the best effect, at pairs
// that could be taken for the best one and, where nuisances explain the residual, at effects in
// their place.
void DecideUpon(const RefitContext& context, const DiagnosisOptions& options,
                RefittedRanking* ranked, RefitNoise* noise, Diagnosis* diagnosis) {
  Decision decision = RefitWhatIsStated(context, ranked, noise, diagnosis);
  decision = DecideAlongBest(context, options, std::move(decision), ranked, noise, diagnosis);
  decision = FitRivalPairs(context, options, std::move(decision), ranked, noise, diagnosis);
  DecisionInput& input = diagnosis->decision_input;
  if (decision.verdict == Verdict::kNuisance && context.ranking.adopted.HasMore()) {
    diagnosis->alternatives = RefitInPlaceOfNuisances(context, *ranked, *noise, options.refits);
    AddAlternatives(diagnosis->alternatives, &input);
    decision = Decide(input);
  }
  const std::vector<std::string> effects = EffectsOfInterest(decision, input);
  decision.record.power = SimulatePower(input, effects);
  decision.record.separations = Separations(input, effects);
  diagnosis->noise_level = noise->level;
  diagnosis->best_rms_over_sigma = noise->least_rms_over_sigma;
  diagnosis->ranking = ranked->effects;
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
      WeighRefits(context, &ranked).least_rms_over_sigma <= kThresholds.refit.converged_rms;
  if (diagnosis.baseline_rms_over_sigma > kFarFromTruth && !is_found) {
    RefitAsRankedEarly(context, RankEarly(problem, fitted, ranking, setting), options.refits,
                       &ranked);
    WeighRefits(context, &ranked);
  }
  RefitAll(context, LookAlikesOfBest(ranked.effects), &ranked);
  RefitNoise noise = WeighRefits(context, &ranked);
  RefitRivalNuisances(context, &ranked);
  diagnosis.nuisances = ranking.nuisances;
  DecideUpon(context, options, &ranked, &noise, &diagnosis);
  return diagnosis;
}

Diagnosis DiagnoseWithHalvings(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                               int halvings, const DiagnosisSetting& setting,
                               const SceneColumns& known);

// Fits and diagnoses the study with a time step halved `now` times, and up to `most` times if that
// is not enough; nothing if it cannot be fitted. `scene`: of the study's ranking.
std::optional<Diagnosis> DiagnoseWithShorterStep(const CalibrationProblem& problem,
                                                 const Eigen::VectorXd& fitted, int now, int most,
                                                 const DiagnosisSetting& setting,
                                                 const SceneColumns& scene) {
  PredictionStudy study = problem.WithEstimatedNoise();
  study.time_step = std::ldexp(study.time_step, -now);
  setting.progress->Begin("time step", 0);
  setting.progress->End(
      fmt::format("{:.3g} ms, because the error of steps of {:.3g} ms could look like an effect",
                  1e3 * study.time_step, 1e3 * problem.study().time_step));
  const CalibrationProblem shorter(study, problem.body()->mesh);
  const Calibration fit = RefineFit(shorter, fitted, setting.progress);
  if (fit.parameters.size() != fitted.size()) return std::nullopt;
  return DiagnoseWithHalvings(shorter, fit.parameters, most - now, setting, scene.ForOtherStep());
}

Diagnosis DiagnoseWithHalvings(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                               int halvings, const DiagnosisSetting& setting,
                               const SceneColumns& known) {
  EffectRanking ranking =
      RankEffects(problem, fitted, setting.progress, setting.options.without, known);
  if (problem.study().chooses_time_step)
    if (const int now = std::min(halvings, HalvingsNeeded(ranking)); now > 0)
      if (auto diagnosis =
              DiagnoseWithShorterStep(problem, fitted, now, halvings, setting, ranking.scene))
        return *std::move(diagnosis);
  return DiagnoseRanked(problem, fitted, std::move(ranking), setting);
}

}  // namespace

Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, RefitStore* kept,
                   const Eigen::VectorXd& at_mesh_limit) {
  SceneColumns known;
  known.at_mesh_limit = at_mesh_limit;
  return DiagnoseWithHalvings(problem, fitted, kThresholds.refit.most_halvings,
                              {options, progress, kept}, known);
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
  Diagnosis diagnosis;
  diagnosis.nuisances = ranking.nuisances;
  return MakeDecisionInput(context, ranked, noise, diagnosis);
}

}  // namespace lacuna
