// The error of the finite element mesh.
//
// The first column is the change from the model's mesh to another one beyond what the parameters
// can compensate for (calibration/mesh_limit.h), the second the part of that change between the
// finest of the meshes and one whose elements are twice as large. The prior of the first expects
// the extrapolation to infinitely fine elements.
#include <algorithm>
#include <cmath>

#include "calibration/linear_misfit.h"
#include "calibration/mesh_limit.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "mesh";
  card.title = "the size of the elements";
  card.directions =
      "the change of the prediction with finer (for large meshes: coarser) elements, and with "
      "elements of twice the volume, each with parameters that compensate for as much as they "
      "can";
  card.prior = "the extrapolation to infinitely fine elements, and how far it is uncertain";
  card.residual_when_present =
      "A coarse mesh is too stiff where strains vary, near clamps above all, so its residual looks "
      "like that of a stiffness that varies along the object.";
  card.advice = "choose a smaller mesh.max_volume";
  card.source = NuisanceSource::kDiscretisation;
  card.is_always_in_model = true;
  card.is_shared_in_scene = true;
  card.trial.limits_detection = true;
  card.trial.control = "coarse_mesh";
  card.trial.control_position = 3;
  card.trial.element_volume = 4e-6;
  return card;
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  const std::optional<OtherMesh> mesh =
      MakeOtherMesh(at.problem, at.values, at.misfit, at.other_mesh);
  if (!mesh)
    return Untried(at, "no other mesh could be made, or the motion could not be predicted on it");
  // Between the finest mesh, which is the other or the model's own, and the other.
  const double halfway = mesh->IsFiner() ? mesh->ratio / 2 : 0.5;
  const Eigen::VectorXd between = ResidualAtRatio(at.problem, at.values, *mesh, halfway);
  if (between.size() != mesh->other.size())
    return Untried(at, "the motion could not be predicted with elements of twice the volume");
  NuisanceCandidate candidate;
  candidate.columns.resize(between.size(), 2);
  candidate.columns << mesh->other - mesh->own,
      (mesh->IsFiner() ? mesh->other : mesh->own) - between;
  const NuisanceThresholds& thresholds = kThresholds.nuisances;
  candidate.priors = {{mesh->ToLimit(), mesh->DeviationOfLimit(), false},
                      {0, thresholds.mesh_unknown, false}};
  candidate.unknown = thresholds.mesh_unknown * candidate.columns.col(1);
  return candidate;
}

}  // namespace

NuisanceEntry MeshNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
