#include "comparison/unexplained_force.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/amplitude_estimate.h"
#include "analysis/measurement_errors.h"
#include "calibration/calibration_problem.h"

namespace lacuna {
namespace {

constexpr double kPlausible = 9.80665;  // m/s², of an amplitude
constexpr int kShapes = SmoothForce::kShapes;
constexpr int kFewestFrames = 6;  // in motion
// Gauss–Newton ends when the error along the new motion is what it said, to this share of what it
// said or of the noise. A step that lessens nothing is halved.
constexpr double kAgreement = 0.1;
constexpr double kOfNoise = 0.5;
constexpr double kShortestStep = 0.2;
constexpr double kWorthwhile = 0.5;  // of the error: where steps that have not settled leave more
constexpr int kMostPredictions = 8;
// Of the residual's derivative: where a recording has more, frames are left out evenly.
constexpr double kMostEntries = 25e6;
// Priors to choose from: how much the force varies over the object, relative to its mean, and over
// how many knots it stays alike.
constexpr double kVariations[] = {0.1, 1};
constexpr double kPersistences[] = {0.7, 12};

// L with L Lᵀ = exp(−|i − j| / persistence) between knots times each mode's own variance.
std::vector<Eigen::MatrixXd> PriorShapes(int knots) {
  std::vector<Eigen::MatrixXd> shapes;
  for (const double persistence : kPersistences) {
    Eigen::MatrixXd correlation(knots, knots);
    for (int i = 0; i < knots; ++i)
      for (int j = 0; j < knots; ++j) correlation(i, j) = std::exp(-std::abs(i - j) / persistence);
    const Eigen::MatrixXd in_time = correlation.llt().matrixL();
    for (const double variation : kVariations) {
      Eigen::MatrixXd shape = Eigen::MatrixXd::Zero(kShapes * knots, kShapes * knots);
      for (int i = 0; i < knots; ++i)
        for (int j = 0; j <= i; ++j)
          for (int k = 0; k < kShapes; ++k)
            shape(kShapes * i + k, kShapes * j + k) = in_time(i, j) * (k < 3 ? 1 : variation);
      shapes.push_back(std::move(shape));
    }
  }
  return shapes;
}

// Whitened rows of the chosen frames, with derivatives by amplitudes (knots outermost) and
// nuisances.
struct Linearised {
  int coordinates = 0;  // that were measured
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_force, by_nuisance;
  double Rms(const Eigen::VectorXd& of) const { return std::sqrt(of.squaredNorm() / coordinates); }
};

class Problem {
 public:
  // Errors of the markers' places show as along `motion`.
  Problem(const RecordingModel& recording, const ReplayedMotion& motion, const SmoothForce& field,
          double noise, double place_deviation)
      : recording_(recording), field_(field), noise_(noise), place_deviation_(place_deviation) {
    shapes_ = field.Shapes();
    prior_.resize(static_cast<Eigen::Index>(recording.nuisances().size()));
    for (const auto& nuisance : recording.nuisances()) {
      prior_[static_cast<Eigen::Index>(held_shape_.size())] = nuisance.prior.prior_deviation;
      const bool holds = nuisance.direction.of == MisfitDirection::Of::kModel;
      held_shape_.push_back(holds ? shapes_.cols() : -1);
      if (!holds) continue;
      shapes_.conservativeResize(Eigen::NoChange, shapes_.cols() + 1);
      shapes_.rightCols(1) = nuisance.direction.perturbation.held_force;
    }
    const int markers = recording.PointCount();
    const int most =
        std::max(2 * field.KnotCount(),
                 static_cast<int>(kMostEntries / (3.0 * markers * kShapes * field.KnotCount())));
    const int frames = static_cast<int>(recording.item().frames.size());
    const int stride = (frames + most - 1) / most;
    for (int frame = 0; frame < frames; frame += stride) {
      chosen_.push_back(frame);
      const auto at_markers = motion.deformation.begin() + frame * markers;
      deformation_.insert(deformation_.end(), at_markers, at_markers + markers);
    }
  }

  const Eigen::VectorXd& prior() const { return prior_; }

  ReducedResponse Response(const ReplayedMotion& motion) const {
    const PredictionOptions options = recording_.Options(motion.nuisance);
    return ReducedResponse(recording_.model(), motion.states, shapes_,
                           {.scheme = options.step.scheme, .time_step = options.time_step});
  }

