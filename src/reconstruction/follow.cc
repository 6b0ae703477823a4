#include "reconstruction/follow.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/memory_limit.h"
#include "experiment/grip_tracks.h"
#include "experiment/known_loads.h"
#include "fit/step_force_fitter.h"
#include "geometry/nearest.h"
#include "geometry/rigid_fit.h"
#include "geometry/surface_tracks.h"
#include "reconstruction/followed_sensitivity.h"
#include "reconstruction/force_model_choice.h"
#include "reconstruction/point_noise.h"
#include "reconstruction/recorded_states.h"
#include "registration/surface_alignment.h"

namespace lacuna {
namespace {

Eigen::Matrix3Xd AsPoints(const Eigen::VectorXd& stacked) {
  return Eigen::Map<const Eigen::Matrix3Xd>(stacked.data(), 3, stacked.size() / 3);
}

Eigen::VectorXd Stacked(const Eigen::Matrix3Xd& points) {
  return Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
}

// The places of points of the body in a recorded state, found by CPD. Where it failed, they are NaN
// and their deviation is infinite.
struct Correspondence {
  Eigen::Matrix3Xd target;  // 3 × n, m
  Eigen::VectorXd sigma;    // m, of each target, tangential to the surface
};

class Follower {
 public:
  Follower(const ReconstructionStudy& study, const ReferenceBody& reference,
           const std::vector<FrameState>& states, const TrackedFrames* tracked,
           const std::vector<int>& moduli, FollowedMotion* motion)
      : study_(study),
        states_(states),
        tracked_(tracked),
        are_identified_(HasIdentifiedPoints(study, states)),
        motion_(*motion) {
    SetNoise();
    model_ = {motion_.body, study.effects, {}};
    grips_ = std::make_unique<GripTracks>(study.recording, reference.mesh, &model_);
    forces_ = MakeForceModel(study, model_);
    if (study.follow.forces.kind == ForceSettings::Kind::kKnown)
      known_forces_ = MakeKnownForces(study.recording, model_);
    model_.effects.insert(model_.effects.end(), known_forces_.begin(), known_forces_.end());
    history_ = RestHistory(model_);
    if (const FrameState& front = states.front(); front.tracked.cols() > 0)
      tracks_ = TrackOnSurface(motion_.body->boundary,
                               are_identified_ ? front.tracked : front.cloud.points);
    StepOptions options;
    options.scheme = study.follow.scheme;
    options.refuse_inverted = !study.follow.allow_inverted;
    stepper_ = std::make_unique<Stepper>(model_, options);
    if (!moduli.empty()) sensitivity_ = std::make_unique<FollowedSensitivity>(model_, moduli);
    previous_velocity_ = Eigen::Matrix3Xd::Zero(3, motion_.body->NodeCount());
  }

  // Adds the reference frame, in which the body is undeformed.
  void RecordRest() {
    FollowedFrame frame;
    frame.time = states_.front().time;
    history_.time = frame.time;
    frame.position = motion_.body->mesh.nodes;
    frame.force = Eigen::Matrix3Xd::Zero(3, motion_.body->NodeCount());
    frame.pseudo_force = frame.force;
    frame.solver = {true, "reference", "", 0};
    MeasureResidual(states_.front(), &frame);
    motion_.frames.push_back(std::move(frame));
    grips_->Begin(history_.time);
  }

