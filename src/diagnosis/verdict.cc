#include "diagnosis/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "effects/catalogue.h"

namespace lacuna {
namespace {

using Verdict = Diagnosis::Verdict;

// Logarithms of odds: to be preferred to a rival. The model that both are added to is not perfect,
// and what it is off by makes the better of two that explain about the same by chance. So the lead
// must be a part of the evidence itself, and never needs to be more than the last of these.
constexpr double kLeastLead = 3, kLeadShare = 0.25, kMostLead = 10;
constexpr double kDoubtful = 2;  // of MayLend()
// With these odds an effect is there, though its interval reaches nothing: intervals take for
// straight lines what a lump's stiffness, radius and place may do for one another, and with it gone
// they would have no meaning (Davies, Biometrika 64, 1977).
constexpr double kBeyondIntervals = 10;
// What is left is noise below so many standard deviations; of held-out frames alone, which feel
// what the fitted ones leave open of the parameters, below these.
constexpr double kAtNoise = 1.2, kHeldOutAtNoise = 1.3;
// The held-out frames may speak against an effect that is named first with these odds, as a
// logarithm: chance.
constexpr double kNoWorse = 3;
// Recordings that were not fitted are no part of the evidence: which effect predicts them better by
// so many σ cannot be ruled out by those that were. That is what the noise of a thousand
// measurements changes of their rms misfit, however large it is.
constexpr double kPredictsBetter = 0.03;
// Nuisances are known to first order: an effect may live on what that leaves out, so its evidence
// must be more than this part of theirs that are in the model. A grip that yields or reaches
// further changes the frequencies, which first order follows for a short time only, also in a model
// that is fitted with it: it is a rival with this part of the effect's evidence.
constexpr double kFirstOrderDoubt = 0.1;
constexpr double kGripRival = 0.5;
// Where the best effect leaves more than noise, it must have explained this share of what is more
// than noise to be named.
constexpr double kMostOfIt = 0.85;
// Where more than noise is left, a nuisance that explains this share of the misfit is still what is
// to be seen to first.
constexpr double kMostByNuisance = 0.5;
// Where the error is that of the noise, a nuisance that explains less than this share of it is
// certain, and does not matter.
constexpr double kNuisanceMatters = 0.05;
// In place of adopted nuisances, an effect is their rival with this part of their evidence, where
// it lowers the held-out error to this part: a time error of every frame follows each frame as well
// as physics does, but predicts none.
constexpr double kInstead = 0.75, kPredicts = 0.9;
// A finer discretisation would change this share of the error.
constexpr double kMeshMatters = 0.25;

// Of effects, and of nuisances what they are.
std::string Titles(const std::vector<std::string>& types,
                   const std::vector<ScoredNuisance>& nuisances = {}) {
  std::vector<std::string> titles;
  for (const std::string& type : types) {
    const CatalogueEntry* entry = FindEntry(type);
    const auto nuisance =
        std::find_if(nuisances.begin(), nuisances.end(),
                     [&](const ScoredNuisance& one) { return one.candidate.card.name == type; });
    titles.push_back(entry != nullptr              ? entry->card->title
                     : nuisance != nuisances.end() ? nuisance->candidate.what
                                                   : type);
  }
  return fmt::format("{}", fmt::join(titles, "; "));
}

// No effect, at the largest size that is plausible, would stand out from the noise.
bool NothingCouldBeSeen(const std::vector<RankedEffect>& ranking) {
  for (const RankedEffect& effect : ranking) {
    const std::vector<CandidateAmount> amounts = AmountsOf(effect.scored.candidate);
    for (size_t k = 0; k < amounts.size(); ++k)
      if (effect.scored.score.detectable[static_cast<Eigen::Index>(k)] < amounts[k].plausible)
        return false;
  }
  return true;
}

const RankedEffect* Find(const std::vector<RankedEffect>& ranking, const std::string& type) {
  for (const RankedEffect& effect : ranking)
    if (effect.scored.candidate.type == type) return &effect;
  return nullptr;
}

// The usable refits that count, the one with the most evidence first.
std::vector<const RankedEffect*> ByEvidence(
    const std::vector<RankedEffect>& effects,
    const std::function<bool(const RankedEffect& effect)>& counts) {
  std::vector<const RankedEffect*> chosen;
  for (const RankedEffect& effect : effects)
    if (effect.refitted && effect.refit_message.empty() && counts(effect))
      chosen.push_back(&effect);
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const auto* a, const auto* b) { return a->evidence > b->evidence; });
  return chosen;
}

