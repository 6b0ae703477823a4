#include "report/verdict_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <variant>
#include <vector>

#include "record/comparison_record.h"
#include "report/quantity_text.h"

namespace lacuna {
namespace {

const char* JudgedFrames(bool held_out) { return held_out ? "held-out" : "fitted"; }

const RecordedEffect* FindEffect(const DiagnosisRecord& diagnosis, const std::string& type) {
  for (const auto* effects : {&diagnosis.ranking, &diagnosis.alternatives.effects})
    for (const RecordedEffect& effect : *effects)
      if (effect.type == type) return &effect;
  return nullptr;
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
    const RecordedAdequacy& adequacy = diagnosis.decision.adequacy;
    if (adequacy.is_tolerated && !adequacy.is_adequate)
      return fmt::format(
          "The error is {:.3f} mm or {:.1f} σ, and no effect has sufficient evidence.",
          1e3 * reason.rms, reason.rms_over_sigma);
    if (std::string corrected = CorrectedError(diagnosis); !corrected.empty()) {
      corrected.front() = 'C';
      return fmt::format(
          "The error is {:.3f} mm or {:.1f} σ, and no effect has sufficient evidence. {}.",
          1e3 * reason.rms, reason.rms_over_sigma, corrected);
    }
    return fmt::format(
        "The error, {:.3f} mm or {:.1f} σ, is that of the noise, and no effect has sufficient "
        "evidence.",
        1e3 * reason.rms, reason.rms_over_sigma);
  }
  std::string operator()(const ErrorUnexplained& reason) const {
    return fmt::format(
        "The residual, {:.3f} mm or {:.1f} σ, exceeds the noise, and no effect of the catalogue "
        "explains it (best evidence {:.1f}).",
        1e3 * reason.rms, reason.rms_over_sigma, reason.best_evidence);
  }
  std::string operator()(const NuisanceExplains& reason) const {
    const RecordedNuisance& nuisance = NuisanceAt(diagnosis, reason.nuisance);
    return fmt::format("{:.0f} % of the squared misfit is explained by {}: {}.", 100 * reason.share,
                       nuisance.what, nuisance.advice);
  }
  std::string operator()(const ResidualRemains& reason) const {
    const std::vector<std::string> beside = TestedBeside(diagnosis, reason.effect);
    return fmt::format(
        "{} explains {:.0f} % of the squared misfit in excess of the noise, and {:.1f} σ remain{}: "
        "it may be present beside something unknown, or compensate for it.",
        TitleOf(diagnosis, reason.effect), 100 * reason.share, reason.rms_over_sigma,
        beside.empty() ? "" : fmt::format(" with {} beside it", EnumerationText(beside)));
  }
  std::string operator()(const EvidenceForAnother& reason) const {
    return fmt::format(
        "{} explains most, with evidence of {:.0f}, but beside it the evidence for {} is {:.0f}: "
        "either both are missing, or one effect that is not in the catalogue and that each of them "
        "explains in part.",
        TitleOf(diagnosis, reason.effect), reason.evidence, reason.other, reason.other_evidence);
  }
  std::string operator()(const EffectReducesError& reason) const {
    return fmt::format(
        "With {}, the {} error{} goes from {:.1f} σ to {:.1f} σ; the evidence for it is {:.0f}.",
        reason.effect, JudgedFrames(reason.held_out),
        reason.adjusted_for_nuisances
            ? ", excluding the contributions of mesh, time step and the other adopted nuisances,"
            : "",
        reason.over_sigma_before, reason.over_sigma_after, reason.evidence);
  }
};

// An effect that a hypothesis contains two times stands in its names two times.
std::string NamesOf(const std::vector<std::string>& names) {
  if (names.empty()) return "nothing";
  std::vector<std::string> phrases;
  for (const std::string& name : names) {
    const auto first = std::find(phrases.begin(), phrases.end(), name);
    if (first != phrases.end())
      *first += " twice";
    else
      phrases.push_back(name);
  }
  return EnumerationText(phrases);
}

// The probabilities at both levels: of families, and of their members.
std::string ProbabilitySentence(const DecisionRecord& decision) {
  using Kind = HypothesisProbability::Kind;
  constexpr double kWorthNaming = 0.01;
  std::vector<std::string> groups;
  std::vector<EffectFamily> done;
  for (const HypothesisProbability& one : decision.probabilities) {
    if (one.probability < kWorthNaming) break;
    if (one.kind != Kind::kEffect || one.family == EffectFamily::kOther) {
      groups.push_back(NamesOf(one.names) + " " + PercentText(one.probability));
      continue;
    }
    if (std::count(done.begin(), done.end(), one.family) > 0) continue;
    done.push_back(one.family);
    std::vector<std::string> members;
    for (const HypothesisProbability& member : decision.probabilities)
      if (member.kind == Kind::kEffect && member.family == one.family &&
          member.probability >= kWorthNaming)
        members.push_back(NamesOf(member.names) + " " + PercentText(member.probability));
    groups.push_back(fmt::format("{} {} ({})", FamilyTitle(one.family),
                                 PercentText(decision.FamilyProbability(one.family)),
                                 fmt::join(members, ", ")));
  }
  return fmt::format("Probability of what is missing, among all hypotheses that were tried: {}.",
                     fmt::join(groups, "; "));
}

std::string AdequacySentence(const RecordedAdequacy& adequacy) {
  const std::string beside =
      adequacy.beside.empty() ? "The model as it is" : "The model with " + NamesOf(adequacy.beside);
  if (adequacy.is_adequate)
    return fmt::format(
        "{} leaves nothing that is more probable than noise and the error of the model (p = "
        "{:.2g}).",
        beside, adequacy.p);
  if (adequacy.is_tolerated)
    return fmt::format(
        "{} leaves more than noise does (p = {:.3f}, {:.2f} σ over all frames), but only {:.2g} % "
        "of the squared misfit that was explained: no more than the error of any model.",
        beside, adequacy.p, adequacy.rms_over_sigma, 100 * adequacy.left_share);
  const std::string share =
      std::isfinite(adequacy.left_share)
          ? fmt::format(", {:.1f} % of what was explained", 100 * adequacy.left_share)
          : "";
  return fmt::format(
      "Something unknown is left: {} leaves more than noise does (p = {:.3f}, {:.2f} σ over all "
      "frames{}).",
      beside, adequacy.p, adequacy.rms_over_sigma, share);
}

// Whether the refit of an effect has evidence.
bool HasEvidence(const DiagnosisRecord& diagnosis, const std::string& type) {
  const RecordedEffect* effect = FindEffect(diagnosis, type);
  return effect != nullptr && effect->HasUsableRefit() && effect->refit->evidence > 0;
}

// The effects that have evidence, but predict the held-out frames much less probably than the model
// without them. An effect stands in several hypotheses: with nuisances beside it, and in their
// place. It is refuted if all of these are.
std::vector<std::string> RefutedSentences(const DiagnosisRecord& diagnosis) {
  std::map<std::string, bool> is_refuted;
  for (const HypothesisProbability& one : diagnosis.decision.probabilities)
    if (one.kind == HypothesisProbability::Kind::kEffect)
      is_refuted.try_emplace(one.names.front(), true).first->second &= one.is_refuted;
  std::vector<std::string> sentences;
  for (const auto& [name, refuted] : is_refuted)
    if (refuted && HasEvidence(diagnosis, name))
      sentences.push_back(
          fmt::format("With {0} the model fits better, but it predicts the held-out frames worse, "
                      "and by more than chance: {0} is refuted.",
                      name));
  return sentences;
}

// The effects that would be refuted, had their sizes not ended at the limit of what is plausible.
std::vector<std::string> NotRefutedSentences(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> sentences;
  for (const RecordedEffect& effect : diagnosis.ranking)
    if (effect.HasUsableRefit() && effect.refit->fails_at_limit && effect.refit->evidence > 0)
      sentences.push_back(fmt::format(
          "With {0} the model fits better, but it predicts the held-out frames worse. {0} is not "
          "refuted: its size is at the limit of what is plausible. To decide, fit the model with "
          "it in a wider range (`lacuna add` writes the experiment), or from a better start.",
          effect.type));
  return sentences;
}

// Whether a pair of effects is among the hypotheses that together reach the probability that a
// statement needs.
bool KeepsPair(const DecisionRecord& decision) {
  double sum = 0;
  for (const HypothesisProbability& one : decision.probabilities) {
    if (one.kind == HypothesisProbability::Kind::kPair) return true;
    sum += one.probability;
    if (sum >= kStatedProbability) break;
  }
  return false;
}

// What the verdict names.
std::vector<std::string> NamingSentences(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> titles;
  for (const std::string& name : diagnosis.effects) titles.push_back(TitleOf(diagnosis, name));
  if (diagnosis.verdict == Verdict::kMissing)
    return {fmt::format("Missing: {}.", fmt::join(titles, "; "))};
  if (diagnosis.verdict == Verdict::kAmbiguous)
    return {fmt::format("These recordings cannot distinguish between: {}{}.",
                        fmt::join(titles, "; "),
                        KeepsPair(diagnosis.decision) ? "; or two of them at once" : "")};
  return {};
}

}  // namespace