  // Returns false when the frame could not be followed; its record says why.
  bool Follow(size_t k) {
    frame_ = k;
    const FrameState& state = states_[k];
    const Body& body = *motion_.body;
    // In quasi-static motion every frame is an equilibrium, independent of the previous frame.
    const bool is_static = study_.follow.scheme == TimeScheme::kQuasiStatic;
    const double time_step = is_static || k == 0 ? 0 : state.time - states_[k - 1].time;

    FollowedFrame frame;
    frame.time = state.time;
    const Eigen::Matrix3Xd before = AsPoints(history_.position);
    const Eigen::Matrix3Xd shift = RegisteredShift(k, before);
    frame.pseudo_force = PseudoForce(shift, time_step);
    const RecordedGrip* lost = grips_->Extend(state.time, before, before + shift, MarkersIn(k));
    if (lost != nullptr)
      throw InputError(
          fmt::format("{}: at {:g} s too few of the markers that \"{}\" follows are seen, or their "
                      "marker_places are missing",
                      study_.recording.file.string(), state.time, lost->region.name));

    Eigen::VectorXd start = Stacked(before + shift);
    grips_->Place(state.time, &start);
    MotionHistory from = history_;
    if (time_step == 0) from.time = state.time;
    const StepEquation equation(model_, from, study_.follow.scheme, time_step);

    ForceFit fit;
    int iterations = 0;
    if (forces_.HasUnknowns()) {
      const Correspondence correspondence = Register(AsPoints(start), state);
      StepForceFitter fitter(model_, equation, forces_, start, coefficients_);
      for (int round = 0; round < study_.follow.alignment_rounds; ++round) {
        ThrowIfInterrupted();
        ThrowIfOverMemoryLimit();
        const Observations seen = Observe(AsPoints(start), state, correspondence);
        frame.observations = static_cast<int>(seen.Count());
        // The prior of free forces is centred at those of the last frame, and that of coefficients
        // at 0: as a random walk, coefficients that the scans do not determine would drift.
        ForceFitOptions options = study_.follow.fit;
        // Correspondences that will be searched for again do not need an exact fit.
        const bool is_last = round + 1 == study_.follow.alignment_rounds;
        if (!is_last) options.function_tolerance = std::max(options.function_tolerance, 1e-2);
        fit = fitter.Fit(seen, {force_, {}}, options);
        iterations += fit.factorisations;
        if (!fit.IsUsable()) break;
        const Eigen::MatrixXd covariance =
            is_last ? fitter.Covariance(fit, seen, options) : Eigen::MatrixXd();
        if (covariance.size() > 0) frame.force_deviation = NetForceDeviation(forces_, covariance);
        start = fit.position;
      }
      if (!fit.IsUsable()) return Fail("forces", fit.message, iterations, &frame);
      frame.weighted_rms = fit.weighted_rms;
    } else {
      fit.force = Eigen::VectorXd::Zero(3 * body.NodeCount());
    }

    // The result of a frame is its forces. The recorded positions are those that an ordinary step
    // under these forces leads to, rather than the fitted ones.
    MotionHistory after = from;
    if (time_step == 0 && fit.IsUsable()) after.position = fit.position;
    const StepSummary step = time_step > 0 ? stepper_->Step(time_step, fit.force, &after)
                                           : stepper_->Equilibrium(fit.force, &after);
    if (!step.IsUsable()) return Fail("step", step.message, iterations, &frame);
    if (sensitivity_ != nullptr) {
      sensitivity_->Advance(from, time_step > 0 ? study_.follow.scheme : TimeScheme::kQuasiStatic,
                            time_step, after.position);
      frame.position_derivative = sensitivity_->position();
    }
    history_ = after;
    force_ = fit.force;
    coefficients_ = fit.coefficients;

    frame.position = AsPoints(history_.position);
    // Without fitted forces the distance is the result.
    if (forces_.HasUnknowns() && state.tracked.cols() == 0) {
      const TriMesh surface = BoundaryAt(body.boundary, frame.position);
      const std::string problem = FarFromScan(surface, state.cloud.points);
      if (!problem.empty()) return Fail("scan", problem, iterations, &frame);
    }
    frame.force = AsPoints(fit.force + KnownForces());
    MeasureResidual(state, &frame);
    const bool is_stopped = fit.status == ForceFit::Status::kEndedEarly;
    if (is_stopped) {
      motion_.warnings.push_back(
          fmt::format("frame {}: the search for the forces ended before its minimum ({}); the "
                      "residual there is {:.3g} times the noise",
                      study_.frames[k], fit.message, fit.weighted_rms));
    }
    frame.solver = {true, is_stopped ? "ended early" : "converged", is_stopped ? fit.message : "",
                    iterations};
    motion_.frames.push_back(std::move(frame));
    return true;
  }

