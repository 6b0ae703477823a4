#include "diagnosis/diagnosis.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/calibration_fits.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/verdict.h"

namespace lacuna {
namespace {

// Evidence below which an effect is not worth a refit, and how far behind the best one it may be
// where first order need not be trusted.
constexpr double kNoEvidence = 3;
constexpr double kCloseBehind = 5;
// First order errs by a part of the evidence: on the silicone beam, gravity came fifth with 90 % of
// the third's.
constexpr double kNearlyAsGood = 0.8;
constexpr int kMostRefits = 6;
// A nuisance that has this part of the best effect's evidence, both to first order, is fitted with
// the model too: neither is judged by a promise. The most that are.
constexpr double kRivalNuisance = 0.5;
constexpr int kMostRivalNuisances = 3;
// What has less than this part of the nuisances' evidence to first order is not tried in their
// place.
constexpr double kCouldDoAsMuch = 0.5;

// A step that could lend evidence is halved so many times at most.
constexpr int kMostHalvings = 3;

// What the best refits leave is looked at again in so many, no farther than this behind the best.
constexpr int kMostLooks = 3;
constexpr double kMayBeAsGood = 10;

// A model that is far off is looked at early, too, before it has gone astray, over this part of the
// fitted time.
constexpr double kEarly = 0.25;

double InNoise(const FittedHypothesis& hypothesis) {
  const Eigen::VectorXd white = WhitenedRows(hypothesis.left, hypothesis.misfit, 0, false);
  const Eigen::Index observed = std::max<Eigen::Index>(1, ObservedRows(hypothesis.misfit));
  return std::sqrt(white.squaredNorm() / static_cast<double>(observed));
}

// Of two refits of an effect, from two of its variants.
bool IsBetter(const EffectRefit& a, const EffectRefit& b) {
  if (!a.message.empty() || !b.message.empty()) return a.message.empty();
  const NoiseLevel white;
  return EvidenceOf(a.hypothesis, white).log_evidence >
         EvidenceOf(b.hypothesis, white).log_evidence;
}

// The study until soon after the start of each fitted recording.
PredictionStudy EarlyPart(const CalibrationProblem& problem) {
  PredictionStudy early = problem.WithEstimatedNoise();
  for (PredictedRecording& item : early.recordings) {
    const std::vector<double>& times = item.recording.times;
    const double start = item.StartTime();
    const double end =
        start + kEarly * (std::min(item.fit_until, times[item.frames.back()]) - start);
    std::erase_if(item.frames, [&](int frame) { return times[frame] > end; });
  }
  std::erase_if(early.recordings, [](const PredictedRecording& item) { return !item.fitted; });
  return early;
}

// Effects by their evidence along a fit of the early part; none where it cannot be fitted. Leaves
// the study's effects at `values`.
std::vector<ScoredEffect> RankEarly(const CalibrationProblem& problem,
                                    const Eigen::VectorXd& values,
                                    const std::vector<std::string>& without, Progress* progress) {
  const PredictionStudy early = EarlyPart(problem);
  const CalibrationProblem of_early(early, problem.body()->mesh);
  const Calibration first = FitFromStart(of_early, progress);
  std::vector<ScoredEffect> found;
  if (first.parameters.size() == values.size())
    found = RankEffects(of_early, first.parameters, progress, without).effects;
  return found;
}

// The refits of a diagnosis, one per effect of its ranking.
class Refits {
 public:
  // `ranking`: without its effects, which `diagnosis` has.
  Refits(const PresentModel& model, const EffectRanking& ranking, Diagnosis* diagnosis)
      : model_(model),
        ranking_(ranking),
        diagnosis_(*diagnosis),
        present_(Refit(model, nullptr, ranking.adopted, false)),
        refits_(diagnosis->ranking.size()) {
    CHECK(present_.message.empty()) << present_.message;
    diagnosis_.errors.without_nuisances = present_.errors.without_nuisances;
    diagnosis_.baseline_rms_over_sigma = InNoise(present_.hypothesis);
  }

  // Those that first order finds best.
  void RunBest(int count) {
    if (diagnosis_.ranking.empty() || count == 0) return;
    most_ = std::max(most_, count);
    const size_t last = std::min(diagnosis_.ranking.size(), static_cast<size_t>(count)) - 1;
    const double least = std::min(diagnosis_.ranking.front().scored.score.evidence - kCloseBehind,
                                  kNearlyAsGood * diagnosis_.ranking[last].scored.score.evidence);
    for (size_t k = 0; k < diagnosis_.ranking.size(); ++k) {
      const double evidence = diagnosis_.ranking[k].scored.score.evidence;
      if (evidence < kNoEvidence) break;
      if (k <= last || evidence > least) Run(k);
    }
  }

