#include "report/ledger_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/text_layout.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

// Parameters that changed by at most this many standard deviations are only counted.
constexpr double kMoved = 1;
// The margin of a model's lines where further models hang below it.
constexpr const char* kTrunk = "│   ";

std::string Error(double rms, double over_sigma) {
  return fmt::format("{:7.3f} mm {:5.1f} σ", 1e3 * rms, over_sigma);
}

std::string ErrorCell(const MisfitMeasure& measure) {
  return measure.points == 0 ? PaddedRight("      –", 18)
                             : Error(measure.rms, measure.rms_over_sigma);
}

std::string ErrorTable(const LedgerModel& model, const std::string& margin) {
  std::string table =
      margin + PaddedRight("", 26) + PaddedRight("fitted frames", 22) + "held out\n";
  for (const FittedRecording& recording : model.record.recordings)
    table += margin + "  " +
             PaddedRight(recording.name + (recording.fitted ? "" : " (not fitted)"), 24) +
             PaddedRight(ErrorCell(recording.in_fit), 22) + ErrorCell(recording.held_out) + "\n";
  return table;
}

std::string Move(const ParameterMove& move) {
  const std::string unit = move.unit.empty() ? "" : " " + move.unit;
  if (move.added)
    return fmt::format("{} {:.4g}{}, with fine elements and steps {:.4g} … {:.4g}, new", move.name,
                       move.after, unit, move.low, move.high);
  const double relative = move.before != 0 ? move.after / move.before - 1 : 0;
  return fmt::format("{} {:.4g} → {:.4g}{} ({:+.1f} %, {:+.1f} standard deviations)", move.name,
                     move.before, move.after, unit, 100 * relative, move.in_deviations);
}

std::string Moves(const LedgerModel& model, const std::string& margin) {
  std::string lines;
  int quiet = 0;
  for (const ParameterMove& move : model.moves) {
    if (move.added || std::abs(move.in_deviations) > kMoved)
      lines += Wrapped(Move(move), margin + "  ", margin + "      ");
    else
      ++quiet;
  }
  if (quiet > 0)
    lines +=
        fmt::format("{}  {} further parameter{} changed by less than {:g} standard deviation\n",
                    margin, quiet, quiet == 1 ? "" : "s", kMoved);
  return lines;
}

std::string Leaf(const RecordedEffect& effect) {
  if (!effect.HasUsableRefit())
    return PaddedRight(effect.type, 24) + "not usable: " + effect.refit->message;
  const ModelErrors& errors = effect.refit->errors;
  return PaddedRight(effect.type, 24) + Error(errors.held_out_rms, errors.rms_over_sigma) +
         fmt::format("   evidence {:.1f}", effect.refit->evidence);
}

// The models and leaves below model `index`. The margin holds the lines that connect it to its
// ancestors.
std::string Branch(const Ledger& ledger, size_t index, const std::string& margin) {
  const LedgerModel& model = ledger.models[index];
  std::vector<size_t> children;
  for (size_t k = 0; k < ledger.models.size(); ++k)
    if (ledger.models[k].parent == static_cast<int>(index)) children.push_back(k);
  const auto is_child = [&](const RecordedEffect& effect) {
    return std::any_of(children.begin(), children.end(),
                       [&](size_t k) { return ledger.models[k].added == effect.type; });
  };
  std::vector<const RecordedEffect*> leaves;
  if (model.diagnosis)
    for (const RecordedEffect& effect : model.diagnosis->ranking)
      if (effect.refit && !is_child(effect)) leaves.push_back(&effect);

  const bool has_more = !children.empty() || !leaves.empty();
  const std::string own = margin + (has_more ? kTrunk : "    ");
  std::string text;
  if (!model.record.usable) {
    text += Wrapped("the fit is not usable: " + model.record.message, own, own + "  ");
  } else {
    text += ErrorTable(model, own);
    if (model.parent >= 0) text += Moves(model, own);
  }
  if (model.diagnosis) {
    const DiagnosisRecord& diagnosis = *model.diagnosis;
    const std::string blank = has_more ? margin + "│" : margin;
    text += blank.substr(0, blank.find_last_not_of(' ') + 1) + "\n";
    text +=
        Wrapped(VerdictWithNames(diagnosis) + ": " + ExplainVerdict(diagnosis), own, own + "  ");
    if (!diagnosis.next_steps.empty())
      text += Wrapped("next: " + DescribeNextSteps(diagnosis), own, own + "  ");
  }
  for (size_t k = 0; k < leaves.size(); ++k) {
    const bool is_last = children.empty() && k + 1 == leaves.size();
    text += margin + (is_last ? "└── " : "├── ") + "tried  " + Leaf(*leaves[k]) + "\n";
  }
  for (size_t k = 0; k < children.size(); ++k) {
    const LedgerModel& child = ledger.models[children[k]];
    const bool is_last = k + 1 == children.size();
    text += margin + (is_last ? "└── " : "├── ") + "added  " + PaddedRight(child.added, 24);
    if (child.record.usable)
      text += Error(child.errors.held_out_rms, child.errors.rms_over_sigma) +
              fmt::format("   {:.0f} % {} than before", std::abs(100 * child.gain),
                          child.gain >= 0 ? "less" : "more");
    if (child.record.usable && !(child.gain > 0) && LowersError(child, 0))
      text += child.gain_with_reactions > 0
                  ? fmt::format("; with the measured forces, {:.0f} % less",
                                100 * child.gain_with_reactions)
                  : fmt::format("; with the points where they were measured, {:.0f} % less",
                                100 * child.gain_at_measured_places);
    text += "\n" + Branch(ledger, children[k], margin + (is_last ? "    " : kTrunk));
  }
  return text;
}

