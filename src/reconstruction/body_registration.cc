#include "reconstruction/body_registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "geometry/rigid_fit.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {

BodyRegistration::BodyRegistration(const ReconstructionStudy& study, const Body& body,
                                   const std::vector<FrameState>& states,
                                   const TrackedFrames* tracked, std::vector<std::string>* warnings)
    : study_(study),
      body_(body),
      states_(states),
      tracked_(tracked),
      warnings_(*warnings),
      are_identified_(HasIdentifiedPoints(study, states)) {
  if (const FrameState& front = states.front(); front.tracked.cols() > 0)
    tracks_ = TrackOnSurface(body.boundary, are_identified_ ? front.tracked : front.cloud.points);
}

Eigen::Matrix3Xd BodyRegistration::Shift(size_t k, const Eigen::Matrix3Xd& nodes) {
  if (tracked_ != nullptr) {
    const Eigen::Matrix3Xd& rest = body_.mesh.nodes;
    return tracked_->DisplacementAt(k, rest) - tracked_->DisplacementAt(k - 1, rest);
  }
  if (are_identified_ && SeenBeside(k) < CpdResult::kFewestPoints) return RigidShift(k, nodes);
  const PointCloud from = k > 0 ? StatePoints(states_[k - 1]) : SimulatedSurface(nodes);
  // The search starts from the last motion, because motions are continuous.
  last_motion_ = Registered(k, from, &last_motion_).field;
  if (last_motion_.IsEmpty()) return Eigen::Matrix3Xd::Zero(3, nodes.cols());
  return last_motion_.Evaluate(nodes);
}

BodyRegistration::Correspondence BodyRegistration::Register(size_t k,
                                                            const Eigen::Matrix3Xd& nodes) const {
  if (are_identified_) return {};
  if (tracked_ != nullptr)
    return {TrackedTarget(k), tracked_->DeviationAt(k, body_.boundary.surface.vertices)};
  const PointCloud points = RegistrationPoints(nodes);
  const Alignment aligned = Registered(k, points);
  return {points.points + aligned.displacement, aligned.standard_deviation};
}

Observations BodyRegistration::Observe(size_t k, const Eigen::Matrix3Xd& nodes,
                                       const Correspondence& correspondence, double noise) const {
  const BoundarySurface& boundary = body_.boundary;
  if (are_identified_)
    return ObserveMarkers(boundary, tracks_.at_rest, states_[k].tracked - tracks_.offset, noise);
  if (tracks_.Count() > 0)
    return ObserveMarkers(boundary, tracks_.at_rest, correspondence.target - tracks_.offset, noise);
  const double size = BoundingBoxDiagonal(body_.mesh.nodes);
  // Tangential to the surface only CPD contains information. Along its normal the scanned points
  // are more accurate where there are any, so that CPD gets a larger standard deviation there.
  const double slip =
      study_.follow.tangential_noise > 0 ? study_.follow.tangential_noise : 0.03 * size;
  const Eigen::VectorXd tangent = correspondence.sigma.cwiseMax(std::max(noise, slip));
  const Eigen::VectorXd normal = tangent.cwiseMax(5 * noise);
  const Observations registered =
      ObserveVertices(boundary, nodes, correspondence.target, normal, tangent);
  const Observations scanned =
      ObserveScan(boundary, nodes, states_[k].cloud, noise, study_.follow.reach * size);
  return Concatenate(registered, scanned);
}

BodyRegistration::Residual BodyRegistration::Measure(size_t k,
                                                     const Eigen::Matrix3Xd& nodes) const {
  const BoundarySurface& boundary = body_.boundary;
  Residual residual;
  if (are_identified_) {
    residual.displacement = states_[k].tracked - PointsAt(tracks_, boundary, nodes);
    if (residual.displacement.array().isNaN().colwise().any().all())
      residual.problem = "none of the tracked points is seen";
    return residual;
  }
  const Eigen::Matrix3Xd vertices = BoundaryAt(boundary, nodes).vertices;
  if (tracked_ != nullptr) {
    residual.displacement = TrackedTarget(k) - vertices;
    residual.problem = tracked_->failures[k];
  } else {
    const Alignment aligned = Registered(k, RegistrationPoints(nodes));
    if (aligned.field.IsEmpty())
      residual.problem = aligned.message;
    else
      residual.displacement = aligned.field.Evaluate(vertices);
  }
  if (!residual.problem.empty())
    residual.displacement =
        Eigen::Matrix3Xd::Constant(3, vertices.cols(), std::numeric_limits<double>::quiet_NaN());
  return residual;
}

// The number of points that are seen in state k, or in the state before it if that shows fewer.
Eigen::Index BodyRegistration::SeenBeside(size_t k) const {
  const Eigen::Index here = states_[k].cloud.Size();
  return k > 0 ? std::min(here, states_[k - 1].cloud.Size()) : here;
}

// The rigid motion of identified points that are too few for CPD. In the first state they are where
// the undeformed body has them.
Eigen::Matrix3Xd BodyRegistration::RigidShift(size_t k, const Eigen::Matrix3Xd& nodes) const {
  if (k == 0) return Eigen::Matrix3Xd::Zero(3, nodes.cols());
  return FitRigidMotion(states_[k - 1].tracked, states_[k].tracked).motion * nodes - nodes;
}

Eigen::Matrix3Xd BodyRegistration::TrackedTarget(size_t k) const {
  const Eigen::Matrix3Xd& rest = body_.boundary.surface.vertices;
  return rest + tracked_->DisplacementAt(k, rest);
}

PointCloud BodyRegistration::SimulatedSurface(const Eigen::Matrix3Xd& nodes) const {
  const TriMesh surface = BoundaryAt(body_.boundary, nodes);
  return {surface.vertices, VertexNormals(surface)};
}

// The points that represent the model in a registration: the places of the tracked points that the
// first state shows, which exclude sides that are never seen, or its whole surface.
PointCloud BodyRegistration::RegistrationPoints(const Eigen::Matrix3Xd& nodes) const {
  if (tracks_.Count() == 0) return SimulatedSurface(nodes);
  return {PointsAt(tracks_, body_.boundary, nodes), {}};
}

// Registers a cloud to state k. A result that has not converged is used with a warning. One that
// failed is replaced by unknown displacements (NaN) with an infinite standard deviation.
Alignment BodyRegistration::Registered(size_t k, const PointCloud& source,
                                       const DisplacementField* previous) const {
  if (previous != nullptr && previous->IsEmpty()) previous = nullptr;
  Alignment alignment = Align(source, StatePoints(states_[k]), study_.registration, previous);
  if (!alignment.IsUsable()) {
    const std::string warning =
        fmt::format("frame {}: registration: {}", study_.frames[k], alignment.message);
    // A frame is registered several times, often with the same outcome.
    if (warnings_.empty() || warnings_.back() != warning) warnings_.push_back(warning);
  }
  if (alignment.field.IsEmpty()) {
    alignment.displacement =
        Eigen::Matrix3Xd::Constant(3, source.Size(), std::numeric_limits<double>::quiet_NaN());
    alignment.standard_deviation = Eigen::VectorXd::Constant(source.Size(), kUnobserved);
  }
  return alignment;
}

}  // namespace lacuna
