#include "reconstruction/body_registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>

#include "geometry/finite_columns.h"
#include "geometry/nearest.h"
#include "geometry/rigid_fit.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {
namespace {

// The largest standard deviation in a direction along the surface, for each root of the trace of a
// covariance, σ_n² + 2 σ_t²: that of a displacement which is exact along the normal. CPD determines
// that component far better (CpdOptions::tangential_weight); with equal components the result is
// too large by √1.5.
Eigen::VectorXd TangentialDeviation(const Eigen::VectorXd& root_of_trace) {
  return root_of_trace / std::numbers::sqrt2;
}

// The displacements of `at` (3 × n) by a continuous motion that carries `from` to `to` (3 × m;
// pairs that are not finite are ignored): the rigid motion of these points, and the mean of the
// remaining displacements of the nearest of them, weighted by ((R − d) / (R d))² (Franke & Nielson,
// Int. J. Numer. Meth. Eng. 15, 1980). d is the distance of a point, R that of the first that is
// left out. An affine motion would amplify the bending of a slender body across its thickness.
Eigen::Matrix3Xd InterpolatedMotion(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                    const Eigen::Matrix3Xd& at) {
  constexpr Eigen::Index kMostNear = 8;
  const std::vector<Eigen::Index> both = FiniteColumns(from + to);
  if (both.empty()) return Eigen::Matrix3Xd::Zero(3, at.cols());
  const Eigen::Matrix3Xd known = from(Eigen::all, both);
  const Eigen::Matrix3Xd target = to(Eigen::all, both);
  const Eigen::Isometry3d motion = FitRigidMotion(known, target).motion;
  const Eigen::Matrix3Xd remaining = target - motion * known;
  const Eigen::Index near = std::min(kMostNear, known.cols());
  const bool is_limited = near < known.cols();
  const PointHits hits =
      PointSearch(known).Nearest(at, static_cast<int>(is_limited ? near + 1 : near));
  // At a smaller distance a point is as good as reached.
  const double least = std::max(1e-6 * BoundingBoxDiagonal(known), 1e-12);
  Eigen::Matrix3Xd displacement = motion * at - at;
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (Eigen::Index k = 0; k < near; ++k) {
      const double distance = std::max(hits.distance(k, i), least);
      const double root =
          1 / distance - (is_limited ? 1 / std::max(hits.distance(near, i), least) : 0);
      sum += root * root * remaining.col(hits.index(k, i));
      weights += root * root;
    }
    if (weights > 0) displacement.col(i) += sum / weights;
  }
  return displacement;
}

}  // namespace

BodyRegistration::BodyRegistration(const ReconstructionStudy& study, const Body& body,
                                   const std::vector<FrameState>& states,
                                   const TrackedFrames* tracked, std::vector<std::string>* warnings)
    : study_(study),
      body_(body),
      states_(states),
      tracked_(tracked),
      warnings_(*warnings),
      are_identified_(HasIdentifiedPoints(study, states)) {
  const Eigen::Matrix3Xd places = FindPlacesAtRest(study, states).tracked;
  if (places.cols() == 0) return;
  const std::vector<Eigen::Index> known = FiniteColumns(places);
  if (!are_identified_) {
    places_ = Embed(body.mesh, places(Eigen::all, known));
    return;
  }
  places_ = Embed(body.mesh, places);
  if (const Eigen::Index unknown = places.cols() - std::ssize(known); unknown > 0)
    warnings_.push_back(fmt::format(
        "{} of {} tracked points are used in no frame, because it is not known where they are on "
        "the undeformed object: they have no `marker_places`, and frame {}, the first that is "
        "followed, does not show them",
        unknown, places.cols(), study.frames.front()));
}

Eigen::Matrix3Xd BodyRegistration::Shift(size_t k, const Eigen::Matrix3Xd& nodes) {
  if (tracked_ != nullptr) {
    const Eigen::Matrix3Xd& rest = body_.mesh.nodes;
    return tracked_->DisplacementAt(k, rest) - tracked_->DisplacementAt(k - 1, rest);
  }
  if (are_identified_) {
    const Eigen::Matrix3Xd from =
        k > 0 ? states_[k - 1].tracked : PointsAt(places_, body_.mesh, nodes);
    return InterpolatedMotion(from, states_[k].tracked, nodes);
  }
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
    return {TrackedTarget(k),
            TangentialDeviation(tracked_->DeviationAt(k, body_.boundary.surface.vertices))};
  const PointCloud points = RegistrationPoints(nodes);
  const Alignment aligned = Registered(k, points);
  return {points.points + aligned.displacement, TangentialDeviation(aligned.standard_deviation)};
}

Observations BodyRegistration::Observe(size_t k, const Eigen::Matrix3Xd& nodes,
                                       const Correspondence& correspondence, double noise) const {
  const BoundarySurface& boundary = body_.boundary;
  if (are_identified_) return ObserveMarkers(body_.mesh, places_, states_[k].tracked, noise);
  if (places_.tet.size() > 0)
    return ObserveMarkers(body_.mesh, places_, correspondence.target, noise);
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
    residual.displacement = states_[k].tracked - PointsAt(places_, body_.mesh, nodes);
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

Eigen::Matrix3Xd BodyRegistration::TrackedTarget(size_t k) const {
  const Eigen::Matrix3Xd& rest = body_.boundary.surface.vertices;
  return rest + tracked_->DisplacementAt(k, rest);
}

PointCloud BodyRegistration::SimulatedSurface(const Eigen::Matrix3Xd& nodes) const {
  const TriMesh surface = BoundaryAt(body_.boundary, nodes);
  return {surface.vertices, VertexNormals(surface)};
}

// The points that represent the model in a registration: the places of the tracked points, which
// exclude sides that are never seen, or its whole surface.
PointCloud BodyRegistration::RegistrationPoints(const Eigen::Matrix3Xd& nodes) const {
  if (places_.tet.size() == 0) return SimulatedSurface(nodes);
  return {PointsAt(places_, body_.mesh, nodes), {}};
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
