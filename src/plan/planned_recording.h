// Applies a protocol to a recording: the recording that it would make, still without measurements.
#ifndef LACUNA_PLAN_PLANNED_RECORDING_H_
#define LACUNA_PLAN_PLANNED_RECORDING_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/tet_mesh.h"
#include "plan/protocol.h"
#include "prediction/prediction_study.h"
#include "record/plan_record.h"

namespace lacuna {

struct PlannedRecording {
  // All its frames are used and fitted, and see all markers. Markers stand in no meaningful place,
  // except that those that a grip follows move as the grip does. Load cells read 0.
  PredictedRecording item;
  // Motion of the fixture before the recording: x = fixture X for the undeformed place X.
  Eigen::Isometry3d fixture = Eigen::Isometry3d::Identity();

  double Seconds() const { return item.recording.times.back() - item.recording.times.front(); }
};

// The recording that the protocol makes of one of the study's recordings, named after the protocol.
// It is one of markers, as it is written (recording_writer.h) and a fit will read it, also where
// the other one has tracked points: all have the same noise, and places that are known to the
// study's `place_deviation`. `mesh` is the undeformed object. Regions, grips and the hold refer to
// the undeformed object as before; a fixture that is turned or shaken has grips with given paths,
// which start at the undeformed place some seconds before the first frame. Throws InputError,
// without a position, for what cannot be done: a clamp to be turned or shaken that does not exist,
// a pull where nothing pulls, a mass outside the object, a clamp that moves through a plane of
// contact.
PlannedRecording PlanRecording(const Protocol& protocol, const PredictionStudy& study,
                               const TetMesh& mesh);

// The paths and turns of the grips that move, the known forces and, with the force `hold` (N), that
// of the hand, over time.
ProtocolPicture PictureOf(const PlannedRecording& planned, const TetMesh& mesh,
                          const Eigen::Vector3d& hold);

// The force that holds the object until the release, N, given that of the recording `before`.
Eigen::Vector3d PlannedHoldForce(const Protocol& protocol, const Eigen::Vector3d& before);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PLANNED_RECORDING_H_
