#include "reconstruction/follow.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/median.h"
#include "core/memory_limit.h"
#include "core/quantity.h"
#include "experiment/grip_tracks.h"
#include "experiment/known_loads.h"
#include "fit/step_force_fitter.h"
#include "geometry/nearest.h"
#include "reconstruction/body_registration.h"
#include "reconstruction/followed_sensitivity.h"
#include "reconstruction/force_model_choice.h"
#include "reconstruction/point_noise.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {
namespace {

class Follower {
 public:
  Follower(const ReconstructionStudy& study, const ReferenceBody& reference,
           const std::vector<FrameState>& states, const TrackedFrames* tracked,
           const std::vector<int>& moduli, FollowedMotion* motion)
      : study_(study),
        states_(states),
        motion_(*motion),
        registration_(study, *motion->body, states, tracked, &motion->warnings) {
    SetNoise();
    model_ = {motion_.body, study.effects, {}};
    grips_ = std::make_unique<GripTracks>(study.recording, reference.mesh, &model_);
    forces_ = MakeForceModel(study, model_);
    if (study.follow.forces.kind == ForceSettings::Kind::kKnown)
      known_forces_ = MakeKnownForces(study.recording, model_);
    model_.effects.insert(model_.effects.end(), known_forces_.begin(), known_forces_.end());
    history_ = RestHistory(model_);
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
    MeasureResidual(0, &frame);
    motion_.frames.push_back(std::move(frame));
    grips_->Begin(history_.time);
  }