// Its size after the refit may be none, and its evidence does not say otherwise.
bool MayBeNothing(const RankedEffect& effect) {
  return !effect.sizes.empty() && effect.evidence < kBeyondIntervals &&
         std::all_of(effect.sizes.begin(), effect.sizes.end(),
                     [](const ParameterEstimate& size) { return size.low <= 0 && size.high >= 0; });
}

// Share of the squared misfit beyond that of noise that went, both misfits in σ.
double ExcessExplained(double before, double after) {
  if (before <= 1) return 1;
  return std::clamp((before * before - after * after) / (before * before - 1), 0.0, 1.0);
}

// With the nuisances in the model as the fitted frames tell them. What is left over all frames does
// not say so: mesh, dimensions and drift, at their best for all of them, bend to what is missing.
// Nuisances of single frames tell of no others.
bool PredictsHeldOutFrames(const Diagnosis& diagnosis) {
  const ScoredNuisance* best = nullptr;
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    if (!nuisance.candidate.card.is_always_in_model &&
        (nuisance.adopted || nuisance.evidence > kNamed) &&
        (best == nullptr || nuisance.evidence > best->evidence))
      best = &nuisance;
  return !diagnosis.errors.has_held_out || diagnosis.errors.without_nuisances <= kHeldOutAtNoise ||
         (best != nullptr && best->candidate.card.acts_on_single_frames);
}

// The evidence that mesh or step may lend an effect, and which of them; null: none is uncertain.
std::pair<double, const ScoredNuisance*> MostLent(const std::vector<ScoredNuisance>& nuisances) {
  double most = 0;
  const ScoredNuisance* lender = nullptr;
  for (const ScoredNuisance& nuisance : nuisances) {
    if (MayLend(nuisance.doubt) <= most) continue;
    most = MayLend(nuisance.doubt);
    if (nuisance.doubt > 0) lender = &nuisance;
  }
  return {most, lender};
}

// Nothing of the catalogue is needed, or nothing of it helps. `lender`: what may have lent the best
// effect its evidence; null: it has none.
void DecideWithoutEffect(Diagnosis* diagnosis, double best_evidence, bool is_noise,
                         const ScoredNuisance* lender) {
  const std::string error = fmt::format(
      "{:.3f} mm or {:.1f} σ", 1e3 * diagnosis->errors.held_out_rms, diagnosis->errors.in_noise);
  std::vector<std::string> named, advice, small;
  double most_explained = 0;
  const bool at_noise = diagnosis->errors.in_noise <= kAtNoise;
  for (const ScoredNuisance& nuisance : diagnosis->nuisances) {
    const bool counts =
        nuisance.candidate.card.is_always_in_model
            ? nuisance.explained > kMeshMatters && nuisance.evidence > kNamed && !at_noise
            : nuisance.adopted || nuisance.evidence > kNamed;
    if (!counts) continue;
    if (at_noise && nuisance.explained < kNuisanceMatters) {
      small.push_back(nuisance.candidate.what);
      continue;
    }
    most_explained = std::max(most_explained, nuisance.explained);
    named.push_back(nuisance.candidate.card.name);
    advice.push_back(fmt::format("{:.0f} % of the misfit by {}: {}", 100 * nuisance.explained,
                                 nuisance.candidate.what, nuisance.candidate.card.advice));
  }
  if (!named.empty() &&
      (is_noise || (most_explained > kMostByNuisance && PredictsHeldOutFrames(*diagnosis)))) {
    diagnosis->verdict = Verdict::kNuisance;
    diagnosis->effects = std::move(named);
    diagnosis->explanation = fmt::format("{}", fmt::join(advice, "; "));
    return;
  }
  if (lender != nullptr)
    diagnosis->experiment = lender->candidate.card.advice + ", and diagnose again";
  if (is_noise) {
    diagnosis->verdict = Verdict::kAdequate;
    diagnosis->explanation = fmt::format(
        "the error, {}, is that of the noise, and no effect has evidence beyond what chance gives",
        error);
    if (lender != nullptr) {
      diagnosis->explanation = fmt::format(
          "the error, {}, is that of the noise, and the best evidence for an effect, {:.1f}, is "
          "within the {:.1f} that what is not known of {} may lend it",
          error, best_evidence, MayLend(lender->doubt), lender->candidate.what);
    }
    if (!small.empty())
      diagnosis->explanation += fmt::format("; {} shows, and explains less than {:.0f} % of it",
                                            fmt::join(small, ", "), 100 * kNuisanceMatters);
  } else {
    diagnosis->verdict = Verdict::kNotInLibrary;
    std::string best = fmt::format("best evidence {:.1f}", best_evidence);
    if (lender != nullptr) {
      best += fmt::format(", of which what is not known of {} may lend {:.1f}",
                          lender->candidate.what, MayLend(lender->doubt));
    }
    diagnosis->explanation = fmt::format(
        "{} are left, which is not noise, and no effect of the catalogue explains them ({}){}",
        error, best,
        advice.empty() ? ""
                       : fmt::format("; nuisances explain a part: {}", fmt::join(advice, "; ")));
  }
}

