// A grip that ends elsewhere than in the model, so that more or less of the object is held.
//
// A grip that reaches further by δ leaves the same object with a shorter free part. The model's
// mesh is given that shape: with d the direction from the centroid of the gripped nodes to that of
// the object, x = X·d the position of a node along it, x₁ the largest one of a gripped node and x₂
// that of any node, a node moves by
//   δ (1 − t) d,   t = (x − x₁)/(x₂ − x₁) between 0 and 1,
// so that the whole grip moves by δ and the other end stays. Nodes of other grips stay, too.
// Markers keep their places.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "calibration/listed_nodes.h"
#include "calibration/parameter_response.h"
#include "core/error.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// The finite difference moves the end of a grip by this share of the standard deviation. A larger
// change alters the phase of a long motion, which is not linear.
constexpr double kProbe = 0.1;
// The largest amount, in standard deviations, for which a column is made. Larger: the column is
// that of an extent which the prior nearly rules out.
constexpr double kMostAmount = 3;
// A grip whose centroid is this close to that of the object, relative to the diagonal of its box,
// has no inward direction and no column. Larger: fewer grips have one.
constexpr double kCentral = 0.05;

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_extent";
  card.title = "how far the grips reach";
  card.directions = "each grip reaching further into the object, by a finite difference";
  card.prior = "1 mm for each grip";
  card.residual_when_present =
      "The free part of the object is longer or shorter than in the model, so that it vibrates too "
      "slowly or too fast, by a share that depends on the mode.";
  card.advice = "measure how far the clamp reaches";
  card.source = NuisanceSource::kGrip;
  card.is_shared_in_scene = true;
  card.outgrows_first_order = true;
  card.trial.limits_detection = true;
  card.trial.control = "grip";
  card.trial.control_position = 1;
  card.trial.least_clamp_error = 1e-3;
  card.trial.largest_clamp_error = 2e-3;
  return card;
}

Eigen::Vector3d Inwards(const Eigen::Matrix3Xd& nodes, const Eigen::VectorXi& gripped) {
  return nodes.rowwise().mean() - nodes(Eigen::all, gripped).rowwise().mean();
}

// Whether a model holds these nodes together along all axes, and not where a scan shows them: a
// grip that follows a scan would be registered anew with the changed mesh.
bool HoldsFirmly(const RecordingModel& model, const Eigen::VectorXi& nodes) {
  const std::vector<Grip>& grips = model.model().grips;
  for (size_t g = 0; g < grips.size(); ++g) {
    if (!HoldsExactly(grips[g], nodes) || !grips[g].axes.IsAll()) continue;
    const RecordedGrip* recorded = RecordedAs(model.measured(), g);
    return recorded == nullptr || recorded->motion != GripMotion::kFollowsScan;
  }
  return false;
}

// Whether the extent of a grip can be changed: it holds its nodes along all axes in all recordings,
// and has an inward direction.
bool HasExtent(const CalibrationProblem& problem, const Eigen::VectorXi& gripped) {
  const Eigen::Matrix3Xd& nodes = problem.body()->mesh.nodes;
  const Eigen::Vector3d size = nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff();
  if (!(Inwards(nodes, gripped).norm() > kCentral * size.norm())) return false;
  return std::all_of(problem.models().begin(), problem.models().end(),
                     [&](const RecordingModel& model) { return HoldsFirmly(model, gripped); });
}

// Where the nodes are once the grip of `gripped` reaches further by `distance`, m. The nodes of the
// other grips of all recordings stay.
Eigen::Matrix3Xd WithLongerGrip(const CalibrationProblem& problem, const Eigen::VectorXi& gripped,
                                double distance) {
  const Eigen::Matrix3Xd& nodes = problem.body()->mesh.nodes;
  const Eigen::Vector3d inwards = Inwards(nodes, gripped).normalized();
  const Eigen::RowVectorXd along = inwards.transpose() * nodes;
  const double end = along(gripped).maxCoeff();
  Eigen::RowVectorXd share = 1 - ((along.array() - end) / (along.maxCoeff() - end)).max(0).min(1);
  for (const RecordingModel& model : problem.models())
    for (const Grip& other : model.model().grips)
      if (!HoldsExactly(other, gripped)) share(other.nodes).setZero();
  return nodes + distance * inwards * share;
}