  // The whitened residual of a motion, of every chosen frame.
  Eigen::VectorXd Residual(const ReplayedMotion& motion) const {
    Eigen::VectorXd residual = Eigen::VectorXd::Zero(Rows());
    ForEachSeen([&](int frame, int m, Eigen::Index row) {
      residual.segment<3>(row) =
          motion.predicted.col(frame).segment<3>(3 * m) - Measured(frame).col(m);
    });
    return Whiten(residual);
  }

  Linearised Linearise(const ReplayedMotion& motion, const ReducedResponse& response) const {
    const Eigen::Index forces = field_.amplitudes.size(), nuisances = prior_.size();
    std::vector<double> times;
    for (const int frame : chosen_)
      times.push_back(recording_.item().recording.times[recording_.item().frames[frame]] -
                      motion.delay);
    const ForceHistories hats = [&](double time) {
      Eigen::MatrixXd amplitude = Eigen::MatrixXd::Zero(shapes_.cols(), forces + nuisances);
      const SmoothForce::Between at = field_.At(time);
      for (int j = 0; j < kShapes; ++j) {
        amplitude(j, kShapes * at.knot + j) = 1 - at.next;
        amplitude(j, kShapes * (at.knot + 1) + j) = at.next;
      }
      return amplitude;
    };
    Eigen::MatrixXd held = hats(field_.start);
    for (Eigen::Index k = 0; k < nuisances; ++k)
      if (held_shape_[k] >= 0) held(held_shape_[k], forces + k) = 1;
    std::vector<Eigen::MatrixXd> moved;
    const Eigen::MatrixXd at_markers = recording_.Markers()->rows() * response.basis();
    response.Respond(held, hats, times, [&](int, const Eigen::MatrixXd& q, const Eigen::MatrixXd&) {
      moved.emplace_back(at_markers * q);
    });
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(Rows(), forces + nuisances);
    Linearised rows;
    ForEachSeen([&](int frame, int m, Eigen::Index row) {
      const Eigen::Index index = row / (3 * recording_.PointCount());
      rows.coordinates += 3;
      by.middleRows<3>(row) = motion.registration.linear() * moved[index].middleRows<3>(3 * m);
      for (Eigen::Index k = 0; k < nuisances; ++k) {
        const MisfitDirection& direction = recording_.nuisances()[static_cast<size_t>(k)].direction;
        auto column = by.col(forces + k).segment<3>(row);
        if (direction.of == MisfitDirection::Of::kModel) continue;
        if (direction.of != MisfitDirection::Of::kClock)
          column = recording_.ByRegistration(direction, motion.registration,
                                             motion.predicted.col(frame).segment<3>(3 * m));
        else if (times[index] > field_.start)
          column = -motion.velocity.col(frame).segment<3>(3 * m);
      }
    });
    by = Whiten(by);
    rows.residual = Residual(motion);
    rows.by_force = by.leftCols(forces);
    rows.by_nuisance = by.rightCols(nuisances);
    return rows;
  }

 private:
  Eigen::Index Rows() const {
    return 3 * recording_.PointCount() * static_cast<Eigen::Index>(chosen_.size());
  }
  const Eigen::Matrix3Xd& Measured(int frame) const {
    return recording_.item().recording.markers.positions[recording_.item().frames[frame]];
  }
  template <typename Visit>
  void ForEachSeen(const Visit& visit) const {
    Eigen::Index row = 0;
    for (const int frame : chosen_)
      for (int m = 0; m < recording_.PointCount(); ++m, row += 3)
        if (Measured(frame).col(m).allFinite()) visit(frame, m, row);
  }
  Eigen::MatrixXd Whiten(const Eigen::MatrixXd& rows) const {
    std::vector<int> observed;
    for (const int frame : chosen_)
      for (int m = 0; m < recording_.PointCount(); ++m)
        observed.push_back(Measured(frame).col(m).allFinite());
    return Whitened(rows, observed, recording_.PointCount(),
                    MeasurementErrors{noise_, place_deviation_}, deformation_);
  }