const RecordedNuisance* StrongestNuisance(const DiagnosisRecord& diagnosis,
                                          const std::string& name) {
  const RecordedNuisance* strongest = nullptr;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (nuisance.name == name && (strongest == nullptr || nuisance.evidence > strongest->evidence))
      strongest = &nuisance;
  return strongest;
}

std::string TitleOf(const DiagnosisRecord& diagnosis, const std::string& name) {
  if (const RecordedEffect* effect = FindEffect(diagnosis, name)) return effect->title;
  const RecordedNuisance* nuisance = StrongestNuisance(diagnosis, name);
  return nuisance != nullptr ? nuisance->what : name;
}

std::string VerdictWithNames(const Conclusion& conclusion) {
  if (conclusion.effects.empty()) return VerdictName(conclusion.verdict);
  return fmt::format("{} {{{}}}", VerdictName(conclusion.verdict),
                     fmt::join(conclusion.effects, ", "));
}

std::string ShortTitle(const DiagnosisRecord& diagnosis, const std::string& name) {
  std::string title = TitleOf(diagnosis, name);
  if (const size_t at = title.find(" ("); at != std::string::npos) title.erase(at);
  const bool is_abbreviation = title.substr(0, title.find(' ')).ends_with('.');
  const bool is_word = title.size() > 1 && std::islower(static_cast<unsigned char>(title[1]));
  if (!is_abbreviation && (is_word || title.starts_with("A ")))
    title[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(title[0])));
  return title;
}

