// Parameters of the model that are not the same in all recordings: the object has aged, warmed up
// or been replaced, or something else than what is recorded has changed between them.
#include <set>

#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "recordings_differ";
  card.title = "parameters that differ between the recordings";
  card.directions = "every fitted parameter of the model, in each recording by itself";
  card.prior =
      "20 % of a positive parameter, 20 % of half the plausible range of another one, in each "
      "recording";
  card.residual_when_present =
      "The model misses each recording in another way: it is too stiff for one and too soft for "
      "another.";
  card.advice =
      "compare the parameters of each recording, and look for what has changed between them: the "
      "object, its temperature, its clamping or its load";
  card.source = NuisanceSource::kMeasurement;
  card.separates_recordings = true;
  card.outgrows_first_order = true;
  card.trial.limits_detection = true;
  return card;
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  std::set<size_t> recordings;
  for (const LinearisedMisfit::Part& part : at.misfit.parts) recordings.insert(part.recording);
  const Eigen::Index parameters = static_cast<Eigen::Index>(at.problem.study().fitted.size());
  if (recordings.size() < 2 || parameters == 0) return std::nullopt;
  NuisanceCandidate candidate;
  candidate.columns = Eigen::MatrixXd::Zero(
      at.misfit.residual.size(), parameters * static_cast<Eigen::Index>(recordings.size()));
  Eigen::Index first = 0;
  for (const size_t recording : recordings) {
    for (const LinearisedMisfit::Part& part : at.misfit.parts)
      if (part.recording == recording)
        candidate.columns.block(part.first_row, first, part.layout.Rows(), parameters) =
            at.misfit.jacobian.block(part.first_row, 0, part.layout.Rows(), parameters);
    for (Eigen::Index k = 0; k < parameters; ++k) {
      const CalibratedParameter& parameter = at.problem.parameters()[static_cast<size_t>(k)];
      const double size = parameter.log_scale ? at.values[k] : parameter.typical;
      candidate.priors.push_back({0, kThresholds.nuisances.parameter_difference * size, false});
    }
    first += parameters;
  }
  return candidate;
}

}  // namespace

NuisanceEntry RecordingsDifferNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