// Where the best effect, or it and all that are as good, do only a part of what is to be done: not
// in the library. `chance`: the evidence that they may leave for another.
bool DecideThatNoneOfThemIsIt(const RankedEffect& best,
                              const std::vector<const RankedEffect*>& close, double chance,
                              Diagnosis* diagnosis) {
  const auto predicts_poorly = [&](const RankedEffect* effect) {
    return diagnosis->errors.has_held_out && effect->errors.without_nuisances > kHeldOutAtNoise &&
           ExcessExplained(diagnosis->errors.without_nuisances, effect->errors.without_nuisances) <
               kMostOfIt;
  };
  const auto leaves_more = [&](const RankedEffect* effect) {
    return effect->further.evidence > std::max(chance, effect->further.of_nuisance + kLeastLead);
  };
  const std::string title = Titles({best.scored.candidate.type});
  const double excess = ExcessExplained(diagnosis->present_in_noise, best.left_in_noise);
  if (best.left_in_noise > kAtNoise && excess < kMostOfIt) {
    diagnosis->explanation = fmt::format(
        "{} explains most, {:.0f} % of what is more than noise, but what it leaves, {:.1f} σ, is "
        "not noise: it may be doing another effect's work",
        title, 100 * excess, best.left_in_noise);
  } else if (std::all_of(close.begin(), close.end(), predicts_poorly)) {
    diagnosis->explanation = fmt::format(
        "{} explains most, the odds for it are e^{:.0f}, but with it the held-out error goes from "
        "{:.1f} σ to {:.1f} σ only, which is not noise: it may be doing another effect's work",
        title, best.evidence, diagnosis->errors.without_nuisances, best.errors.without_nuisances);
  } else if (std::all_of(close.begin(), close.end(), leaves_more)) {
    diagnosis->explanation = fmt::format(
        "{} explains most, the odds for it are e^{:.0f}, but beside it those for {} are e^{:.0f}: "
        "both are missing, or one that is not in the catalogue, whose work they share",
        title, best.evidence, best.further.type, best.further.evidence);
    diagnosis->experiment = fmt::format(
        "add {0} and diagnose again: if both are missing, {1} is named next, and what "
        "is left then is noise",
        best.scored.candidate.type, best.further.type);
  } else {
    return false;
  }
  diagnosis->verdict = Verdict::kNotInLibrary;
  return true;
}

}  // namespace

double MayLend(double doubt) { return kDoubtful * doubt + kLeastLead; }

