#include "comparison/force_linearisation.h"

#include <algorithm>
#include <cmath>

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

// Vectors of the nodes, stacked in the columns, in turned coordinates.
Eigen::MatrixXd TurnedColumns(const Eigen::Matrix3d& turn, const Eigen::MatrixXd& stacked) {
  const Eigen::Matrix3Xd turned = turn * stacked.reshaped(3, stacked.size() / 3);
  return turned.reshaped(stacked.rows(), stacked.cols());
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
    if (motion.deformation.empty()) continue;
    const auto at_markers = motion.deformation.begin() + frame * points;
    deformation_.insert(deformation_.end(), at_markers, at_markers + points);
  }
}

const Eigen::Matrix3Xd& ForceLinearisation::Measured(int frame) const {
  return recording_.recording().recording.markers.positions[recording_.recording().frames[frame]];
}

bool ForceLinearisation::IsObserved(const ReplayedMotion& motion, int frame, int point) const {
  if (recording_.recording().ShowsScans())
    return motion.misfit.count[static_cast<size_t>(frame * recording_.PointCount() + point)] > 0;
  return Measured(frame).col(point).allFinite();
}

template <typename Visit>
void ForceLinearisation::ForEachObserved(const ReplayedMotion& motion, const Visit& visit) const {
  Eigen::Index row = 0;
  for (const int frame : frames_)
    for (int m = 0; m < recording_.PointCount(); ++m, row += components_)
      if (IsObserved(motion, frame, m)) visit(frame, m, row);
}

int ForceLinearisation::Coordinates(const ReplayedMotion& motion) const {
  int coordinates = 0;
  ForEachObserved(motion, [&](int, int, Eigen::Index) { coordinates += components_; });
  return coordinates;
}

Eigen::MatrixXd ForceLinearisation::Whiten(const Eigen::MatrixXd& rows,
                                           const ReplayedMotion& motion) const {
  const PredictedRecording& item = recording_.recording();
  const std::vector<Eigen::VectorXd>& weights = item.recording.markers.weights;
  const auto count_of = [&](int frame, int point) {
    if (item.ShowsScans())
      return motion.misfit.count[static_cast<size_t>(frame * recording_.PointCount() + point)];
    return weights.empty() ? 1 : weights[item.frames[frame]][point];
  };
  std::vector<double> counts;
  for (const int frame : frames_)
    for (int m = 0; m < recording_.PointCount(); ++m)
      counts.push_back(IsObserved(motion, frame, m) ? count_of(frame, m) : 0);
  return Whitened(rows, counts, recording_.PointCount(), errors_, deformation_);
}

ReducedResponse ForceLinearisation::Response(const ReplayedMotion& motion) const {
  const PredictionOptions options = recording_.Options(motion.nuisance);
  return ReducedResponse(recording_.model(), motion.states, shapes_,
                         {.scheme = options.step.scheme, .time_step = options.time_step});
}

Eigen::VectorXd ForceLinearisation::WhitenedResidual(const ReplayedMotion& motion) const {
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(Rows());
  ForEachObserved(motion, [&](int frame, int m, Eigen::Index row) {
    if (recording_.recording().ShowsScans())
      residual[row] = motion.misfit.residual[RowsOfFrame() * frame + m];
    else
      residual.segment<3>(row) =
          motion.predicted.col(frame).segment<3>(3 * m) - Measured(frame).col(m);
  });
  return Whiten(residual, motion);
}

double ForceLinearisation::Rms(const ReplayedMotion& motion) const {
  return std::sqrt(WhitenedResidual(motion).squaredNorm() / Coordinates(motion));
}

