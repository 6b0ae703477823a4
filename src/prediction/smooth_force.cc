#include "prediction/smooth_force.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

// A force of zero with `knots` (≥ 2) knots from `start` to `end` (s, later than the start).
SmoothForce ZeroForce(const Model& model, double start, double end, int knots) {
  CHECK_GE(knots, 2);
  CHECK_GT(end, start);
  const Body& body = *model.body;
  SmoothForce force;
  force.node_mass = body.node_mass;
  force.density = body.density;
  force.start = start;
  force.spacing = (end - start) / (knots - 1);
  force.amplitudes.setZero(SmoothForce::kShapes, knots);

  const std::vector<char> gripped = GrippedNodes(model);
  Eigen::VectorXd mass = body.node_mass;
  for (Eigen::Index i = 0; i < mass.size(); ++i)
    if (gripped[i]) mass[i] = 0;
  const Eigen::Vector3d centre = body.mesh.nodes * mass / mass.sum();
  const Eigen::Matrix3Xd arm = body.mesh.nodes.colwise() - centre;
  const Eigen::Matrix3d moments = arm * mass.asDiagonal() * arm.transpose() / mass.sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(moments);
  force.modes.setZero(mass.size(), SmoothForce::kModes);
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    if (gripped[i]) continue;
    force.modes(i, 0) = 1;
    // Eigenvalues are in ascending order.
    force.modes(i, 1) =
        principal.eigenvectors().col(2).dot(arm.col(i)) / std::sqrt(principal.eigenvalues()[2]);
  }
  return force;
}

}  // namespace

SmoothForce::KnotWeight SmoothForce::At(double time) const {
  const double at = std::clamp((time - start) / spacing, 0.0, KnotCount() - 1.0);
  const int knot = std::min(static_cast<int>(at), KnotCount() - 2);
  return {knot, at - knot};
}

Eigen::VectorXd SmoothForce::AmplitudesAt(double time) const {
  const KnotWeight at = At(time);
  return (1 - at.next) * amplitudes.col(at.knot) + at.next * amplitudes.col(at.knot + 1);
}

Eigen::MatrixXd SmoothForce::HatFunctions(double time) const {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(kShapes, amplitudes.size());
  const KnotWeight at = At(time);
  for (int j = 0; j < kShapes; ++j) {
    weights(j, kShapes * at.knot + j) = 1 - at.next;
    weights(j, kShapes * (at.knot + 1) + j) = at.next;
  }
  return weights;
}

Eigen::Matrix3Xd SmoothForce::DensityAt(double time) const {
  return density * AmplitudesAt(time).reshaped(3, kModes) * modes.transpose();
}

Eigen::MatrixXd SmoothForce::Shapes() const {
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * modes.rows(), kShapes);
  for (Eigen::Index i = 0; i < modes.rows(); ++i)
    for (int c = 0; c < kModes; ++c)
      for (int axis = 0; axis < 3; ++axis)
        shapes(3 * i + axis, 3 * c + axis) = node_mass[i] * modes(i, c);
  return shapes;
}

EffectList SmoothForce::Effects() const {
  EffectList effects;
  for (int c = 0; c < kModes; ++c)
    effects.push_back(std::make_shared<PrescribedForce>(
        node_mass.cwiseProduct(modes.col(c)), [force = *this, c](double time) -> Eigen::Vector3d {
          return force.AmplitudesAt(time).segment<3>(3 * c);
        }));
  return effects;
}

std::optional<SmoothForce> SmoothForceDuring(const RecordingModel& recording,
                                             const ReplayedMotion& motion, int most_knots) {
  constexpr int kFewestFrames = 6;
  const double start = motion.states.front().time, end = motion.states.back().time;
  const PredictedRecording& item = recording.recording();
  const int moving =
      static_cast<int>(std::count_if(item.frames.begin(), item.frames.end(), [&](int frame) {
        return item.recording.times[frame] - motion.delay > start;
      }));
  if (moving < kFewestFrames) return std::nullopt;
  return ZeroForce(recording.model(), start, end, std::min(most_knots, moving));
}

Eigen::MatrixXd PersistentPriorRoot(int knots, double persistence, double deviation_of_mode) {
  constexpr int kShapes = SmoothForce::kShapes;
  Eigen::MatrixXd correlation(knots, knots);
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j < knots; ++j) correlation(i, j) = std::exp(-std::abs(i - j) / persistence);
  const Eigen::MatrixXd in_time = correlation.llt().matrixL();
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(kShapes * knots, kShapes * knots);
  for (int i = 0; i < knots; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k < kShapes; ++k)
        root(kShapes * i + k, kShapes * j + k) = in_time(i, j) * (k < 3 ? 1 : deviation_of_mode);
  return root;
}

}  // namespace lacuna