void Decide(Diagnosis* diagnosis) {
  if (NothingCouldBeSeen(diagnosis->ranking)) {
    diagnosis->verdict = Verdict::kNoPower;
    diagnosis->explanation =
        "no effect of plausible size would show in these recordings beyond what the fitted "
        "parameters can do: more motion, other loads or less noise are needed";
    return;
  }
  const bool is_noise = diagnosis->left_in_noise <= kAtNoise && PredictsHeldOutFrames(*diagnosis);
  const bool at_noise = diagnosis->present_in_noise <= kAtNoise;
  const std::vector<const RankedEffect*> refitted =
      ByEvidence(diagnosis->ranking, [&](const RankedEffect& effect) {
        return effect.held_out_evidence > -kNoWorse && !(at_noise && MayBeNothing(effect));
      });
  const double evidence = refitted.empty() ? 0 : refitted.front()->evidence;
  double in_the_model = 0;
  bool corrected = false;
  for (const ScoredNuisance& nuisance : diagnosis->nuisances) {
    if (!nuisance.adopted) continue;
    corrected = true;
    // What mesh, step and dimensions change is simulated and bounded: no free directions.
    if (!nuisance.candidate.card.is_always_in_model)
      in_the_model += std::max(0.0, nuisance.evidence);
  }
  // What mesh or step may lend is no evidence where the model is at the noise without.
  const auto [lent, lender] = MostLent(diagnosis->nuisances);
  const double needed = std::max({kNamed, diagnosis->control, kFirstOrderDoubt * in_the_model});
  if (evidence < needed || (at_noise && evidence < lent)) {
    DecideWithoutEffect(diagnosis, evidence, is_noise, evidence < needed ? nullptr : lender);
    return;
  }
  const RankedEffect& best = *refitted.front();
  double doubt = 0;
  for (const ScoredNuisance& nuisance : diagnosis->nuisances) doubt += nuisance.doubt;
  const double lead =
      std::max(std::clamp(kLeadShare * evidence, kLeastLead, kMostLead), kDoubtful * doubt);
  const std::vector<const RankedEffect*> close =
      ByEvidence(diagnosis->ranking,
                 [&](const RankedEffect& effect) { return effect.evidence > evidence - lead; });
  if (DecideThatNoneOfThemIsIt(best, close,
                               std::max({kNamed, diagnosis->control, lent, kLeavesMore * evidence}),
                               diagnosis))
    return;
  diagnosis->effects = {best.scored.candidate.type};
  // Why those that explain less are not ruled out.
  std::string doubts;
  // Those that the held-out frames speak against are rivals still: evidence counts these too.
  for (const RankedEffect* rival :
       ByEvidence(diagnosis->ranking, [](const RankedEffect&) { return true; })) {
    if (rival == &best) continue;
    const std::string& type = rival->scored.candidate.type;
    const double error = rival->errors.unfitted_in_noise, of_best = best.errors.unfitted_in_noise;
    const bool is_close = rival->evidence > evidence - lead;
    const bool predicts =
        rival->evidence > std::max(kNamed, diagnosis->control) && error < of_best - kPredictsBetter;
    // An effect of size zero has the evidence 0: a refit that ends below has gone astray, and what
    // first order puts beside the best is not ruled out by it.
    const double to_first_order = rival->scored.score.evidence;
    const bool is_astray =
        rival->evidence < 0 && to_first_order >= best.scored.score.evidence - lead;
    if (!is_close && !predicts && !is_astray) continue;
    diagnosis->effects.push_back(type);
    if (is_close) continue;
    doubts += predicts ? fmt::format(
                             "; {} explains less, e^{:.0f}, but predicts the recordings that "
                             "were not fitted better, to {:.1f} σ against {:.1f} σ",
                             type, rival->evidence, error, of_best)
                       : fmt::format("; {}, e^{:.0f} to first order, could not be fitted", type,
                                     to_first_order);
  }
  std::vector<std::string> refine;
  std::string advice;  // on nuisances that are rivals
  // Look-alikes that were not refitted cannot be ruled out either.
  for (const std::string& other : best.scored.look_alikes) {
    const RankedEffect* rival = Find(diagnosis->ranking, other);
    if (rival != nullptr && !rival->refitted) diagnosis->effects.push_back(other);
  }
  for (const ScoredNuisance& nuisance : diagnosis->nuisances) {
    const double part = nuisance.candidate.card.outgrows_first_order ? kGripRival : 1;
    const double its_evidence = nuisance.refitted.value_or(nuisance.evidence);
    if (MayLend(nuisance.doubt) > evidence) {
      diagnosis->effects.push_back(nuisance.candidate.card.name);
      refine.push_back(nuisance.candidate.card.advice);
    } else if (!nuisance.adopted && its_evidence > std::min(evidence - lead, part * evidence)) {
      diagnosis->effects.push_back(nuisance.candidate.card.name);
      advice += "; or " + nuisance.candidate.card.advice;
      if (its_evidence > evidence)
        doubts += fmt::format("; {} has more evidence, e^{:.0f}", nuisance.candidate.card.name,
                              its_evidence);
    }
  }
  const std::string drop =
      fmt::format("the {} error{} goes from {:.1f} σ to {:.1f} σ, the odds for it are e^{:.0f}",
                  diagnosis->errors.has_held_out ? "held-out" : "fitted",
                  corrected ? ", less what mesh, step and other nuisances in the model do," : "",
                  diagnosis->errors.without_nuisances, best.errors.without_nuisances, evidence);
  if (corrected && diagnosis->errors.has_held_out &&
      best.errors.held_out_rms > diagnosis->errors.held_out_rms)
    doubts +=
        fmt::format("; with what those do it rises, from {:.3f} mm to {:.3f} mm: see to them, too",
                    1e3 * diagnosis->errors.held_out_rms, 1e3 * best.errors.held_out_rms);
  if (diagnosis->effects.size() == 1) {
    diagnosis->verdict = Verdict::kMissing;
    diagnosis->explanation =
        fmt::format("{}: with it {}{}", Titles(diagnosis->effects), drop, doubts);
  } else {
    diagnosis->verdict = Verdict::kAmbiguous;
    diagnosis->explanation =
        fmt::format("{}: these recordings cannot tell them apart; with the best effect {}{}",
                    Titles(diagnosis->effects, diagnosis->nuisances), drop, doubts);
    diagnosis->experiment =
        refine.empty() ? best.scored.candidate.effect->Card().separating_experiment + advice
                       : fmt::format("{}, and fit again", fmt::join(refine, "; "));
  }
}