// The residual of the model with the mesh that a longer grip leaves, m. Empty where it cannot be
// simulated.
Eigen::VectorXd ResidualWith(const CalibrationProblem& problem, const Eigen::VectorXi& gripped,
                             double distance, const Eigen::VectorXd& values,
                             const PredictionStudy& study, const LinearisedMisfit& near) {
  TetMesh mesh = problem.body()->mesh;
  mesh.nodes = WithLongerGrip(problem, gripped, distance);
  std::unique_ptr<const CalibrationProblem> changed;
  try {
    changed = std::make_unique<const CalibrationProblem>(study, mesh);
  } catch (const InputError&) {
    return {};  // for example, a marker is too far from this mesh
  }
  return changed->Linearise(values, {.near = &near}).residual;
}

// The column of one grip: the change per metre by which it reaches further, with the parameters
// that keep the motion in phase. First a tangent; then, since the column should hold at the extent
// that the recordings suggest, the chord to there or, where that cannot be simulated, to half or a
// quarter of it. The suggestion is that of a fit beside the parameters alone.
Eigen::VectorXd ColumnOf(const Eigen::VectorXi& gripped, const PredictionStudy& study,
                         const NuisanceContext& at) {
  const double deviation = kThresholds.nuisances.shift;
  const Eigen::VectorXd& residual = at.misfit.residual;
  const auto change_by = [&](double distance, const Eigen::VectorXd& values) -> Eigen::VectorXd {
    const Eigen::VectorXd there =
        ResidualWith(at.problem, gripped, distance, values, study, at.misfit);
    return there.size() == residual.size() ? there - residual : Eigen::VectorXd();
  };
  const Eigen::VectorXd tangent = change_by(kProbe * deviation, at.values);
  if (tangent.size() == 0) return {};
  // In units of the deviation, like the amounts from here on.
  const Eigen::MatrixXd jacobian = at.misfit.jacobian.leftCols(at.values.size());
  const Eigen::VectorXd response =
      ParameterResponse(at.problem, at.values, at.misfit, /*fitted_only=*/false)
          .To(tangent / kProbe);
  const Eigen::VectorXd in_phase = tangent / kProbe + jacobian * response;
  Eigen::MatrixXd columns(residual.size(), at.values.size() + 1);
  columns << jacobian, in_phase;
  std::vector<LinearPrior> priors = PriorsAbout(at.problem.parameters(), at.values);
  priors.push_back({0, 1, false});
  const Eigen::VectorXd fitted =
      LinearGaussianModel(WhitenedRows(residual, at.misfit), WhitenedRows(columns, at.misfit),
                          std::move(priors))
          .FitAll(1)
          .change;
  const double suggested = std::clamp(fitted[fitted.size() - 1], -kMostAmount, kMostAmount);
  for (const double share : {1.0, 0.5, 0.25}) {
    const double amount = share * suggested;
    if (std::abs(amount) <= kProbe) break;
    const Eigen::VectorXd moved = MovedBy(at.problem.parameters(), at.values, amount * response);
    const Eigen::VectorXd chord = change_by(amount * deviation, moved);
    if (chord.size() > 0) return chord / (amount * deviation);
  }
  return in_phase / deviation;
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  const PredictionStudy study = WithListedNodes(at.problem);
  NuisanceCandidate candidate;
  candidate.columns.resize(at.misfit.residual.size(), 0);
  bool applies = false;
  for (const GripMotions::Grip& grip : at.grips.grips) {
    const Eigen::VectorXi& gripped = FirstOf(grip, at.problem).nodes;
    if (!HasExtent(at.problem, gripped)) continue;
    applies = true;
    const Eigen::VectorXd column = ColumnOf(gripped, study, at);
    if (column.size() == 0) continue;
    candidate.columns.conservativeResize(Eigen::NoChange, candidate.columns.cols() + 1);
    candidate.columns.rightCols(1) = column;
    candidate.priors.push_back({0, kThresholds.nuisances.shift, false});
  }
  if (candidate.priors.empty() && applies)
    candidate.untried = "no motion with a longer or a shorter grip could be predicted";
  if (!applies) return std::nullopt;
  return candidate;
}

}  // namespace

NuisanceEntry GripExtentNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