 private:
  bool Fail(const char* what, const std::string& message, int iterations, FollowedFrame* frame) {
    frame->solver = {false, "no convergence", fmt::format("{}: {}", what, message), iterations};
    const Eigen::Index nodes = motion_.body->NodeCount();
    const auto unknown = std::numeric_limits<double>::quiet_NaN();
    frame->position = Eigen::Matrix3Xd::Constant(3, nodes, unknown);
    frame->force = frame->position;
    const auto points = are_identified_ ? tracks_.Count() : motion_.body->boundary.node.size();
    frame->residual = Eigen::Matrix3Xd::Constant(3, points, unknown);
    motion_.frames.push_back(std::move(*frame));
    return false;
  }

  // Only a fit of forces uses the noise.
  void SetNoise() {
    if (!study_.follow.forces.AreFitted()) return;
    motion_.noise = study_.follow.noise;
    if (motion_.noise > 0) return;
    const PointNoise estimate =
        NamingWhere(study_.name, [this] { return EstimatePointNoise(states_, are_identified_); });
    motion_.noise = estimate.deviation;
    if (!estimate.warning.empty()) motion_.warnings.push_back(estimate.warning);
  }

  // All markers of the recording in state k, those that are held out included; 3 × 0 without.
  Eigen::Matrix3Xd MarkersIn(size_t k) const {
    const std::vector<Eigen::Matrix3Xd>& positions = study_.recording.markers.positions;
    if (positions.empty()) return Eigen::Matrix3Xd(3, 0);
    return positions[static_cast<size_t>(study_.frames[k])];
  }

  PointCloud SimulatedSurface(const Eigen::Matrix3Xd& nodes) const {
    const TriMesh surface = BoundaryAt(motion_.body->boundary, nodes);
    return {surface.vertices, VertexNormals(surface)};
  }

  // The motion of `nodes` from state k − 1 to state k (the paper's displacement field between
  // consecutive surfaces). The simulated surface takes the place of a state before the first.
  Eigen::Matrix3Xd RegisteredShift(size_t k, const Eigen::Matrix3Xd& nodes) {
    if (tracked_ != nullptr) {
      const Eigen::Matrix3Xd& rest = motion_.body->mesh.nodes;
      return tracked_->DisplacementAt(k, rest) - tracked_->DisplacementAt(k - 1, rest);
    }
    if (are_identified_ && SeenBeside(k) < CpdResult::kFewestPoints) return RigidShift(k, nodes);
    const PointCloud from = k > 0 ? StatePoints(states_[k - 1]) : SimulatedSurface(nodes);
    // The search starts from the last motion, because motions are continuous.
    last_motion_ = Registered(from, StatePoints(states_[k]), &last_motion_).field;
    if (last_motion_.IsEmpty()) return Eigen::Matrix3Xd::Zero(3, nodes.cols());
    return last_motion_.Evaluate(nodes);
  }

  // The number of points that are seen in state k, or in the state before it if that shows fewer.
  Eigen::Index SeenBeside(size_t k) const {
    const Eigen::Index here = states_[k].cloud.Size();
    return k > 0 ? std::min(here, states_[k - 1].cloud.Size()) : here;
  }

  // The rigid motion of identified points that are too few for CPD. In the first state they are
  // where the undeformed body has them.
  Eigen::Matrix3Xd RigidShift(size_t k, const Eigen::Matrix3Xd& nodes) const {
    if (k == 0) return Eigen::Matrix3Xd::Zero(3, nodes.cols());
    return FitRigidMotion(states_[k - 1].tracked, states_[k].tracked).motion * nodes - nodes;
  }

  Eigen::Matrix3Xd TrackedTarget() const {
    const Eigen::Matrix3Xd& rest = motion_.body->boundary.surface.vertices;
    return rest + tracked_->DisplacementAt(frame_, rest);
  }