void DecideAgainstNuisances(Diagnosis* diagnosis) {
  const Diagnosis::Instead& instead = diagnosis->instead;
  const std::vector<const RankedEffect*> rivals =
      ByEvidence(instead.effects, [&](const RankedEffect& effect) {
        return effect.evidence >
                   std::max(diagnosis->control, kInstead * instead.nuisances_evidence) &&
               effect.errors.without_nuisances < kPredicts * instead.bare.without_nuisances;
      });
  if (rivals.empty()) return;
  const RankedEffect& best = *rivals.front();
  std::vector<std::string> effects;
  for (const RankedEffect* rival : rivals) effects.push_back(rival->scored.candidate.type);
  // Look-alikes that were not tried cannot be ruled out.
  for (const std::string& other : best.scored.look_alikes)
    if (Find(instead.effects, other) == nullptr) effects.push_back(other);
  diagnosis->verdict = Verdict::kAmbiguous;
  diagnosis->explanation = fmt::format(
      "{}: without {}, whose odds are e^{:.0f}, the best of them has e^{:.0f} and lowers the {} "
      "error from {:.1f} σ to {:.1f} σ: these recordings cannot tell them apart",
      Titles(effects), fmt::join(diagnosis->effects, ", "), instead.nuisances_evidence,
      best.evidence, diagnosis->errors.has_held_out ? "held-out" : "fitted",
      instead.bare.without_nuisances, best.errors.without_nuisances);
  diagnosis->experiment = best.scored.candidate.effect->Card().separating_experiment;
  for (const ScoredNuisance& nuisance : diagnosis->nuisances)
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
      diagnosis->experiment += "; or " + nuisance.candidate.card.advice;
  effects.insert(effects.end(), diagnosis->effects.begin(), diagnosis->effects.end());
  diagnosis->effects = std::move(effects);
}

}  // namespace lacuna
