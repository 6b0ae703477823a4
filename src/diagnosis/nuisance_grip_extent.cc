// A grip that ends elsewhere than in the model, so that more or less of the object is held.
//
// A grip that reaches further by δ leaves the same object with a shorter free part. The model's
// mesh is given that shape: with c the centroid of the gripped nodes, d the direction from there to
// the centroid of the object and ℓ its extent along d, a node at X moves by
//   δ (1 − t) d,   t = (X − c)·d/ℓ between 0 and 1,
// so that the grip moves by δ and the other end stays. Markers keep their places.
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/in_phase.h"
#include "calibration/linear_misfit.h"
#include "core/error.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// The finite difference moves the end of a grip by this share of the standard deviation. A larger
// change alters the phase of a long motion, which is not linear.
constexpr double kProbe = 0.1;
// The largest amount, in standard deviations, for which a column is made.
constexpr double kMostAmount = 3;
// A grip at the middle of the object, nearer to its centroid than this share of its extent, can
// reach further on either side.
constexpr double kCentral = 0.05;

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_extent";
  card.title = "the extent of a grip";
  card.directions = "each grip reaching further into the object, by a finite difference";
  card.prior = "1 mm for each grip";
  card.residual_when_present =
      "Natural frequencies are too high or too low, by a share that depends on the mode: as for a "
      "wrong stiffness near the grip.";
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

Eigen::Vector3d CentroidOf(const Eigen::Matrix3Xd& nodes, const Eigen::VectorXi& gripped) {
  return nodes(Eigen::all, gripped).rowwise().mean();
}

// Whether the grip is at the middle of the object.
bool IsCentral(const Eigen::Matrix3Xd& nodes, const Eigen::VectorXi& gripped) {
  const Eigen::Vector3d size = nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff();
  return (nodes.rowwise().mean() - CentroidOf(nodes, gripped)).norm() < kCentral * size.norm();
}

// Where the nodes are once the grip reaches further by `distance`, m.
Eigen::Matrix3Xd WithLongerGrip(const Eigen::Matrix3Xd& nodes, const Eigen::VectorXi& gripped,
                                double distance) {
  const Eigen::Vector3d grip = CentroidOf(nodes, gripped);
  const Eigen::Vector3d inwards = (nodes.rowwise().mean() - grip).normalized();
  const Eigen::RowVectorXd along = inwards.transpose() * (nodes.colwise() - grip);
  const Eigen::RowVectorXd share = 1 - (along / along.maxCoeff()).array().max(0).min(1);
  return nodes + distance * inwards * share;
}

// The study, whose regions that are held list their nodes, so that they hold the same ones of a
// mesh that was moved.
PredictionStudy WithListedNodes(const CalibrationProblem& problem) {
  PredictionStudy study = problem.WithEstimatedNoise();
  for (size_t r = 0; r < study.recordings.size(); ++r) {
    RecordedObject& object = study.recordings[r].recording.object;
    std::vector<Region*> regions;  // in the order of the model's grips
    for (RecordedSupport& support : object.fixed) regions.push_back(&support.region);
    for (RecordedGrip& grip : object.grips) regions.push_back(&grip.region);
    const auto& grips = problem.models()[r].model().grips;
    for (size_t k = 0; k < std::min(regions.size(), grips.size()); ++k)
      regions[k]->shape = NodeRegion{{grips[k].nodes.begin(), grips[k].nodes.end()}, {}};
  }
  return study;
}

// The residual of the model with this mesh, m. Empty where it cannot be simulated.
Eigen::VectorXd ResidualOn(const TetMesh& mesh, const Eigen::VectorXd& values,
                           const PredictionStudy& study, const NuisanceContext& at) {
  try {
    return CalibrationProblem(study, mesh)
        .Linearise(values, false, {}, nullptr, &at.misfit)
        .residual;
  } catch (const InputError&) {
    return {};  // for example, the region of a load holds no node
  }
}

// The column of one grip: the change per metre by which it reaches further, with the parameters
// that keep the motion in phase. First a tangent; then, since the column should hold at the extent
// that the recordings suggest, the chord to there.
Eigen::VectorXd ColumnOf(const Eigen::VectorXi& gripped, const PredictionStudy& study,
                         const NuisanceContext& at) {
  const double deviation = kThresholds.nuisances.shift;
  const Eigen::VectorXd& residual = at.misfit.residual;
  // The change by a grip that reaches further by `distance`.
  const auto change_by = [&](double distance, const Eigen::VectorXd& values) -> Eigen::VectorXd {
    TetMesh mesh = at.problem.body()->mesh;
    mesh.nodes = WithLongerGrip(mesh.nodes, gripped, distance);
    const Eigen::VectorXd there = ResidualOn(mesh, values, study, at);
    return there.size() == residual.size() ? there - residual : Eigen::VectorXd();
  };
  const Eigen::VectorXd tangent = change_by(kProbe * deviation, at.values);
  if (tangent.size() == 0) return {};
  const InPhase kept = KeptInPhase(tangent / kProbe, at.problem, at.values, at.misfit);
  // Amounts are in units of the deviation from here on.
  Eigen::MatrixXd columns(residual.size(), at.values.size() + 1);
  columns << at.misfit.jacobian.leftCols(at.values.size()), kept.of_columns;
  std::vector<LinearPrior> priors = PriorsAbout(at.problem.parameters(), at.values);
  priors.push_back({0, 1, false});
  const Eigen::VectorXd fitted =
      LinearGaussianModel(WhitenedRows(residual, at.misfit, 0, false),
                          WhitenedRows(columns, at.misfit, 0, false), std::move(priors))
          .FitAll(1)
          .change;
  const double amount = std::clamp(fitted[fitted.size() - 1], -kMostAmount, kMostAmount);
  if (std::abs(amount) > kProbe) {
    const Eigen::VectorXd moved =
        MovedBy(at.problem.parameters(), at.values, amount * kept.change.col(0));
    const Eigen::VectorXd chord = change_by(amount * deviation, moved);
    if (chord.size() > 0) return chord / (amount * deviation);
  }
  return kept.of_columns / deviation;
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  const PredictionStudy study = WithListedNodes(at.problem);
  const auto& grips = at.problem.models().front().model().grips;
  NuisanceCandidate candidate;
  candidate.columns.resize(at.misfit.residual.size(), 0);
  for (const GripMotions::Grip& grip : at.grips.grips) {
    const Eigen::VectorXi& gripped = grips[grip.grip].nodes;
    if (IsCentral(at.problem.body()->mesh.nodes, gripped)) continue;
    const Eigen::VectorXd column = ColumnOf(gripped, study, at);
    if (column.size() == 0) continue;
    candidate.columns.conservativeResize(Eigen::NoChange, candidate.columns.cols() + 1);
    candidate.columns.rightCols(1) = column;
    candidate.priors.push_back({0, kThresholds.nuisances.shift, false});
  }
  if (candidate.priors.empty()) return std::nullopt;
  return candidate;
}

}  // namespace

NuisanceEntry GripExtentNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
