#include "report/plan_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/text_layout.h"
#include "record/verdict.h"
#include "report/quantity_text.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

// A recording is recommended only if the right name is at least this probable with it.
constexpr double kWorthMaking = 0.5;

bool IsAdequate(const PlanRecord& plan) { return plan.verdict == VerdictName(Verdict::kAdequate); }

// "drag (52 %) and mass-proportional damping (43 %)", with the probabilities of the diagnosis.
std::string RivalsText(const PlanRecord& plan) {
  std::vector<std::string> rivals;
  for (const PlannedRival& rival : plan.rivals)
    rivals.push_back(fmt::format("{} ({})", rival.title, PercentText(rival.of_diagnosis)));
  return EnumerationText(rivals);
}

// What is open, from the most general verdict to the choice among rivals.
std::string WhatIsOpen(const PlanRecord& plan) {
  const bool is_one = plan.rivals.size() == 1;
  const auto would_show = [&] {
    return fmt::format("which recording would best show {}, if {} there", RivalsText(plan),
                       is_one ? "it were" : "one of them were");
  };
  if (IsAdequate(plan) && plan.no_effect < kLikely)
    return fmt::format(
        "No missing effect can be named with certainty, but one is more probable than none "
        "(probability that none is missing: {}). The plan tells {}.",
        PercentText(plan.no_effect), would_show());
  if (IsAdequate(plan))
    return fmt::format(
        "Nothing is open: the recordings show no missing effect (probability that none is missing: "
        "{}). The plan only tells {}.",
        PercentText(plan.no_effect), would_show());
  if (plan.verdict == VerdictName(Verdict::kNoPower))
    return fmt::format("These recordings could not show any effect. The plan tells {}.",
                       would_show());
  if (is_one)
    return fmt::format("Whether {} is missing, or something else, is open.", RivalsText(plan));
  return fmt::format("The diagnosis cannot tell apart {}.", RivalsText(plan));
}

// The nuisance that is more probable than any rival; null: there is none.
const LeftNuisance* MostProbableNuisance(const PlanRecord& plan) {
  const LeftNuisance* most = nullptr;
  for (const LeftNuisance& nuisance : plan.also_left)
    if (most == nullptr || nuisance.probability > most->probability) most = &nuisance;
  const bool is_behind =
      most != nullptr &&
      std::any_of(plan.rivals.begin(), plan.rivals.end(), [&](const PlannedRival& rival) {
        return rival.of_diagnosis >= most->probability;
      });
  return is_behind ? nullptr : most;
}

// The nuisances, other than `known`, that the diagnosis has left and that the plan does not weigh.
std::string NotWeighed(const PlanRecord& plan, const LeftNuisance* known) {
  std::vector<std::string> nuisances;
  for (const LeftNuisance& nuisance : plan.also_left)
    if (&nuisance != known)
      nuisances.push_back(
          fmt::format("{} ({})", nuisance.title, PercentText(nuisance.probability)));
  if (nuisances.empty()) return "";
  return fmt::format(
      " Errors of the measurement or of the discretisation could explain it, too ({}); a plan does "
      "not count them.",
      fmt::join(nuisances, ", "));
}

// The share of recordings like those of the run that lead to the right name.
std::string ShareNow(const PlanRecord& plan) {
  double now = 0;
  bool has_pair = false;
  for (const PlannedRival& rival : plan.rivals) {
    now += rival.probability * rival.named_now;
    has_pair = has_pair || rival.IsPair();
  }
  return fmt::format(
      " If {} is missing, recordings like these lead to the right name in {} of "
      "cases{}.",
      plan.rivals.size() == 1 ? "it" : "one of them", PercentText(now),
      has_pair ? ", where two effects at once count as not named" : "");
}

std::string Question(const PlanRecord& plan) {
  // Nuisances are part of the probability that no effect is missing.
  const bool is_open = !IsAdequate(plan) && plan.verdict != VerdictName(Verdict::kNoPower);
  const LeftNuisance* likelier = is_open ? MostProbableNuisance(plan) : nullptr;
  std::string text;
  if (likelier != nullptr)
    text = fmt::format(
        "The most probable explanation is {} ({}), which is no physical effect. A plan does not "
        "weigh it: the shares of right names hold only if an effect is what is missing. ",
        likelier->title, PercentText(likelier->probability));
  text += WhatIsOpen(plan) + ShareNow(plan);
  if (is_open) text += NotWeighed(plan, likelier);
  if (!plan.not_predicted.empty())
    text += fmt::format(" Not planned for: {}.", fmt::join(plan.not_predicted, ", "));
  return text;
}

std::string WhyNot(const PlanRecord& plan) {
  std::string reasons;
  for (const PlannedOutcome& outcome : plan.outcomes)
    if (!outcome.IsPlayable())
      reasons +=
          "\n" + Wrapped(fmt::format("\"{}\" cannot be made: {}", outcome.name, outcome.message),
                         "", "  ");
  return reasons;
}

// The nuisances that could not be tried, each once with the recordings of which this holds.
std::string Untried(const PlanRecord& plan) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> recordings;
  for (const PlannedOutcome& outcome : plan.outcomes)
    for (const UntriedEffect& nuisance : outcome.untried)
      recordings[{nuisance.type, nuisance.why}].push_back(fmt::format("\"{}\"", outcome.name));
  std::string text;
  for (const auto& [nuisance, names] : recordings)
    text +=
        "\n" + Wrapped(fmt::format("not tried with {}: {}; {}. The share of right names and the "
                                   "intervals with such a recording may be too good.",
                                   EnumerationText(names), nuisance.first, nuisance.second),
                       "", "  ");
  return text;
}