std::vector<Eigen::MatrixXd> ForceLinearisation::PointResponses(
    const ReplayedMotion& motion, const ReducedResponse& response,
    const std::vector<double>& times) const {
  const Eigen::Index forces = field_.amplitudes.size(), nuisances = prior_deviations_.size();
  const ForceHistories hat_functions = [&](double time) {
    Eigen::MatrixXd amplitude = Eigen::MatrixXd::Zero(shapes_.cols(), forces + nuisances);
    amplitude.topLeftCorner(SmoothForce::kShapes, forces) = field_.HatFunctions(time);
    return amplitude;
  };
  Eigen::MatrixXd held = hat_functions(field_.start);
  for (Eigen::Index k = 0; k < nuisances; ++k)
    if (held_shape_[k] >= 0) held(held_shape_[k], forces + k) = 1;
  // The rows of markers are the same in all frames, those of patches follow the surface.
  const bool shows_scans = recording_.recording().ShowsScans();
  Eigen::MatrixXd at_markers, turned_basis;
  if (shows_scans)
    turned_basis = TurnedColumns(motion.registration.linear(), response.basis());
  else
    at_markers = recording_.Markers()->rows() * response.basis();
  std::vector<Eigen::MatrixXd> responses;
  response.Respond(held, hat_functions, times,
                   [&](int index, const Eigen::MatrixXd& position, const Eigen::MatrixXd&) {
                     if (!shows_scans) {
                       responses.emplace_back(at_markers * position);
                       return;
                     }
                     const Observed& seen =
                         motion.misfit.observed[static_cast<size_t>(frames_[index])];
                     responses.emplace_back((*seen.rows * turned_basis) * position);
                   });
  return responses;
}

LinearisedForce ForceLinearisation::Linearise(const ReplayedMotion& motion,
                                              const ReducedResponse& response) const {
  const Eigen::Index forces = field_.amplitudes.size(), nuisances = prior_deviations_.size();
  std::vector<double> times;
  for (const int frame : frames_)
    times.push_back(recording_.recording().recording.times[recording_.recording().frames[frame]] -
                    motion.delay);
  const std::vector<Eigen::MatrixXd> responses = PointResponses(motion, response, times);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(Rows(), forces + nuisances);
  LinearisedForce result;
  for (Eigen::Index k = 0; k < nuisances; ++k) {
    const MisfitDirection& direction = recording_.nuisances()[static_cast<size_t>(k)].direction;
    result.is_kept.push_back(
        held_shape_[static_cast<size_t>(k)] < 0 &&
        (direction.IsSimulated() || direction.kind == MisfitDirection::Kind::kCellDelay));
  }
  result.coordinates = Coordinates(motion);
  ForEachObserved(motion, [&](int frame, int m, Eigen::Index row) {
    const Eigen::Index index = row / RowsOfFrame();
    if (recording_.recording().ShowsScans()) {
      jacobian.row(row) = responses[index].row(m);
      // 0 for the holding forces and for the nuisances that are kept.
      jacobian.row(row).tail(nuisances) += motion.misfit.jacobian.row(RowsOfFrame() * frame + m);
      return;
    }
    jacobian.middleRows<3>(row) =
        motion.registration.linear() * responses[index].middleRows<3>(3 * m);
    for (Eigen::Index k = 0; k < nuisances; ++k) {
      const MisfitDirection& direction = recording_.nuisances()[static_cast<size_t>(k)].direction;
      auto column = jacobian.col(forces + k).segment<3>(row);
      // The columns of the hold are filled above.
      if (direction.IsSimulated() || result.is_kept[static_cast<size_t>(k)]) continue;
      if (direction.kind != MisfitDirection::Kind::kClock)
        column = recording_.ByRegistration(direction, motion.registration,
                                           motion.predicted.col(frame).segment<3>(3 * m));
      else if (times[index] > field_.start)
        column = -motion.velocity.col(frame).segment<3>(3 * m);
    }
  });
  jacobian = Whiten(jacobian, motion);
  result.residual = WhitenedResidual(motion);
  result.force_jacobian = jacobian.leftCols(forces);
  result.nuisance_jacobian = jacobian.rightCols(nuisances);
  return result;
}

}  // namespace lacuna