  // Those that are best early on, with their place, direction or time, their size and their
  // look-alikes as they are found there.
  void RunEarly(const std::vector<ScoredEffect>& found, int count) {
    for (size_t k = 0; k < found.size() && static_cast<int>(k) < count; ++k) {
      if (found[k].score.evidence < kNoEvidence) break;
      for (size_t at = 0; at < diagnosis_.ranking.size(); ++at) {
        RankedEffect& ranked = diagnosis_.ranking[at];
        if (ranked.scored.candidate.type != found[k].candidate.type || ranked.refitted) continue;
        const Score late = std::exchange(ranked.scored, found[k]).score;
        Run(at);
        ranked.scored.score = late;
      }
    }
  }

  // First order cannot tell the best from its look-alikes; a refit may.
  void RunLookAlikesOfBest() {
    const RankedEffect* best = BestRefitted();
    if (best == nullptr) return;
    const std::vector<std::string> look_alikes = best->scored.look_alikes;
    for (size_t k = 0; k < diagnosis_.ranking.size(); ++k)
      if (std::count(look_alikes.begin(), look_alikes.end(),
                     diagnosis_.ranking[k].scored.candidate.type) > 0)
        Run(k);
  }

  // The nuisances that first order puts near the best effect, or beyond. To be called after
  // Weigh().
  void RunRivalNuisances(std::vector<ScoredNuisance>* nuisances) const {
    const RankedEffect* best = BestRefitted();
    if (best == nullptr || best->evidence < kNoEvidence) return;
    const double least = kRivalNuisance * std::min(best->evidence, best->scored.score.evidence);
    std::vector<ScoredNuisance*> rivals;
    for (ScoredNuisance& nuisance : *nuisances)
      if (!nuisance.adopted && nuisance.evidence > std::max(least, kNoEvidence))
        rivals.push_back(&nuisance);
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const auto* a, const auto* b) { return a->evidence > b->evidence; });
    if (rivals.size() > kMostRivalNuisances) rivals.resize(kMostRivalNuisances);
    const double before = EvidenceOf(present_.hypothesis, diagnosis_.noise_level).log_evidence;
    for (ScoredNuisance* nuisance : rivals) {
      const EffectRefit with =
          Refit(model_, nullptr, ranking_.adopted.And(nuisance->candidate), false);
      if (!with.message.empty()) continue;
      const double evidence = EvidenceOf(with.hypothesis, diagnosis_.noise_level).log_evidence -
                              before - nuisance->candidate.price - Price(nuisances->size());
      if (std::isfinite(evidence)) nuisance->refitted = evidence;
    }
  }

  // What could do the work of the nuisances that were adopted: what first order gave a good part of
  // their evidence before they were. To be called after Weigh().
  NuisanceAlternatives RunAlternatives(int count) const {
    NuisanceAlternatives alternatives;
    if (!ranking_.adopted.HasMore()) return alternatives;
    const AdoptedNuisances always = ranking_.adopted.Always();
    const EffectRefit bare = Refit(model_, nullptr, always, false);
    if (!bare.message.empty()) return alternatives;
    alternatives.bare = bare.errors;
    const RefitEvidence before = EvidenceOf(bare, diagnosis_.noise_level);
    alternatives.nuisances_evidence =
        EvidenceOf(present_.hypothesis, diagnosis_.noise_level).log_evidence - before.all;
    for (const ScoredEffect& scored : ranking_.instead) {
      if (static_cast<int>(alternatives.effects.size()) == count ||
          scored.score.evidence < kCouldDoAsMuch * alternatives.nuisances_evidence)
        break;
      RankedEffect& effect = alternatives.effects.emplace_back();
      effect.scored = scored;
      const EffectRefit with = Tried(always, bare, &effect);
      if (with.message.empty()) SetEvidence(with, before, &effect);
    }
    return alternatives;
  }

