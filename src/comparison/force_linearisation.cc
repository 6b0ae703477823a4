#include "comparison/force_linearisation.h"

#include <algorithm>
#include <cmath>

#include "prediction/observed_response.h"

namespace lacuna {
namespace {

// Largest number of entries of the force's Jacobian. Larger: finer resolution in time for long
// recordings, more memory.
constexpr double kMostEntries = 25e6;

int FrameStride(int frames, Eigen::Index rows_of_frame, int knots) {
  const int most =
      std::max(2 * knots, static_cast<int>(kMostEntries / (static_cast<double>(rows_of_frame) *
                                                           SmoothForce::kShapes * knots)));
  return (frames + most - 1) / most;
}

}  // namespace

double LinearisedForce::Rms(const Eigen::VectorXd& rows) const {
  return std::sqrt(rows.squaredNorm() / coordinates);
}

ForceLinearisation::ForceLinearisation(const RecordingModel& recording,
                                       const ReplayedMotion& motion, const SmoothForce& field,
                                       const MeasurementErrors& errors)
    : recording_(recording),
      field_(field),
      errors_(errors),
      components_(recording.observer().Components()),
      shapes_(field.Shapes()) {
  prior_deviations_.resize(static_cast<Eigen::Index>(recording.nuisances().size()));
  for (const auto& nuisance : recording.nuisances()) {
    prior_deviations_[static_cast<Eigen::Index>(held_shape_.size())] =
        nuisance.prior.prior_deviation;
    const bool is_force = nuisance.direction.kind == MisfitDirection::Kind::kModel;
    held_shape_.push_back(is_force ? shapes_.cols() : -1);
    if (!is_force) continue;
    shapes_.conservativeResize(Eigen::NoChange, shapes_.cols() + 1);
    shapes_.rightCols(1) = nuisance.direction.perturbation.held_force;
  }
  const int points = recording.PointCount();
  const int frames = static_cast<int>(recording.recording().frames.size());
  const int stride = FrameStride(frames, RowsOfFrame(), field.KnotCount());
  for (int frame = 0; frame < frames; frame += stride) {
    frames_.push_back(frame);
    if (motion.misfit.deformation.empty()) continue;
    const auto at_markers = motion.misfit.deformation.begin() + frame * points;
    deformation_.insert(deformation_.end(), at_markers, at_markers + points);
  }
}

int ForceLinearisation::Coordinates(const ReplayedMotion& motion) const {
  const std::vector<double> counts = Counts(motion);
  return static_cast<int>(components_) *
         static_cast<int>(
             std::count_if(counts.begin(), counts.end(), [](double n) { return n > 0; }));
}

std::vector<double> ForceLinearisation::Counts(const ReplayedMotion& motion) const {
  std::vector<double> counts;
  for (const int frame : frames_) {
    const auto first = motion.misfit.count.begin() + frame * recording_.PointCount();
    counts.insert(counts.end(), first, first + recording_.PointCount());
  }
  return counts;
}

Eigen::MatrixXd ForceLinearisation::OfUsedFrames(const Eigen::MatrixXd& all) const {
  Eigen::MatrixXd used(Rows(), all.cols());
  for (size_t k = 0; k < frames_.size(); ++k)
    used.middleRows(RowsOfFrame() * static_cast<Eigen::Index>(k), RowsOfFrame()) =
        all.middleRows(RowsOfFrame() * frames_[k], RowsOfFrame());
  return used;
}

Eigen::MatrixXd ForceLinearisation::Whiten(const Eigen::MatrixXd& rows,
                                           const ReplayedMotion& motion) const {
  return Whitened(rows, Counts(motion), recording_.PointCount(), errors_, deformation_);
}

ReducedResponse ForceLinearisation::Response(const ReplayedMotion& motion) const {
  const PredictionOptions options = recording_.Options(motion.nuisance);
  return ReducedResponse(recording_.model(), motion.states, shapes_,
                         {.scheme = options.step.scheme, .time_step = options.time_step});
}

Eigen::VectorXd ForceLinearisation::WhitenedResidual(const ReplayedMotion& motion) const {
  return Whiten(OfUsedFrames(motion.misfit.residual), motion);
}

double ForceLinearisation::Rms(const ReplayedMotion& motion) const {
  return std::sqrt(WhitenedResidual(motion).squaredNorm() / Coordinates(motion));
}

Eigen::MatrixXd ForceLinearisation::ForceRows(const ReplayedMotion& motion,
                                              const ReducedResponse& response) const {
  const Eigen::Index forces = field_.amplitudes.size(), nuisances = prior_deviations_.size();
  const ForceHistories hat_functions = [&](double time) {
    Eigen::MatrixXd amplitude = Eigen::MatrixXd::Zero(shapes_.cols(), forces + nuisances);
    amplitude.topLeftCorner(SmoothForce::kShapes, forces) = field_.HatFunctions(time);
    return amplitude;
  };
  Eigen::MatrixXd held = hat_functions(field_.start);
  for (Eigen::Index k = 0; k < nuisances; ++k)
    if (held_shape_[k] >= 0) held(held_shape_[k], forces + k) = 1;
  return ObservedResponse(recording_, motion, response, held, hat_functions, frames_,
                          motion.misfit.observed);
}

LinearisedForce ForceLinearisation::Linearise(const ReplayedMotion& motion,
                                              const ReducedResponse& response) const {
  const Eigen::Index forces = field_.amplitudes.size(), nuisances = prior_deviations_.size();
  LinearisedForce result;
  for (size_t k = 0; k < held_shape_.size(); ++k) {
    const MisfitDirection& direction = recording_.nuisances()[k].direction;
    result.is_kept.push_back(
        held_shape_[k] < 0 &&
        (direction.IsSimulated() || direction.kind == MisfitDirection::Kind::kCellDelay));
  }
  result.coordinates = Coordinates(motion);
  Eigen::MatrixXd jacobian = ForceRows(motion, response);
  // The misfit has 0 for the holding forces, and for the nuisances that are kept.
  jacobian.rightCols(nuisances) += OfUsedFrames(motion.misfit.jacobian);
  jacobian = Whiten(jacobian, motion);
  result.residual = WhitenedResidual(motion);
  result.force_jacobian = jacobian.leftCols(forces);
  result.nuisance_jacobian = jacobian.rightCols(nuisances);
  return result;
}

}  // namespace lacuna
