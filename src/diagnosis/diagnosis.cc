#include "diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
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
// The largest number of pairs that FitRivalPairs() fits. Higher: slower, where many members of a
// family explain the same residual.
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

bool IsFitted(const std::vector<FittedPair>& pairs, const std::string& a, const std::string& b) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const FittedPair& one) { return one.IsOf(a, b); });
}

// What the steps below look at, and change.
struct OpenDecision {
  const RefitContext& context;
  const DiagnosisOptions& options;
  RefittedRanking* ranked;
  RefitNoise* noise;
  Diagnosis* diagnosis;
  Decision decision;

  const HypothesisProbability& Best() const { return decision.record.probabilities.front(); }
  void DecideAgain() { decision = RefitWhatIsStated(context, ranked, noise, diagnosis); }
};

// Ranks everything anew along the motion of the refit with this effect. Returns whether there is
// such a refit.
bool LookAlongRefit(const std::string& effect, OpenDecision* open) {
  RefittedRanking& ranked = *open->ranked;
  const std::optional<size_t> k = ranked.FindUsable(effect);
  if (!k) return false;
  LookAlong(
      open->context, effect,
      RankAlong(open->context.model, ranked.effects[*k].scored, ranked.refits[*k],
                open->options.without, DecidedBase{open->context.ranking, open->noise->level}),
      &ranked);
  *open->noise = WeighRefits(open->context, &ranked);
  return true;
}

// Fits the model with a refitted effect and a further one. Returns whether that succeeded.
bool AddPair(const std::string& first, const std::string& further, OpenDecision* open) {
  RefittedRanking& ranked = *open->ranked;
  const std::optional<size_t> k = ranked.FindUsable(first);
  if (!k || !ranked.along) return false;
  std::optional<FittedPair> pair =
      FitPair(open->context.model, ranked.effects[*k].scored, ranked.refits[*k], further,
              *ranked.along, first == ranked.along_type);
  if (pair) ranked.pairs.push_back(*std::move(pair));
  return pair.has_value();
}

// Where an effect is most probable, decides anew with the columns of its own motion and, where that
// is a pair, with the fit of both, until the most probable hypothesis has been looked at in this
// way.
void DecideAlongBest(OpenDecision* open) {
  using Kind = HypothesisProbability::Kind;
  const RefittedRanking& ranked = *open->ranked;
  for (int look = 0; look < kMostLooks; ++look) {
    const HypothesisProbability best = open->Best();
    if (best.kind != Kind::kEffect && best.kind != Kind::kPair) break;
    if (!ranked.along || !best.Contains(ranked.along_type)) {
      if (!LookAlongRefit(best.names.front(), open)) break;
    } else if (best.kind == Kind::kPair && !IsFitted(ranked.pairs, best.names[0], best.names[1])) {
      const bool is_first = best.names[0] == ranked.along_type;
      if (!AddPair(ranked.along_type, best.names[is_first ? 1 : 0], open)) break;
    } else {
      break;
    }
    open->DecideAgain();
  }
}

// Two effects that may explain the same residual as a pair that was fitted.
struct RivalPair {
  std::string first, further;
  double lost =
      0;  // evidence that replacing one effect of that pair costs, to first order or alone
};

// The pairs in which another effect of its family replaces one effect of `pair`, and which have not
// been fitted, the most promising first. The first effect of each has a refit.
std::vector<RivalPair> RivalsOf(const HypothesisProbability& pair, const RefittedRanking& ranked,
                                const std::map<std::string, EffectFamily>& families) {
  const auto first_order = [&](const std::string& type) {
    for (const ScoredEffect& effect : ranked.along->effects)
      if (effect.candidate.type == type) return effect.score.evidence;
    return 0.0;
  };
  const auto alone = [&](const std::string& type) {
    const std::optional<size_t> k = ranked.FindUsable(type);
    return k ? ranked.effects[*k].evidence : 0.0;
  };
  std::vector<RivalPair> rivals;
  for (const size_t at : {0u, 1u}) {
    const std::string &replaced = pair.names[at], &kept = pair.names[1 - at];
    const EffectFamily family = FamilyOf(families, replaced);
    if (family == EffectFamily::kOther) continue;
    for (const RankedEffect& other : ranked.effects) {
      const std::string& type = other.scored.candidate.type;
      if (pair.Contains(type) || FamilyOf(families, type) != family ||
          IsFitted(ranked.pairs, kept, type) || (other.HasUsableRefit() && !other.predicts))
        continue;
      if (kept == ranked.along_type) {
        if (first_order(type) >= kThresholds.refit.least_evidence)
          rivals.push_back({kept, type, first_order(replaced) - first_order(type)});
      } else if (other.HasUsableRefit()) {
        rivals.push_back({type, kept, alone(replaced) - alone(type)});
      }
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const RivalPair& a, const RivalPair& b) { return a.lost < b.lost; });
  return rivals;
}

// If the most probable hypothesis is a pair that was fitted, fits its rivals as well, because a fit
// explains more than the first-order estimate of a rival.
void FitRivalPairs(OpenDecision* open) {
  const RefittedRanking& ranked = *open->ranked;
  std::vector<RivalPair> failed;
  for (int fits = 0; fits < kMostRivalPairs && ranked.along; ++fits) {
    const HypothesisProbability best = open->Best();
    if (best.kind != HypothesisProbability::Kind::kPair) break;
    // Another pair may have become the most probable one.
    std::vector<RivalPair> next{{best.names[0], best.names[1]}};
    if (IsFitted(ranked.pairs, best.names[0], best.names[1]))
      next = RivalsOf(best, ranked, open->diagnosis->decision_input.families);
    std::erase_if(next, [&](const RivalPair& one) {
      return std::any_of(failed.begin(), failed.end(), [&](const RivalPair& other) {
        return one.first == other.first && one.further == other.further;
      });
    });
    if (next.empty()) break;
    if (AddPair(next.front().first, next.front().further, open))
      open->DecideAgain();
    else
      failed.push_back(next.front());
  }
}

// Looks closer where that may change the decision: along the motion of the best effect, at pairs
// that could be taken for the best one and, where nuisances explain the residual, at effects in
// their place.
void DecideUpon(const RefitContext& context, const DiagnosisOptions& options,
                RefittedRanking* ranked, RefitNoise* noise, Diagnosis* diagnosis) {
  OpenDecision open{context, options, ranked, noise, diagnosis, {}};
  open.DecideAgain();
  DecideAlongBest(&open);
  FitRivalPairs(&open);
  Decision& decision = open.decision;
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