  // What the best leaves for another effect, by the changes that it makes along the model without,
  // is looked at again where the best is. To be called after Weigh().
  void LookAgain(const std::vector<std::string>& without) {
    const RankedEffect* best = BestRefitted();
    if (best == nullptr) return;
    const double least = best->evidence - kMayBeAsGood;
    int looked = 0;
    for (size_t k = 0; k < refits_.size() && looked < kMostLooks; ++k) {
      RankedEffect& effect = diagnosis_.ranking[k];
      const double others = effect.further.evidence;
      if (!IsUsable(k) || effect.evidence < least ||
          others < std::max(kNoEvidence, kThresholds.naming.remainder_share * effect.evidence))
        continue;
      ++looked;
      effect.further = FurtherEvidenceAlong(model_, effect.scored, refits_[k], without);
    }
  }

  // The noise is what the best of them leaves; evidence is weighed with that.
  void Weigh() {
    const FittedHypothesis& best = Best();
    diagnosis_.noise_level =
        LevelOf(best.left, best.misfit, best.misfit.by.cols(), model_.problem.LeastNoiseVariance());
    diagnosis_.best_rms_over_sigma = InNoise(best);
    const RefitEvidence before = EvidenceOf(present_, diagnosis_.noise_level);
    for (size_t k = 0; k < refits_.size(); ++k)
      if (IsUsable(k)) SetEvidence(refits_[k], before, &diagnosis_.ranking[k]);
  }

 private:
  void SetEvidence(const EffectRefit& with, const RefitEvidence& before,
                   RankedEffect* effect) const {
    const RefitEvidence after = EvidenceOf(with, diagnosis_.noise_level);
    effect->evidence = after.all - before.all - Price(diagnosis_.ranking.size());
    effect->held_out_evidence = after.held_out - before.held_out;
    if (!std::isfinite(effect->evidence)) {
      effect->evidence = 0;
      effect->refit_message = "it ended where its evidence has no value";
      return;
    }
    effect->explained = std::clamp(1 - after.misfit / before.misfit, 0.0, 1.0);
    effect->rms_over_sigma = InNoise(with.hypothesis);
    effect->further = FurtherEvidenceOf(with.hypothesis, ranking_.tried,
                                        effect->scored.candidate.type, diagnosis_.noise_level);
  }
  // By evidence after the refit; null: none has any.
  const RankedEffect* BestRefitted() const {
    const auto best = std::max_element(
        diagnosis_.ranking.begin(), diagnosis_.ranking.end(),
        [](const RankedEffect& a, const RankedEffect& b) { return a.evidence < b.evidence; });
    return best != diagnosis_.ranking.end() && best->evidence > 0 ? &*best : nullptr;
  }
  bool IsUsable(size_t k) const {
    return diagnosis_.ranking[k].refitted && diagnosis_.ranking[k].refit_message.empty();
  }
  void Run(size_t k) {
    RankedEffect& ranked = diagnosis_.ranking[k];
    if (ranked.refitted || done_ == most_) return;
    ++done_;
    refits_[k] = Tried(ranking_.adopted, present_, &ranked);
  }
  EffectRefit Tried(const AdoptedNuisances& adopted, const EffectRefit& without,
                    RankedEffect* effect) const {
    const bool is_far_off = InNoise(without.hypothesis) > kFarOff;
    const auto from = [&](const ScoredVariant& variant, RefitFrom start) {
      return Refit(model_, &variant, adopted, is_far_off, start);
    };
    EffectRefit refit = from(effect->scored, RefitFrom::kFirstOrder);
    ScoredVariant best = effect->scored;
    for (const ScoredVariant& elsewhere : effect->scored.elsewhere) {
      if (elsewhere.score.evidence < kNearlyAsGood * effect->scored.score.evidence) break;
      EffectRefit other = from(elsewhere, RefitFrom::kFirstOrder);
      if (!IsBetter(other, refit)) continue;
      refit = std::move(other);
      best = elsewhere;
    }
    if (!effect->scored.candidate.IsPilot() && LostItsWay(refit, without, effect->scored.score)) {
      EffectRefit other = from(effect->scored, RefitFrom::kItsSize);
      if (IsBetter(other, refit)) {
        refit = std::move(other);
        best = effect->scored;
      }
    }
    static_cast<ScoredVariant&>(effect->scored) = std::move(best);
    effect->refitted = true;
    effect->refit_message = refit.message;
    effect->errors = refit.errors;
    if (refit.message.empty()) {
      effect->values = refit.effect;
      effect->sizes = refit.sizes;
      effect->others = refit.others;
    }
    return refit;
  }
  bool LostItsWay(const EffectRefit& refit, const EffectRefit& without, const Score& score) const {
    if (!refit.message.empty() || PredictsWorse(refit.errors, without.errors)) return true;
    const double noise =
        ranking_.noise.variance * static_cast<double>(ObservedRows(ranking_.misfit));
    return FallsShort(EvidenceOf(without.hypothesis, ranking_.noise),
                      EvidenceOf(refit.hypothesis, ranking_.noise), noise, score.evidence);
  }
  const FittedHypothesis& Best() const {
    const FittedHypothesis* best = &present_.hypothesis;
    double least = EvidenceOf(*best, ranking_.noise).misfit;
    for (size_t k = 0; k < refits_.size(); ++k) {
      if (!IsUsable(k)) continue;
      const double misfit = EvidenceOf(refits_[k].hypothesis, ranking_.noise).misfit;
      if (misfit >= least) continue;
      least = misfit;
      best = &refits_[k].hypothesis;
    }
    return *best;
  }