  // Returns false when the frame could not be followed; its record says why.
  bool Follow(size_t k) {
    const FrameState& state = states_[k];
    const Body& body = *motion_.body;
    // In quasi-static motion every frame is an equilibrium, independent of the previous frame; a
    // first frame that is not the reference shape is one in any case.
    const bool is_static = study_.follow.scheme == TimeScheme::kQuasiStatic;
    const double time_step = is_static || k == 0 ? 0 : state.time - states_[k - 1].time;

    FollowedFrame frame;
    frame.time = state.time;
    const Eigen::Matrix3Xd before = history_.position.reshaped(3, Eigen::AutoSize);
    const Eigen::Matrix3Xd shift = registration_.Shift(k, before);
    frame.pseudo_force = PseudoForce(shift, time_step);
    const RecordedGrip* lost = grips_->Extend(state.time, before, before + shift, MarkersIn(k));
    if (lost != nullptr)
      throw InputError(
          fmt::format("{}: at {} too few of the markers that \"{}\" follows are seen, or their "
                      "marker_places are missing",
                      study_.recording.file.string(), TimeText(state.time), lost->region.name));

    Eigen::VectorXd start = (before + shift).reshaped();
    grips_->Place(state.time, &start);
    MotionHistory from = history_;
    if (time_step == 0) from.time = state.time;
    const TimeScheme scheme = time_step > 0 ? study_.follow.scheme : TimeScheme::kQuasiStatic;
    const StepEquation equation(model_, from, scheme, time_step);

    ForceFit fit;
    if (forces_.HasUnknowns()) {
      fit = FitForces(k, equation, start, &frame);
      if (!fit.IsUsable()) return Fail("forces", fit.message, &frame);
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
    if (!step.IsUsable()) return Fail("step", step.message, &frame);
    if (sensitivity_ != nullptr) {
      sensitivity_->Advance(from, scheme, time_step, after.position);
      frame.position_derivative = sensitivity_->position();
    }
    history_ = after;
    force_ = fit.force;
    coefficients_ = fit.coefficients;

    frame.position = history_.position.reshaped(3, Eigen::AutoSize);
    // Without fitted forces the distance is the result.
    if (forces_.HasUnknowns() && state.tracked.cols() == 0) {
      const TriMesh surface = BoundaryAt(body.boundary, frame.position);
      const std::string problem = FarFromScan(surface, state.cloud.points);
      if (!problem.empty()) return Fail("scan", problem, &frame);
    }
    frame.force = (fit.force + KnownForces()).reshaped(3, Eigen::AutoSize);
    MeasureResidual(k, &frame);
    WarnOfOtherEquilibrium(k, fit);
    const bool is_stopped = fit.status == ForceFit::Status::kEndedEarly;
    if (is_stopped) {
      motion_.warnings.push_back(
          fmt::format("frame {}: the search for the forces ended before its minimum ({}); the "
                      "residual there is {:.3g} times the noise",
                      study_.frames[k], fit.message, fit.weighted_rms));
    }
    frame.solver = {true, is_stopped ? "ended early" : "converged", is_stopped ? fit.message : "",
                    frame.solver.iterations};
    motion_.frames.push_back(std::move(frame));
    return true;
  }

 private:
  // Warns where the step under the fitted forces leads elsewhere than the fit.
  void WarnOfOtherEquilibrium(size_t k, const ForceFit& fit) {
    if (!forces_.HasUnknowns() || motion_.noise <= 0) return;
    const Eigen::Matrix3Xd apart = (history_.position - fit.position).reshaped(3, Eigen::AutoSize);
    const double rms = std::sqrt(apart.squaredNorm() / static_cast<double>(apart.cols()));
    constexpr double kFar = 3;
    if (rms <= kFar * motion_.noise) return;
    motion_.warnings.push_back(fmt::format(
        "frame {}: the fitted forces lead the model {:.3g} mm (rms) away from where it was fitted "
        "to the scan, {:.2g} times the noise: they are not those of this frame, and the next one "
        "starts from the wrong place. A larger `fit.noise` or fewer forces (`forces.model`) may "
        "help",
        study_.frames[k], 1e3 * rms, rms / motion_.noise));
  }

  // Fits the forces of the step that ends in state k, from the node positions `start` at its end.
  // Each round looks for the nearest scanned points where the last one has led. Sets what the frame
  // tells of the fit.
  ForceFit FitForces(size_t k, const StepEquation& equation, Eigen::VectorXd start,
                     FollowedFrame* frame) {
    const BodyRegistration::Correspondence correspondence =
        registration_.Register(k, start.reshaped(3, Eigen::AutoSize));
    StepForceFitter fitter(model_, equation, forces_, start, coefficients_);
    ForceFit fit;
    for (int round = 0; round < study_.follow.alignment_rounds; ++round) {
      ThrowIfInterrupted();
      ThrowIfOverMemoryLimit();
      const Observations seen = registration_.Observe(k, start.reshaped(3, Eigen::AutoSize),
                                                      correspondence, motion_.noise);
      frame->observations = static_cast<int>(seen.Count());
      // The prior of free forces is centred at those of the last frame, and that of coefficients at
      // 0: as a random walk, coefficients that the scans do not determine would drift.
      ForceFitOptions options = study_.follow.fit;
      // Correspondences that will be searched for again do not need an exact fit.
      const bool is_last = round + 1 == study_.follow.alignment_rounds;
      if (!is_last) options.function_tolerance = std::max(options.function_tolerance, 1e-2);
      fit = fitter.Fit(seen, {force_, {}}, options);
      frame->solver.iterations += fit.factorisations;
      if (!fit.IsUsable()) break;
      const Eigen::MatrixXd covariance =
          is_last ? fitter.Covariance(fit, seen, options) : Eigen::MatrixXd();
      if (covariance.size() > 0) frame->force_deviation = NetForceDeviation(forces_, covariance);
      start = fit.position;
    }
    return fit;
  }

  bool Fail(const char* what, const std::string& message, FollowedFrame* frame) {
    frame->solver.usable = false;
    frame->solver.status = "no convergence";
    frame->solver.message = fmt::format("{}: {}", what, message);
    const Eigen::Index nodes = motion_.body->NodeCount();
    const auto unknown = std::numeric_limits<double>::quiet_NaN();
    frame->position = Eigen::Matrix3Xd::Constant(3, nodes, unknown);
    frame->force = frame->position;
    frame->residual = Eigen::Matrix3Xd::Constant(3, registration_.Count(), unknown);
    motion_.frames.push_back(std::move(*frame));
    return false;
  }

  // Only a fit of forces uses the noise.
  void SetNoise() {
    if (!study_.follow.forces.AreFitted()) return;
    motion_.noise = study_.follow.noise;
    if (motion_.noise > 0) return;
    const PointNoise estimate = NamingWhere(study_.name, [this] {
      const bool is_scanned = study_.recording.reference.source == ReferenceSource::kFirstFrame;
      return EstimatePointNoise(states_, HasIdentifiedPoints(study_, states_),
                                is_scanned ? states_.front().surface : TriMesh());
    });
    motion_.noise = estimate.deviation;
    if (!estimate.warning.empty()) motion_.warnings.push_back(estimate.warning);
  }

  // All markers of the recording in state k, those that are held out included; 3 × 0 without.
  Eigen::Matrix3Xd MarkersIn(size_t k) const {
    const std::vector<Eigen::Matrix3Xd>& positions = study_.recording.markers.positions;
    if (positions.empty()) return Eigen::Matrix3Xd(3, 0);
    return positions[static_cast<size_t>(study_.frames[k])];
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

  void MeasureResidual(size_t k, FollowedFrame* frame) const {
    BodyRegistration::Residual residual = registration_.Measure(k, frame->position);
    frame->residual = std::move(residual.displacement);
    frame->residual_problem = std::move(residual.problem);
  }

  const ReconstructionStudy& study_;
  const std::vector<FrameState>& states_;
  FollowedMotion& motion_;
  BodyRegistration registration_;
  Model model_;
  std::unique_ptr<GripTracks> grips_;
  ForceModel forces_;
  EffectList known_forces_;
  MotionHistory history_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<FollowedSensitivity> sensitivity_;  // null if it was not asked for
  Eigen::Matrix3Xd previous_velocity_;
  Eigen::VectorXd force_, coefficients_;
};

}  // namespace

std::string FarFromScan(const TriMesh& surface, const Eigen::Matrix3Xd& points) {
  if (points.cols() == 0) return "";
  const double size = BoundingBoxDiagonal(surface.vertices);
  const Eigen::VectorXd distances = SurfaceSearch(surface).Nearest(points).distance;
  const double middle = Median({distances.data(), distances.data() + distances.size()});
  if (middle <= kFarFromScan * size) return "";
  return fmt::format(
      "half of the scanned points are farther than {:.3g} mm from the model, which is {:.3g} mm "
      "across; likely causes are a wrong length_unit, a reference shape in another coordinate "
      "system, poses or intrinsics that do not belong to the images, and other objects in the scan "
      "(`crop` and `keep_largest` leave them out)",
      1e3 * middle, 1e3 * size);
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
