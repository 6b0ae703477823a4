// Measured forces that are too small or too large by the same factor: a load cell or an amplifier
// that was calibrated wrongly.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"
#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "load_scale";
  card.title = "the scale of the loads";
  card.directions = "the measured forces on the object larger by the same share";
  card.prior = "20 %";
  card.residual_when_present =
      "The residual is proportional to the response to the measured forces. Where nothing else "
      "acts "
      "on the object, a wrong modulus absorbs it.";
  card.advice = "check the calibration of the loads: hang a known weight on the load cell";
  card.source = NuisanceSource::kMeasurement;
  card.is_shared_in_scene = true;
  card.trial.limits_detection = true;
  return card;
}

// The measured forces of a model, in the order of the recording.
EffectList LoadsOf(const Model& model) {
  EffectList loads;
  std::copy_if(model.effects.begin(), model.effects.end(), std::back_inserter(loads),
               [](const std::shared_ptr<const Effect>& effect) {
                 return dynamic_cast<const PrescribedForce*>(effect.get()) != nullptr;
               });
  return loads;
}

// A share x of the loads F is a share (x − a)/(1 + a) of the loads (1 + a) F.
void Apply(const Eigen::VectorXd& amounts, StudyBesideNuisance* beside) {
  const double share = amounts[0], scale = 1 + share;
  for (PredictedRecording& item : beside->study.recordings)
    for (MeasuredForce& force : item.recording.object.forces) force.forces *= scale;
  LinearPrior& prior = beside->priors.front();
  prior.mean = (prior.mean - share) / scale;
  prior.deviation /= std::abs(scale);
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  size_t most = 0;  // loads of a recording
  for (const RecordingModel& model : at.problem.models())
    most = std::max(most, LoadsOf(model.model()).size());
  if (most == 0) return std::nullopt;
  std::vector<MisfitDirection> directions(most);
  for (size_t k = 0; k < most; ++k) {
    directions[k].perturbation_in = [k](const Model& placed) {
      const EffectList loads = LoadsOf(placed);
      return k < loads.size() ? Perturbation{.effect = loads[k]} : Perturbation{};
    };
  }
  const LinearisedMisfit misfit = at.problem.Linearise(
      at.values, {.with_jacobian = true, .directions = directions, .near = &at.misfit});
  if (!misfit.usable || misfit.residual.size() != at.misfit.residual.size())
    return Untried(at, "the motion with other loads could not be predicted");
  NuisanceCandidate candidate;
  candidate.columns = misfit.jacobian.rightCols(static_cast<Eigen::Index>(most)).rowwise().sum();
  candidate.priors = {{0, kThresholds.nuisances.load_scale, false}};
  candidate.apply = &Apply;
  return candidate;
}

}  // namespace

NuisanceEntry LoadScaleNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