  // Registers two clouds. A result that has not converged is used with a warning. One that failed
  // is replaced by unknown displacements (NaN) with an infinite standard deviation.
  Alignment Registered(const PointCloud& source, const PointCloud& target,
                       const DisplacementField* previous = nullptr) const {
    if (previous != nullptr && previous->IsEmpty()) previous = nullptr;
    Alignment alignment = Align(source, target, study_.registration, previous);
    if (!alignment.IsUsable()) {
      const std::string warning =
          fmt::format("frame {}: registration: {}", study_.frames[frame_], alignment.message);
      // A frame is registered several times, often with the same outcome.
      if (motion_.warnings.empty() || motion_.warnings.back() != warning)
        motion_.warnings.push_back(warning);
    }
    if (alignment.field.IsEmpty()) {
      alignment.displacement =
          Eigen::Matrix3Xd::Constant(3, source.Size(), std::numeric_limits<double>::quiet_NaN());
      alignment.standard_deviation = Eigen::VectorXd::Constant(source.Size(), kUnobserved);
    }
    return alignment;
  }

  // The pseudo-force m α of the paper, with v = d/dt and α = dv/dt.
  Eigen::Matrix3Xd PseudoForce(const Eigen::Matrix3Xd& shift, double time_step) {
    if (time_step <= 0) return Eigen::Matrix3Xd::Zero(3, shift.cols());
    const Eigen::Matrix3Xd velocity = shift / time_step;
    const Eigen::Matrix3Xd acceleration = (velocity - previous_velocity_) / time_step;
    previous_velocity_ = velocity;
    if (study_.follow.forces.unit_pseudo_mass) return acceleration;
    return acceleration * motion_.body->node_mass.asDiagonal();
  }

  // The known forces (3n, N) at the end of the step.
  Eigen::VectorXd KnownForces() const {
    Eigen::VectorXd known = Eigen::VectorXd::Zero(history_.position.size());
    const Eigen::VectorXd no_memory, at_rest = Eigen::VectorXd::Zero(known.size());
    for (const auto& force : known_forces_) {
      force->AddForce({*model_.body, history_.position, history_.velocity, at_rest, history_.time,
                       0, no_memory},
                      &known);
    }
    return known;
  }

  // The points that represent the model in a registration: the places of the tracked points that
  // the first state shows, which exclude sides that are never seen, or its whole surface.
  PointCloud RegistrationPoints(const Eigen::Matrix3Xd& nodes) const {
    if (tracks_.Count() == 0) return SimulatedSurface(nodes);
    return {PointsAt(tracks_, motion_.body->boundary, nodes), {}};
  }

  Correspondence Register(const Eigen::Matrix3Xd& nodes, const FrameState& state) const {
    if (are_identified_) return {};
    if (tracked_ != nullptr) {
      return {TrackedTarget(),
              tracked_->DeviationAt(frame_, motion_.body->boundary.surface.vertices)};
    }
    const PointCloud points = RegistrationPoints(nodes);
    const Alignment aligned = Registered(points, StatePoints(state));
    return {points.points + aligned.displacement, aligned.standard_deviation};
  }

  Observations Observe(const Eigen::Matrix3Xd& nodes, const FrameState& state,
                       const Correspondence& correspondence) const {
    const BoundarySurface& boundary = motion_.body->boundary;
    if (are_identified_) {
      return ObserveMarkers(boundary, tracks_.at_rest, state.tracked - tracks_.offset,
                            motion_.noise);
    }
    if (tracks_.Count() > 0) {
      return ObserveMarkers(boundary, tracks_.at_rest, correspondence.target - tracks_.offset,
                            motion_.noise);
    }
    const double size = BoundingBoxDiagonal(motion_.body->mesh.nodes);
    // Tangential to the surface only CPD contains information. Along its normal the scanned points
    // are more accurate where there are any, so that CPD gets a larger standard deviation there.
    const double slip =
        study_.follow.tangential_noise > 0 ? study_.follow.tangential_noise : 0.03 * size;
    const Eigen::VectorXd tangent = correspondence.sigma.cwiseMax(std::max(motion_.noise, slip));
    const Eigen::VectorXd normal = tangent.cwiseMax(5 * motion_.noise);
    const Observations registered =
        ObserveVertices(boundary, nodes, correspondence.target, normal, tangent);
    const Observations scanned =
        ObserveScan(boundary, nodes, state.cloud, motion_.noise, study_.follow.reach * size);
    return Concatenate(registered, scanned);
  }

