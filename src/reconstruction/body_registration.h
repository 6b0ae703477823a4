// Where the points of the simulated body are in the recorded states: align(p, S) of Transue & Choi
// 2015, Eq. 1.
#ifndef LACUNA_RECONSTRUCTION_BODY_REGISTRATION_H_
#define LACUNA_RECONSTRUCTION_BODY_REGISTRATION_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "fem/body.h"
#include "fit/observations.h"
#include "geometry/embedding.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/tracked_frames.h"
#include "registration/surface_alignment.h"

namespace lacuna {

// Node positions are 3 × nodes of the body, m. Tracked points that identify themselves
// (HasIdentifiedPoints) are where they were seen, and are embedded in the body at their places on
// it (FindPlacesAtRest), as in a fit; a warning says how many have none. Other points are found by
// CPD, whose failures become warnings that name the frame.
class BodyRegistration {
 public:
  // The places of points of the body in a state, found by CPD. Where it failed, they are NaN and
  // their deviation is infinite. Empty where tracked points identify themselves.
  struct Correspondence {
    Eigen::Matrix3Xd target;  // 3 × n, m
    Eigen::VectorXd sigma;    // m, of each target, in each direction along the surface
  };
  // D of Eq. 1, m, as FollowedFrame (follow.h) has it.
  struct Residual {
    Eigen::Matrix3Xd displacement;
    std::string problem;  // why it is not known; empty: it is
  };

  // `tracked`: the registrations that replace those of the body, or null. All arguments are used as
  // long as the object exists.
  BodyRegistration(const ReconstructionStudy& study, const Body& body,
                   const std::vector<FrameState>& states, const TrackedFrames* tracked,
                   std::vector<std::string>* warnings);

  // The number of points of which a residual consists.
  Eigen::Index Count() const {
    return are_identified_ ? places_.tet.size() : body_.boundary.node.size();
  }

  // The displacements of `nodes` from state k − 1 to state k (the paper's displacement field
  // between consecutive surfaces), interpolated between identified points that both states show.
  // The simulated surface, or the places of those points on it, take the place of a state before
  // the first.
  Eigen::Matrix3Xd Shift(size_t k, const Eigen::Matrix3Xd& nodes);

  Correspondence Register(size_t k, const Eigen::Matrix3Xd& nodes) const;

  // What state k shows of the body at `nodes`, with the standard deviation `noise` (m) of a scanned
  // point or of a coordinate of an identified one.
  Observations Observe(size_t k, const Eigen::Matrix3Xd& nodes,
                       const Correspondence& correspondence, double noise) const;

  Residual Measure(size_t k, const Eigen::Matrix3Xd& nodes) const;

 private:
  Eigen::Matrix3Xd TrackedTarget(size_t k) const;
  PointCloud SimulatedSurface(const Eigen::Matrix3Xd& nodes) const;
  PointCloud RegistrationPoints(const Eigen::Matrix3Xd& nodes) const;
  Alignment Registered(size_t k, const PointCloud& source,
                       const DisplacementField* previous = nullptr) const;

  const ReconstructionStudy& study_;
  const Body& body_;
  const std::vector<FrameState>& states_;
  const TrackedFrames* tracked_;
  std::vector<std::string>& warnings_;
  const bool are_identified_;
  // The places on the body of all tracked points, or of those with known places where they do not
  // identify themselves; empty for scans.
  Embedding places_;
  DisplacementField last_motion_;
};

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_BODY_REGISTRATION_H_