  const PresentModel& model_;
  const EffectRanking& ranking_;
  Diagnosis& diagnosis_;
  EffectRefit present_;  // the model as it is
  std::vector<EffectRefit> refits_;
  int most_ = kMostRefits;  // unless more are asked for
  int done_ = 0;
};

// There is evidence, and what is not known of the step's error may have lent it.
bool IsStepTooLong(const EffectRanking& ranking) {
  const auto step = std::find_if(
      ranking.nuisances.begin(), ranking.nuisances.end(),
      [](const ScoredNuisance& nuisance) { return nuisance.candidate.name == kTimeStepNuisance; });
  return step != ranking.nuisances.end() &&
         DiscretisationUncertainty(step->doubt) > kThresholds.naming.least_evidence &&
         !ranking.effects.empty() &&
         ranking.effects.front().score.evidence > kThresholds.naming.least_evidence;
}

Diagnosis DiagnoseAt(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                     const DiagnosisOptions& options, int halvings, Progress* progress,
                     RefitStore* kept) {
  EffectRanking ranking = RankEffects(problem, fitted, progress, options.without);
  if (problem.study().chooses_time_step && halvings > 0 && IsStepTooLong(ranking)) {
    PredictionStudy study = problem.WithEstimatedNoise();
    study.time_step /= 2;
    progress->Begin("time step", 0);
    progress->End(
        fmt::format("{:.3g} ms, as twice that may pass for an effect", 1e3 * study.time_step));
    const CalibrationProblem shorter(study, problem.body()->mesh);
    const Calibration fit = FitOn(shorter, fitted, progress);
    if (fit.parameters.size() == fitted.size()) {
      Diagnosis diagnosis =
          DiagnoseAt(shorter, fit.parameters, options, halvings - 1, progress, kept);
      return diagnosis;
    }
  }
  Diagnosis diagnosis;
  diagnosis.noise = problem.noise();
  diagnosis.scan_noise = problem.scan_noise();
  diagnosis.time_step = problem.study().time_step;
  diagnosis.errors = ErrorsOf(problem, fitted);
  diagnosis.scored = ranking.variants;
  diagnosis.control = ranking.control;
  diagnosis.untried = std::move(ranking.untried);
  for (ScoredEffect& effect : ranking.effects) {
    diagnosis.ranking.emplace_back();
    diagnosis.ranking.back().scored = std::move(effect);
  }

  const PresentModel model{problem, fitted, ranking.misfit, progress, kept};
  Refits refits(model, ranking, &diagnosis);
  refits.RunBest(options.refits);
  if (diagnosis.baseline_rms_over_sigma > kFarOff)
    refits.RunEarly(RankEarly(problem, fitted, options.without, progress), options.refits);
  refits.Weigh();
  refits.RunLookAlikesOfBest();
  refits.Weigh();
  refits.RunRivalNuisances(&ranking.nuisances);
  refits.LookAgain(options.without);
  diagnosis.nuisances = std::move(ranking.nuisances);
  Decide(&diagnosis);
  if (diagnosis.verdict == Verdict::kNuisance) {
    diagnosis.alternatives = refits.RunAlternatives(options.refits);
    DecideAgainstNuisances(&diagnosis);
  }
  return diagnosis;
}

}  // namespace

Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, RefitStore* kept) {
  return DiagnoseAt(problem, fitted, options, kMostHalvings, progress, kept);
}

}  // namespace lacuna