// The pairs of rivals that no recording tells apart, with the largest λ that one reaches.
std::string Inseparable(const PlanRecord& plan) {
  std::vector<std::string> pairs;
  const std::vector<PlannedPair>& all = plan.outcomes.front().pairs;
  const auto title = [&](const std::string& effect) {
    for (const PlannedRival& rival : plan.rivals)
      if (rival.effect == effect) return rival.title;
    return effect;
  };
  for (size_t k = 0; k < all.size(); ++k) {
    double largest = 0;
    for (const PlannedOutcome& outcome : plan.outcomes)
      if (outcome.IsPlayable()) largest = std::max(largest, outcome.pairs[k].lambda_then);
    if (largest < kSeparableLambda)
      pairs.push_back(fmt::format("{} and {} (λ at most {:.2g})", title(all[k].first),
                                  title(all[k].second), largest));
  }
  if (pairs.empty()) return "";
  return fmt::format(" None of them tells apart {}; λ = {:g} is needed.", EnumerationText(pairs),
                     kSeparableLambda);
}

std::string Advice(const PlanRecord& plan) {
  if (plan.outcomes.empty() || !plan.outcomes.front().IsPlayable())
    return "The model can play none of these recordings.";
  const PlannedOutcome& best = plan.outcomes.front();
  std::vector<std::string> named;
  for (size_t k = 0; k < plan.rivals.size(); ++k)
    named.push_back(
        fmt::format("{} if it is {}", PercentText(best.named[k]), plan.rivals[k].title));
  if (best.probability < kWorthMaking)
    return fmt::format(
        "None of the {} recordings that were tried is likely to decide it. The best, "
        "{} ({:.2g} s), would lead to the right name in {} of cases: {}.{}",
        plan.outcomes.size(), best.what, best.seconds, PercentText(best.probability),
        EnumerationText(named), Inseparable(plan));
  return fmt::format("{}: {} ({:.2g} s). With it the right name is expected in {} of cases{}: {}.",
                     IsAdequate(plan) ? "The best recording" : "Record next", best.what,
                     best.seconds, PercentText(best.probability),
                     IsAdequate(plan) ? " in which one is missing" : "", EnumerationText(named));
}

std::string LambdaText(double lambda) {
  return std::isfinite(lambda) ? fmt::format("{:.3g}", lambda) : "–";
}

std::string Table(const PlanRecord& plan) {
  size_t width = DisplayWidth("recording");
  for (const PlannedOutcome& outcome : plan.outcomes)
    width = std::max(width, DisplayWidth(outcome.name));
  std::string table = "  " + PaddedRight("recording", width + 2) + PaddedLeft("right name", 10) +
                      PaddedLeft("least λ", 10) + PaddedLeft("length", 10) + "\n";
  for (const PlannedOutcome& outcome : plan.outcomes) {
    if (!outcome.IsPlayable()) continue;
    table += "  " + PaddedRight(outcome.name, width + 2) +
             PaddedLeft(PercentText(outcome.probability), 10) +
             PaddedLeft(LambdaText(outcome.LeastLambda()), 10) +
             PaddedLeft(fmt::format("{:.2f} s", outcome.seconds), 10) + "\n";
  }
  return table;
}

std::string Sizes(const PlanRecord& plan) {
  const auto is_pair = [&](const std::string& name) {
    return std::any_of(plan.rivals.begin(), plan.rivals.end(), [&](const PlannedRival& rival) {
      return rival.effect == name && rival.IsPair();
    });
  };
  std::string lines;
  for (const PlannedSize& size : plan.outcomes.front().sizes) {
    const std::string what = is_pair(size.effect)
                                 ? fmt::format("{} ({})", size.parameter, size.effect)
                                 : fmt::format("{}.{}", size.effect, size.parameter);
    lines += fmt::format("  {}: {:.3g} ± {:.2g} {}, now ± {:.2g} {}\n", what, size.value,
                         size.half_width_then, size.unit, size.half_width_now, size.unit);
  }
  return lines;
}

}  // namespace

std::string PlanSummary(const PlanRecord& plan) {
  std::string text = Wrapped(Question(plan), "", "") + Wrapped(Advice(plan), "", "");
  if (plan.outcomes.empty() || !plan.outcomes.front().IsPlayable()) return text + WhyNot(plan);
  text += Wrapped(
      "The two shares of right names are not comparable: the first is of recordings like those "
      "that are there, decided among all effects and nuisances; the second starts from what the "
      "recordings have shown and is decided between these effects only.",
      "", "");
  const auto failed = std::count_if(plan.outcomes.begin(), plan.outcomes.end(),
                                    [](const auto& outcome) { return !outcome.IsPlayable(); });
  if (failed > 0)
    text += Wrapped(fmt::format("{} of {} recordings cannot be made; --verbose says why.", failed,
                                plan.outcomes.size()),
                    "", "");
  return text;
}

std::string PlanReport(const PlanRecord& plan) {
  // Without a recording that can be made, the summary says everything.
  if (plan.outcomes.empty() || !plan.outcomes.front().IsPlayable()) return PlanSummary(plan);
  std::string text = PlanSummary(plan) + "\n" + Table(plan);
  text += "\n" + Wrapped(
                     "λ is the squared distance between the predictions of two rivals in units of "
                     "the noise, for the pair that is hardest to tell apart; λ = 12 tells two "
                     "effects apart in four cases of five.",
                     "", "");
  if (!plan.outcomes.front().sizes.empty())
    text +=
        "\nExpected 95 % intervals with the best recording, if the effect is the missing one:\n" +
        Sizes(plan);
  return text + Untried(plan) + WhyNot(plan);
}

}  // namespace lacuna
