#include "report/verdict_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <variant>
#include <vector>

namespace lacuna {
namespace {

double Millimetres(double metres) { return 1e3 * metres; }

const char* JudgedFrames(bool held_out) { return held_out ? "held-out" : "fitted"; }

const RecordedEffect* FindEffect(const DiagnosisRecord& diagnosis, const std::string& type) {
  for (const auto* effects : {&diagnosis.ranking, &diagnosis.alternatives.effects})
    for (const RecordedEffect& effect : *effects)
      if (effect.type == type) return &effect;
  return nullptr;
}

// The title of an effect, what a nuisance is, or the name itself where the record has neither.
std::string TitleOf(const DiagnosisRecord& diagnosis, const std::string& name) {
  if (const RecordedEffect* effect = FindEffect(diagnosis, name)) return effect->title;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (nuisance.name == name) return nuisance.what;
  return name;
}

const RecordedNuisance& NuisanceAt(const DiagnosisRecord& diagnosis, int index) {
  CHECK(index >= 0 && index < static_cast<int>(diagnosis.nuisances.size())) << index;
  return diagnosis.nuisances[static_cast<size_t>(index)];
}

// One or two sentences for each kind of reason.
struct ReasonSentence {
  const DiagnosisRecord& diagnosis;

  std::string operator()(const NothingDetectable& /*reason*/) const {
    return "No effect of plausible size would be visible in these recordings beyond what the "
           "fitted parameters can compensate for. More motion, other loads or less noise are "
           "needed.";
  }
  std::string operator()(const ErrorIsNoise& reason) const {
    return fmt::format(
        "The error, {:.3f} mm or {:.1f} σ, is that of the noise, and no effect has sufficient "
        "evidence.",
        Millimetres(reason.rms), reason.rms_over_sigma);
  }
  std::string operator()(const ErrorUnexplained& reason) const {
    return fmt::format(
        "The residual, {:.3f} mm or {:.1f} σ, exceeds the noise, and no effect of the catalogue "
        "explains it (best evidence {:.1f}).",
        Millimetres(reason.rms), reason.rms_over_sigma, reason.best_evidence);
  }
  std::string operator()(const UncertainDiscretisation& reason) const {
    return fmt::format(
        "The uncertainty in {} could account for up to {:.1f} of the best effect's evidence of "
        "{:.1f}.",
        NuisanceAt(diagnosis, reason.nuisance).what, reason.uncertainty, reason.best_evidence);
  }
  std::string operator()(const NuisanceExplains& reason) const {
    const RecordedNuisance& nuisance = NuisanceAt(diagnosis, reason.nuisance);
    return fmt::format("{:.0f} % of the squared misfit is explained by {}: {}.", 100 * reason.share,
                       nuisance.what, nuisance.advice);
  }
  std::string operator()(const NuisanceIsNegligible& reason) const {
    return fmt::format(
        "A small part of the error, less than {:.0f} % of the squared misfit, comes from {}.",
        100 * reason.share, NuisanceAt(diagnosis, reason.nuisance).what);
  }
  std::string operator()(const ResidualRemains& reason) const {
    return fmt::format(
        "{} explains most, {:.0f} % of the squared misfit in excess of the noise, but the residual "
        "that remains, {:.1f} σ, exceeds the noise: it may compensate for another effect.",
        TitleOf(diagnosis, reason.effect), 100 * reason.share, reason.rms_over_sigma);
  }
  std::string operator()(const HeldOutErrorRemains& reason) const {
    return fmt::format(
        "{} explains most, with odds of e^{:.0f}, but with it the held-out error only goes from "
        "{:.1f} σ to {:.1f} σ, which exceeds the noise: it may compensate for another effect.",
        TitleOf(diagnosis, reason.effect), reason.evidence, reason.over_sigma_before,
        reason.over_sigma_after);
  }
  std::string operator()(const EvidenceForAnother& reason) const {
    return fmt::format(
        "{} explains most, with odds of e^{:.0f}, but beside it the odds for {} are e^{:.0f}: "
        "either both are missing, or one effect that is not in the catalogue and that each of them "
        "explains in part.",
        TitleOf(diagnosis, reason.effect), reason.evidence, reason.other, reason.other_evidence);
  }
  std::string operator()(const EffectReducesError& reason) const {
    return fmt::format(
        "With {}, the {} error{} goes from {:.1f} σ to {:.1f} σ; the odds for it are e^{:.0f}.",
        reason.effect, JudgedFrames(reason.held_out),
        reason.adjusted_for_nuisances
            ? ", excluding the contributions of mesh, time step and the other adopted nuisances,"
            : "",
        reason.over_sigma_before, reason.over_sigma_after, reason.evidence);
  }
  std::string operator()(const RivalPredictsBetter& reason) const {
    return fmt::format(
        "{} has less evidence, e^{:.0f}, but predicts the recordings that were not fitted better, "
        "to {:.1f} σ against {:.1f} σ.",
        reason.effect, reason.evidence, reason.over_sigma, reason.over_sigma_of_best);
  }
  std::string operator()(const RivalNotFitted& reason) const {
    return fmt::format("{}, whose odds are e^{:.0f} to first order, could not be fitted.",
                       reason.effect, reason.first_order_evidence);
  }
  std::string operator()(const NuisanceHasMoreEvidence& reason) const {
    return fmt::format("{} has more evidence, e^{:.0f}.",
                       NuisanceAt(diagnosis, reason.nuisance).name, reason.evidence);
  }
  std::string operator()(const UnadjustedErrorRises& reason) const {
    return fmt::format(
        "If the contributions of the adopted nuisances are included, the held-out error rises from "
        "{:.3f} mm to {:.3f} mm: these nuisances need attention, too.",
        Millimetres(reason.rms_before), Millimetres(reason.rms_after));
  }
  std::string operator()(const EffectReplacesNuisances& reason) const {
    return fmt::format(
        "The odds for {} are e^{:.0f}. Without these, the odds for {} are e^{:.0f}, and the {} "
        "error goes from {:.1f} σ to {:.1f} σ.",
        fmt::join(reason.nuisances, ", "), reason.nuisances_evidence, reason.effect,
        reason.evidence, JudgedFrames(reason.held_out), reason.over_sigma_before,
        reason.over_sigma_after);
  }
};

// Sentences that list what the verdict names.
std::vector<std::string> NamingSentences(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> titles;
  for (const std::string& name : diagnosis.effects) titles.push_back(TitleOf(diagnosis, name));
  if (diagnosis.verdict == Verdict::kMissing)
    return {fmt::format("Missing: {}.", fmt::join(titles, "; "))};
  if (diagnosis.verdict == Verdict::kAmbiguous)
    return {
        fmt::format("These recordings cannot distinguish between: {}.", fmt::join(titles, "; "))};
  return {};
}

}  // namespace

std::string VerdictWithNames(const Conclusion& conclusion) {
  if (conclusion.effects.empty()) return VerdictName(conclusion.verdict);
  return fmt::format("{} {{{}}}", VerdictName(conclusion.verdict),
                     fmt::join(conclusion.effects, ", "));
}

std::string ExplainVerdict(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> sentences = NamingSentences(diagnosis);
  for (const VerdictReason& reason : diagnosis.reasons)
    sentences.push_back(std::visit(ReasonSentence{diagnosis}, reason));
  return fmt::format("{}", fmt::join(sentences, " "));
}

std::string DescribeNextSteps(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> phrases;
  std::string refined;  // what to do after the last refinement
  for (const SuggestedStep& step : diagnosis.next_steps) {
    if (const auto* refine = std::get_if<RefineDiscretisation>(&step)) {
      phrases.push_back(NuisanceAt(diagnosis, refine->nuisance).advice);
      refined = refine->fit_again ? ", and fit again" : ", and diagnose again";
    } else if (const auto* add = std::get_if<AddAndDiagnose>(&step)) {
      phrases.push_back(fmt::format(
          "add {0} and diagnose again: if both are missing, {1} is named next, and the residual "
          "that then remains is noise",
          add->effect, add->expected_next));
    } else if (const auto* separate = std::get_if<SeparateLookAlikes>(&step)) {
      if (const RecordedEffect* effect = FindEffect(diagnosis, separate->effect))
        phrases.push_back(effect->separating_experiment);
    } else if (const auto* check = std::get_if<CheckNuisance>(&step)) {
      phrases.push_back((phrases.empty() ? "" : "or ") +
                        NuisanceAt(diagnosis, check->nuisance).advice);
    }
  }
  return fmt::format("{}{}", fmt::join(phrases, "; "), refined);
}

}  // namespace lacuna
