#include "report/agreement_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/text_layout.h"
#include "report/quantity_text.h"

namespace lacuna {
namespace {

std::string Estimate(const ParameterOfRecordings& parameter, size_t recording) {
  if (!std::isfinite(parameter.deviations[recording])) return "not determined";
  return fmt::format("{:.4g} ± {:.2g}", parameter.values[recording],
                     parameter.deviations[recording]);
}

// "young_modulus: 1.02e+05 ± 900 Pa from a, 9.8e+04 ± 1100 Pa from b"
std::string EachEstimate(const AgreementRecord& agreement, const ParameterOfRecordings& parameter) {
  std::vector<std::string> estimates;
  for (size_t k = 0; k < agreement.recordings.size(); ++k) {
    const std::string estimate = Estimate(parameter, k);
    estimates.push_back(fmt::format(
        "{} from {}",
        std::isfinite(parameter.deviations[k]) ? WithUnit(estimate, parameter.unit) : estimate,
        agreement.recordings[k]));
  }
  return fmt::format("{}: {}", parameter.name, fmt::join(estimates, ", "));
}

}  // namespace

std::string ExplainAgreement(const AgreementRecord& agreement) {
  if (agreement.recordings.empty()) return "";
  if (!agreement.Exists())
    return "The recordings alone do not determine the parameters well enough to be compared.";
  const std::string test =
      fmt::format("χ² = {:.1f} with {} degree{} of freedom, {}", agreement.chi_square,
                  agreement.degrees_of_freedom, agreement.degrees_of_freedom == 1 ? "" : "s",
                  ProbabilityText(agreement.p_value));
  if (!agreement.Disagree())
    return fmt::format(
        "The {} recordings agree: their parameters, each estimated from one recording alone, "
        "differ no more than by chance ({}).",
        agreement.recordings.size(), test);
  const ParameterOfRecordings& most = *agreement.MostDifferent();
  std::string text = fmt::format(
      "The {} recordings disagree about the parameters ({}), most about {} ({} if nothing else "
      "differs)",
      agreement.recordings.size(), test, EachEstimate(agreement, most),
      ProbabilityText(most.p_value));
  if (!most.odd_recording.empty())
    text += fmt::format("; {} differs most from the others", most.odd_recording);
  return text +
         ". Either something differs between the recordings, or the model lacks something that "
         "acts "
         "differently in them; the intervals of the fit do not include this.";
}

std::string AgreementTable(const AgreementRecord& agreement) {
  if (!agreement.Exists()) return "";
  constexpr size_t kColumn = 22;
  size_t width = DisplayWidth("parameter");
  for (const ParameterOfRecordings& parameter : agreement.parameters)
    width = std::max(width, DisplayWidth(WithUnit(parameter.name, "[" + parameter.unit + "]")));
  std::string text = "  " + PaddedRight("parameter", width);
  for (const std::string& recording : agreement.recordings) text += PaddedLeft(recording, kColumn);
  text += PaddedLeft("p", 10) + "\n";
  for (const ParameterOfRecordings& parameter : agreement.parameters) {
    text += "  " + PaddedRight(parameter.unit.empty()
                                   ? parameter.name
                                   : WithUnit(parameter.name, "[" + parameter.unit + "]"),
                               width);
    for (size_t k = 0; k < agreement.recordings.size(); ++k)
      text += PaddedLeft(Estimate(parameter, k), kColumn);
    text +=
        PaddedLeft(
            parameter.p_value <= 0.001 ? "≤ 0.001" : fmt::format("{:.2g}", parameter.p_value), 10) +
        "\n";
  }
  return text + Wrapped(
                    "p: the probability of such a difference by chance if only this parameter "
                    "may differ between the recordings; ± is one standard deviation",
                    "  ", "  ");
}

}  // namespace lacuna
