#include "diagnosis/extended_experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/quoted_text.h"
#include "diagnosis/model_change.h"
#include "effects/effect_text.h"
#include "effects/uniform_density.h"

namespace lacuna {
namespace {

std::string Written(const Effect& effect, const std::filesystem::path& experiment) {
  if (const auto text = FormatEffect(effect)) return *text;
  throw InputError(fmt::format(
      "{}: {} cannot be written down by the program; add the new effect to the file by hand",
      experiment.string(), effect.Card().type));
}

// The prior is written as it was in force, also where its mean was the start of the fit: the new
// experiment starts elsewhere, at what the same recordings gave. That it was the default one is
// written, too, because nobody has measured it.
std::string FittedEntry(const ModelParameter& parameter) {
  const CalibratedParameter& prior = parameter.prior;
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  std::string entry = fmt::format("    - {{name: {}", QuotedText(prior.name));
  if (std::isfinite(prior.min)) entry += fmt::format(", min: {}{}", prior.min, unit);
  if (std::isfinite(prior.max)) entry += fmt::format(", max: {}{}", prior.max, unit);
  const double mean = PriorMeanOf(prior);
  if (std::isfinite(prior.prior_deviation))
    entry += fmt::format(", mean: {}{}, deviation: {}{}", mean, unit,
                         prior.prior_deviation * (prior.log_scale ? mean : 1), unit) +
             (prior.has_default_prior ? ", prior: default" : "");
  return entry + "}\n";
}

}  // namespace

std::filesystem::path WriteExtendedExperiment(const FittedRun& fitted,
                                              const std::filesystem::path& run,
                                              const ScoredEffect& effect) {
  const std::filesystem::path folder = std::filesystem::absolute(run).lexically_normal();
  const std::filesystem::path parent =
      folder.filename().empty() ? folder.parent_path().parent_path() : folder.parent_path();
  const std::filesystem::path experiment =
      std::filesystem::absolute(fitted.study.file).lexically_normal();
  PredictionStudy judged = fitted.study;
  if (effect.baseline_values.size() > 0)
    judged.effects = WithValues(judged.effects, judged.fitted, effect.baseline_values);
  const PredictionStudy study = WithEffect(judged, effect);
  const std::string name = fitted.study.name + "+" + effect.candidate.type;

  std::string text = fmt::format(
      "# {} with {}{}, from the fit of {}.\n"
      "use: {}\n"
      "name: {}\n"
      "output: {}\n"
      "material: {}\n"
      "effects:\n",
      fitted.study.name, effect.candidate.type,
      effect.candidate.replaces_material
          ? " in place of " + fitted.study.effects.front()->Card().type
          : "",
      fitted.study.name, QuotedText(experiment.lexically_proximate(parent).generic_string()),
      QuotedText(name), QuotedText(name), Written(*study.effects.front(), experiment));
  for (size_t k = 1; k < study.effects.size(); ++k)
    if (!IsUniformDensity(*study.effects[k]))
      text += fmt::format("  - {}\n", Written(*study.effects[k], experiment));
  std::vector<std::string> candidates;  // still to be tried
  for (const OwnLaw& law : study.candidates)
    if (law.name != effect.candidate.type) candidates.push_back(Written(*law.effect, experiment));
  if (!study.candidates.empty())
    text += fmt::format("candidates: [{}]\n", fmt::join(candidates, ", "));
  const double explained = fitted.study.explained_misfit + 2 * std::max(0.0, effect.score.evidence);
  if (explained > 0) text += fmt::format("explained_misfit: {:.6g}\n", explained);
  text += "fit:\n  parameters:\n";
  for (const ModelParameter& parameter : study.fitted)
    if (!IsDensity(parameter, study.effects)) text += FittedEntry(parameter);
  const std::filesystem::path file = parent / (name + ".yaml");
  WriteFileAtomically(file, text);
  return file;
}

std::string WhyUnseen(const ScoredEffect& effect) {
  const std::string& type = effect.candidate.type;
  const std::vector<CandidateAmount> amounts = AmountsOf(effect.candidate);
  for (size_t k = 0; k < amounts.size(); ++k)
    if (effect.score.detectable[static_cast<Eigen::Index>(k)] < amounts[k].plausible) return "";
  const CandidateAmount& first = amounts.front();
  const double detectable = effect.score.detectable.minCoeff();
  if (!std::isfinite(detectable)) {
    return fmt::format(
        "{} changes nothing in these recordings that the fitted parameters cannot compensate for",
        type);
  }
  if (effect.candidate.IsPilot()) {
    return fmt::format(
        "the change by {} ({}) would have to be {:.2g} times as large to be detectable in these "
        "recordings",
        type, effect.candidate.variant, detectable);
  }
  return fmt::format(
      "{} would have to be larger than is plausible to be detectable in these recordings: {} of "
      "{:.2g} {}, while {:.2g} {} is plausible at most",
      type, first.name, detectable, first.unit, first.plausible, first.unit);
}

}  // namespace lacuna
