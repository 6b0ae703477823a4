// Errors of the object's three dimensions, by finite differences of predictions of a larger body.
#include "calibration/parameter_response.h"
#include "calibration/size_errors.h"
#include "diagnosis/nuisance_catalogue.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "shape";
  card.title = "the object's dimensions";
  card.directions = "the object larger along each axis, by a finite difference";
  card.prior = "size_deviation of the experiment (0.3 %) for each dimension";
  card.residual_when_present =
      "Bending stiffness grows with the cube of the thickness, so bending in one direction is too "
      "fast or too slow compared with bending in the other and with stretching.";
  card.advice = "measure the object again";
  card.source = NuisanceSource::kShape;
  card.is_always_in_model = true;
  card.is_shared_in_scene = true;
  card.trial.limits_detection = true;
  return card;
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  if (at.problem.study().size_deviation == 0) return std::nullopt;  // they are known exactly
  NuisanceCandidate candidate;
  const Eigen::MatrixXd changes = ChangesBySize(at.problem, at.values, at.misfit);
  if (changes.cols() == 0)
    return Untried(at, "the motion of a larger object could not be predicted");
  candidate.columns =
      ParameterResponse(at.problem, at.values, at.misfit, /*fitted_only=*/false).InPhase(changes);
  candidate.priors.assign(3, {0, 1, false});
  return candidate;
}

}  // namespace

NuisanceEntry ShapeNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