std::string Total(const LedgerModel& model) {
  return fmt::format("{:.3f} mm, {:.1f} σ", 1e3 * model.errors.held_out_rms,
                     model.errors.rms_over_sigma);
}

// The effects that lead from the first model to this one.
std::string AddedUpTo(const Ledger& ledger, const LedgerModel& model) {
  if (model.parent < 0) return "nothing was added";
  const LedgerModel& parent = ledger.models[static_cast<size_t>(model.parent)];
  return (parent.parent < 0 ? "" : AddedUpTo(ledger, parent) + ", ") + model.added;
}

}  // namespace

std::string DescribeEnding(const Ledger& ledger) {
  using Reason = LedgerEnding::Reason;
  const LedgerModel& last = ledger.models.back();
  switch (ledger.ending.reason) {
    case Reason::kNone:
      return "";
    case Reason::kVerdict:
      return fmt::format("The search ended with the verdict \"{}\".",
                         VerdictWithNames(last.diagnosis.value()));
    case Reason::kUndecided:
      return fmt::format(
          "The search ended undecided between {{{}}}, and none of them is added by guess{}. With "
          "--follow-best it continues with the first.",
          fmt::join(last.diagnosis->effects, ", "),
          last.diagnosis->next_steps.empty()
              ? ""
              : "; to decide: " + DescribeNextSteps(*last.diagnosis));
    case Reason::kMostEffects:
      return fmt::format("The search ended after {} added effects, although {} is still named.",
                         ledger.models.size() - 1, last.diagnosis->effects.front());
    case Reason::kNotFitted:
      return fmt::format("The search ended because {} cannot be fitted: {}.", last.added,
                         last.record.message);
    case Reason::kMayBeZero:
      return fmt::format(
          "The search ended because the size of {0} may be zero, as its 95 % interval contains 0: "
          "{0} does not count. Smaller elements (mesh.max_volume) or further recordings would make "
          "the interval narrower.",
          last.added);
    case Reason::kLittleGain:
      if (ledger.ending.least_gain == 0)
        return fmt::format(
            "The search ended because the {} error with {} is not smaller, but {:.1f} % larger: {} "
            "does not count.",
            last.errors.has_held_out ? "held-out" : "fitted", last.added, -100 * last.gain,
            last.added);
      return fmt::format(
          "The search ended because {} reduces the {} error by {:.1f} %, less than {:g} %.",
          last.added, last.errors.has_held_out ? "held-out" : "fitted", 100 * last.gain,
          100 * ledger.ending.least_gain);
  }
  return "";
}

std::string LedgerSummary(const Ledger& ledger) {
  const LedgerModel& first = ledger.models.front();
  const LedgerModel& best = ledger.Best();
  std::string text;
  if (ledger.HasEnded()) text += Wrapped(DescribeEnding(ledger), "", "") + "\n";
  const auto row = [&](const char* name, const std::string& value) {
    text += PaddedRight(name, 24) + value + "\n";
  };
  row(first.errors.has_held_out ? "held-out error before" : "error before", Total(first));
  row("what was added", AddedUpTo(ledger, best));
  if (const std::vector<std::string> effects = ledger.MayBeLeftOut(); !effects.empty())
    row("what may be left out",
        fmt::format("{}, whose size may be zero beside what was added later",
                    fmt::join(effects, ", ")));
  row(first.errors.has_held_out ? "held-out error after" : "error after", Total(best));
  return text;
}

std::string LedgerReport(const Ledger& ledger) {
  const LedgerModel& first = ledger.models.front();
  const char* which = first.errors.has_held_out ? "held out" : "fitted";
  return PaddedRight(first.name, 35) +
         Error(first.errors.held_out_rms, first.errors.rms_over_sigma) + "   " + which + "\n" +
         Branch(ledger, 0, "") + "\n" + LedgerSummary(ledger);
}

}  // namespace lacuna