std::string ModelLabel(size_t index, const std::string& added,
                       const std::optional<DiagnosisRecord>& before) {
  if (index == 0) return "initial model";
  return (index == 1 ? "with " : "and with ") + (before ? ShortTitle(*before, added) : added);
}

std::vector<std::string> TestedBeside(const DiagnosisRecord& diagnosis, const std::string& effect) {
  std::vector<std::string> beside = diagnosis.decision.adequacy.beside;
  return std::erase(beside, effect) > 0 ? beside : std::vector<std::string>{};
}

const RecordedNuisance* BestAdoptedNuisance(const DiagnosisRecord& diagnosis) {
  // Errors of the elements and of the object's dimensions both change frequencies and may explain
  // the same: of those that explain nearly as much as the best one, the first of the catalogue is
  // meant, which lists the errors of the computation first.
  constexpr double kNearlyAsMuch = 0.9;
  double most = 0;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (nuisance.adopted) most = std::max(most, nuisance.explained);
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (nuisance.adopted && nuisance.explained >= kNearlyAsMuch * most) return &nuisance;
  return nullptr;
}

std::string CorrectedError(const DiagnosisRecord& diagnosis) {
  const ModelErrors& errors = diagnosis.errors;
  if (errors.rms_over_sigma < kBeyondNoise || errors.without_nuisances >= kBeyondNoise) return "";
  const RecordedNuisance* most = BestAdoptedNuisance(diagnosis);
  if (most == nullptr) return "";
  return fmt::format("corrected for {}, the error is {:.1f} times the noise: {}", most->what,
                     errors.without_nuisances, most->advice);
}

std::string ExplainVerdict(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> sentences = NamingSentences(diagnosis);
  for (const VerdictReason& reason : diagnosis.reasons)
    sentences.push_back(std::visit(ReasonSentence{diagnosis}, reason));
  if (!diagnosis.decision.probabilities.empty()) {
    sentences.push_back(ProbabilitySentence(diagnosis.decision));
    for (auto* described : {RefutedSentences, NotRefutedSentences})
      for (std::string& sentence : described(diagnosis)) sentences.push_back(std::move(sentence));
    sentences.push_back(AdequacySentence(diagnosis.decision.adequacy));
  }
  return fmt::format("{}", fmt::join(sentences, " "));
}

std::string DescribeNextSteps(const DiagnosisRecord& diagnosis) {
  std::vector<std::string> phrases;
  for (const SuggestedStep& step : diagnosis.next_steps) {
    if (const auto* add = std::get_if<AddAndDiagnose>(&step)) {
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
  return fmt::format("{}", fmt::join(phrases, "; "));
}

}  // namespace lacuna
