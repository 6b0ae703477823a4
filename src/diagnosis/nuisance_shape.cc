// Errors of the object's three dimensions, by finite differences of predictions of a larger body.
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// The finite difference stretches the body by this share of the prior's standard deviation: a
// larger change alters the phase of a long motion, which is not linear.
constexpr double kProbe = 0.1;

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "shape";
  card.title = "the object's dimensions";
  card.directions = "the object larger along each axis, by a finite difference";
  card.prior = "0.3 % of each dimension";
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
  const Model& model = at.problem.models().front().model();
  const TetMesh& mesh = at.problem.body()->mesh;
  // A gripped face stays in the grip.
  Eigen::Vector3d centre = mesh.nodes.rowwise().mean();
  if (!model.grips.empty() && model.grips.front().nodes.size() > 0)
    centre = mesh.nodes(Eigen::all, model.grips.front().nodes).rowwise().mean();
  const PredictionStudy study = at.problem.WithEstimatedNoise();
  const Eigen::VectorXd& residual = at.misfit.residual;
  NuisanceCandidate candidate;
  candidate.columns = Eigen::MatrixXd::Zero(residual.size(), 3);
  for (int axis = 0; axis < 3; ++axis) {
    TetMesh larger = mesh;
    larger.nodes.row(axis).array() +=
        kProbe * kThresholds.nuisances.shape * (mesh.nodes.row(axis).array() - centre[axis]);
    const LinearisedMisfit changed =
        CalibrationProblem(study, larger).Linearise(at.values, false, {}, nullptr, &at.misfit);
    if (!changed.usable || changed.residual.size() != residual.size()) return std::nullopt;
    candidate.columns.col(axis) = (changed.residual - residual) / kProbe;
    candidate.priors.push_back({0, 1, false});
  }
  return candidate;
}

}  // namespace

NuisanceEntry ShapeNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