  // Sets D of Eq. 1 for the positions of the frame, or the reason why it is not known.
  void MeasureResidual(const FrameState& state, FollowedFrame* frame) const {
    const BoundarySurface& boundary = motion_.body->boundary;
    if (are_identified_) {
      frame->residual = state.tracked - PointsAt(tracks_, boundary, frame->position);
      if (frame->residual.array().isNaN().colwise().any().all())
        frame->residual_problem = "none of the tracked points is seen";
      return;
    }
    const Eigen::Matrix3Xd vertices = BoundaryAt(boundary, frame->position).vertices;
    if (tracked_ != nullptr) {
      frame->residual = TrackedTarget() - vertices;
      frame->residual_problem = tracked_->failures[frame_];
    } else {
      const Alignment aligned = Registered(RegistrationPoints(frame->position), StatePoints(state));
      if (aligned.field.IsEmpty())
        frame->residual_problem = aligned.message;
      else
        frame->residual = aligned.field.Evaluate(vertices);
    }
    if (!frame->residual_problem.empty())
      frame->residual =
          Eigen::Matrix3Xd::Constant(3, vertices.cols(), std::numeric_limits<double>::quiet_NaN());
  }

  const ReconstructionStudy& study_;
  const std::vector<FrameState>& states_;
  const TrackedFrames* tracked_;
  const bool are_identified_;  // HasIdentifiedPoints
  FollowedMotion& motion_;
  size_t frame_ = 0;  // frame that is being followed
  Model model_;
  std::unique_ptr<GripTracks> grips_;
  ForceModel forces_;
  EffectList known_forces_;
  MotionHistory history_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<FollowedSensitivity> sensitivity_;  // null if it was not asked for
  // All tracked points, or those that the first state shows where they do not identify themselves;
  // empty for scans.
  SurfaceTracks tracks_;
  Eigen::Matrix3Xd previous_velocity_;
  DisplacementField last_motion_;
  Eigen::VectorXd force_, coefficients_;
};

}  // namespace

std::string FarFromScan(const TriMesh& surface, const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return "";
  const double size = BoundingBoxDiagonal(surface.vertices);
  Eigen::VectorXd distances = SurfaceSearch(surface).Nearest(points).distance;
  const auto middle = distances.begin() + distances.size() / 2;
  std::nth_element(distances.begin(), middle, distances.end());
  if (*middle <= kFarFromScan * size) return "";
  return fmt::format(
      "half of the scanned points are farther than {:.3g} mm from the model, which is {:.3g} mm "
      "across; likely causes are a wrong length_unit, a reference shape in another coordinate "
      "system, poses or intrinsics that do not belong to the images, and other objects in the scan "
      "(`crop` and `keep_largest` leave them out)",
      1e3 * *middle, 1e3 * size);
}

FollowedMotion FollowFrames(const ReconstructionStudy& study, const ReferenceBody& reference,
                            const std::vector<FrameState>& states, Progress* progress,
                            const TrackedFrames* tracked, const std::vector<int>& moduli) {
  FollowedMotion motion;
  CHECK(moduli.empty() || (tracked != nullptr && HasModulusSensitivity(study.follow.forces)));
  CHECK(tracked == nullptr || (FirstFrameIsReference(study) && states.front().tracked.cols() == 0));
  motion.body = std::make_shared<Body>(MakeBody(reference.mesh, study.density));
  if (tracked != nullptr) motion.warnings = tracked->warnings;
  Follower follower(study, reference, states, tracked, moduli, &motion);
  progress->Begin("forces", static_cast<int64_t>(states.size()));
  size_t first = 0;
  if (FirstFrameIsReference(study)) {
    follower.RecordRest();
    first = 1;
  }
  for (size_t k = first; k < states.size(); ++k) {
    ThrowIfInterrupted();
    ThrowIfOverMemoryLimit();
    const bool followed = follower.Follow(k);
    progress->Report(static_cast<int64_t>(k + 1), motion.frames.back().weighted_rms);
    if (followed) continue;
    motion.warnings.push_back(fmt::format("frame {} could not be followed ({}); the run ends there",
                                          study.frames[k], motion.frames.back().solver.message));
    break;
  }
  progress->End();
  return motion;
}

}  // namespace lacuna