  const RecordingModel& recording_;
  const SmoothForce& field_;
  double noise_, place_deviation_;
  Eigen::MatrixXd shapes_;                // of the field, then of what holds
  Eigen::VectorXd prior_;                 // deviations of the nuisances
  std::vector<Eigen::Index> held_shape_;  // of each nuisance; −1: no force
  std::vector<int> chosen_;
  std::vector<Eigen::Matrix3d> deformation_;  // markers × chosen frames
};

UnexplainedForce Failed(UnexplainedForce force, const std::string& why) {
  force.message = why;
  return force;
}

}  // namespace

UnexplainedForce EstimateUnexplainedForce(const RecordingModel& recording,
                                          const ReplayedMotion& motion, double noise,
                                          double place_deviation) {
  UnexplainedForce force;
  const double start = motion.states.front().time, end = motion.states.back().time;
  const std::vector<double>& times = recording.item().recording.times;
  const int moving = static_cast<int>(
      std::count_if(recording.item().frames.begin(), recording.item().frames.end(),
                    [&](int frame) { return times[frame] - motion.delay > start; }));
  const int knots = std::min(kMostForceKnots, moving);
  if (moving < kFewestFrames) return Failed(force, "there are too few frames in motion");
  force.field = MakeSmoothForce(recording.model(), start, end, knots);
  const Problem problem(recording, motion, force.field, noise, place_deviation);
  std::vector<Eigen::MatrixXd> priors = PriorShapes(knots);

  ReplayedMotion current = motion;
  Eigen::VectorXd amplitudes = Eigen::VectorXd::Zero(force.field.amplitudes.size());
  std::optional<AmplitudeEstimate> accepted;
  bool stuck = false;
  for (int pass = 0; !force.converged && !stuck && force.predictions < kMostPredictions; ++pass) {
    const ReducedResponse response = problem.Response(current);
    if (!response.IsUsable()) return Failed(force, response.message());
    const Linearised at = problem.Linearise(current, response);
    const double here = at.Rms(at.residual);
    if (pass == 0) force.in_noise_before = here;
    // As it would be without force and nuisances, whose priors are about 0.
    const Eigen::VectorXd without =
        at.residual - at.by_force * amplitudes - at.by_nuisance * current.nuisance;
    AmplitudeEstimate estimate =
        EstimateAmplitudes(FittedModel(without, at.by_nuisance, problem.prior()), at.by_force,
                           at.coordinates, kPlausible, priors);
    // The first pass may be far from the end; from the second on the prior's shape stays.
    if (pass == 1) priors = {priors[estimate.shape]};
    const Eigen::VectorXd with = without + at.by_force * estimate.mean;
    Eigen::MatrixXd information = at.by_nuisance.transpose() * at.by_nuisance;
    information.diagonal() += problem.prior().cwiseAbs2().cwiseInverse();
    const Eigen::VectorXd nuisance = -information.ldlt().solve(at.by_nuisance.transpose() * with);
    const double expected = at.Rms(with + at.by_nuisance * nuisance);

    stuck = true;
    for (double share = 1; share >= kShortestStep && force.predictions < kMostPredictions;
         share /= 2) {
      const Eigen::VectorXd there = amplitudes + share * (estimate.mean - amplitudes);
      force.field.amplitudes.reshaped() = there;
      ReplayedMotion trial =
          Replay(recording, current.nuisance + share * (nuisance - current.nuisance),
                 force.field.Effects());
      ++force.predictions;
      if (!trial.summary.IsUsable()) continue;
      const double reached = at.Rms(problem.Residual(trial));
      force.converged =
          share == 1 && std::abs(reached - expected) < std::max(kAgreement * expected, kOfNoise);
      if (!force.converged && reached >= here) continue;
      amplitudes = there;
      current = std::move(trial);
      accepted = std::move(estimate);
      force.in_noise_after = reached;
      stuck = false;
      break;
    }
  }
  const bool helps = force.in_noise_after < kWorthwhile * force.in_noise_before;
  if (!accepted || (!force.converged && !helps))
    return Failed(force, force.in_noise_before > kFarOff
                             ? "no small force makes the model follow better: it is too far off"
                             : "no small, smooth force makes the model follow better");
  force.field.amplitudes.reshaped() = amplitudes;
  force.noise = accepted->noise;
  force.evidence = accepted->evidence;
  MeasureForce(recording.model(), current, accepted->covariance, &force);
  force.usable = true;
  return force;
}

}  // namespace lacuna
