#include "app/explain_nuisance.h"

#include <fmt/format.h>

#include <string>

#include "core/text_layout.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

std::string SourceText(NuisanceSource source) {
  switch (source) {
    case NuisanceSource::kDiscretisation:
      return "an error of the discretisation";
    case NuisanceSource::kShape:
      return "an error of the object's shape";
    case NuisanceSource::kGrip:
      return "an error of a grip";
    case NuisanceSource::kMeasurement:
      return "an error of the measurement";
  }
  return "";
}

std::string InADiagnosis(const NuisanceCard& card) {
  std::string text = card.is_always_in_model
                         ? "Part of every model with which a diagnosis compares effects."
                         : "Enters the model if its evidence clearly exceeds that of every effect; "
                           "otherwise it competes with the effects as an explanation.";
  if (card.acts_on_single_frames)
    text += " It differs from frame to frame, so it predicts nothing for held-out frames.";
  if (card.needs_few_frames)
    text += fmt::format(
        " It is left out of recordings with more than {} frames; the diagnosis then says so. "
        "`every` in the experiment reduces the number of frames.",
        kThresholds.nuisances.most_single_frames);
  if (card.outgrows_first_order) text += " A first-order prediction underestimates it.";
  if (card.shrinks_with_time_step)
    text += " The diagnosis may shorten a time step that the experiment leaves open.";
  return text;
}

}  // namespace

int ExplainNuisance(const NuisanceCard& card) {
  fmt::print("{}: {}  ({})\n", SourceText(card.source), card.title, card.name);
  const auto section = [](const std::string& heading, const std::string& text) {
    fmt::print("\n{}\n{}", heading, Wrapped(text, "  ", "  "));
  };
  section("Directions", card.directions);
  section("Expected size", card.prior);
  section("When it is present", card.residual_when_present);
  section("In a diagnosis", InADiagnosis(card));
  section("What to do", card.advice);
  return 0;
}

}  // namespace lacuna
