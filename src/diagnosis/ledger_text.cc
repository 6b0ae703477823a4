#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text_layout.h"
#include "diagnosis/ledger.h"

namespace lacuna {
namespace {

constexpr double kMoved = 1;            // deviations: less is not told of the model's parameters
constexpr const char* kTrunk = "│   ";  // beside what belongs to a model with more below it

std::string Error(double rms, double in_noise) {
  return fmt::format("{:7.3f} mm {:5.1f} σ", 1e3 * rms, in_noise);
}

std::string Of(const MisfitMeasure& measure) {
  return measure.points == 0 ? PaddedRight("      –", 18) : Error(measure.rms, measure.in_noise);
}

std::string ErrorTable(const LedgerModel& model, const std::string& margin) {
  std::string table =
      margin + PaddedRight("", 26) + PaddedRight("fitted frames", 22) + "held out\n";
  for (const FittedRecording& recording : model.record.recordings)
    table += margin + "  " +
             PaddedRight(recording.name + (recording.fitted ? "" : " (not fitted)"), 24) +
             PaddedRight(Of(recording.in_fit), 22) + Of(recording.held_out) + "\n";
  return table;
}

std::string Move(const ParameterMove& move) {
  const std::string unit = move.unit.empty() ? "" : " " + move.unit;
  if (move.added)
    return fmt::format("{} {:.4g}{} ({:.4g} … {:.4g}), new", move.name, move.after, unit, move.low,
                       move.high);
  const double relative = move.before != 0 ? move.after / move.before - 1 : 0;
  return fmt::format("{} {:.4g} → {:.4g}{} ({:+.1f} %, {:+.1f} of its deviations)", move.name,
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
    lines += fmt::format("{}  {} further parameter{} moved by less than {:g} deviation\n", margin,
                         quiet, quiet == 1 ? "" : "s", kMoved);
  return lines;
}

std::string Leaf(const RecordedEffect& effect) {
  if (!effect.refit_message.empty())
    return PaddedRight(effect.type, 24) + "not usable: " + effect.refit_message;
  return PaddedRight(effect.type, 24) + Error(effect.errors.held_out_rms, effect.errors.in_noise) +
         fmt::format("   evidence {:.1f}", effect.refit_evidence);
}

// What hangs below model `index`; the lines' margin is what connects it with its forebears.
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
      if (effect.refitted && !is_child(effect)) leaves.push_back(&effect);

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
    text += Wrapped(VerdictWithNames(diagnosis) + ": " + diagnosis.explanation, own, own + "  ");
    if (!diagnosis.experiment.empty())
      text += Wrapped("what would tell: " + diagnosis.experiment, own, own + "  ");
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
      text += Error(child.errors.held_out_rms, child.errors.in_noise) +
              fmt::format("   {:.0f} % {} than before", std::abs(100 * child.gain),
                          child.gain >= 0 ? "less" : "more");
    text += "\n" + Branch(ledger, children[k], margin + (is_last ? "    " : kTrunk));
  }
  return text;
}

std::string Total(const LedgerModel& model) {
  return fmt::format("{:.3f} mm, {:.1f} σ", 1e3 * model.errors.held_out_rms, model.errors.in_noise);
}

// The effects that lead from the first model to this one.
std::string AddedUpTo(const Ledger& ledger, const LedgerModel& model) {
  if (model.parent < 0) return "nothing was added";
  const LedgerModel& parent = ledger.models[static_cast<size_t>(model.parent)];
  return (parent.parent < 0 ? "" : AddedUpTo(ledger, parent) + ", ") + model.added;
}

}  // namespace

std::string LedgerInWords(const Ledger& ledger) {
  const LedgerModel& first = ledger.models.front();
  const LedgerModel& best = ledger.Best();
  const char* which = first.errors.has_held_out ? "held out" : "fitted";
  std::string text = PaddedRight(first.name, 35) +
                     Error(first.errors.held_out_rms, first.errors.in_noise) + "   " + which +
                     "\n" + Branch(ledger, 0, "");
  text += "\n";
  if (!ledger.ending.empty()) text += Wrapped(ledger.ending, "", "") + "\n";
  const auto row = [&](const char* name, const std::string& value) {
    text += PaddedRight(name, 24) + value + "\n";
  };
  row(first.errors.has_held_out ? "held-out error before" : "error before", Total(first));
  row("what was missing", AddedUpTo(ledger, best));
  row(first.errors.has_held_out ? "held-out error after" : "error after", Total(best));
  return text;
}

}  // namespace lacuna
