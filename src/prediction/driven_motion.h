// Whether the object, or its tracked points, move as the part of it does that moves along a given
// path.
#ifndef LACUNA_PREDICTION_DRIVEN_MOTION_H_
#define LACUNA_PREDICTION_DRIVEN_MOTION_H_

#include <Eigen/Core>
#include <string>

#include "prediction/prediction_study.h"

namespace lacuna {

// How far the object has moved along a direction since the first frame, m, in the frames in which
// a part has moved by `path` along it. NaN where nothing was seen.
struct DrivenMotion {
  Eigen::VectorXd path;
  // One column for what may follow the part: of markers their mean, of scans both ends of the
  // points.
  Eigen::MatrixXd object;
};

// What is probably wrong with a path: that the object moves the other way, many times as far, or
// hardly at all, in proportion to the path. A part of a sentence; empty where the object follows
// the path, and where it does neither.
std::string MistakeInPath(const DrivenMotion& motion);

// MistakeInPath() for each part of a slow recording that moves along a given path without turning.
// The motion with inertia may lag behind the path, or overshoot. Empty if there is no doubt.
std::string DoubtOfPaths(const PredictionStudy& study, const PredictedRecording& item);

// A sentence about tracked points that follow the steps of a grip's given path from frame to frame
// rather than its displacement since the first frame that is used, as the displacements of an
// incremental correlation do. Compares the mean displacement of the points along the path with
// both, by least squares over all frames. Empty if there is no doubt, and for recordings without
// tracked points or such a grip.
std::string DoubtOfIncrements(const PredictedRecording& item);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_DRIVEN_MOTION_H_
