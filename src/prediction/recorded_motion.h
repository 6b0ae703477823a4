// Checks of what recordings show, before a long computation starts: whether anything moves, and how
// large the noise is.
#ifndef LACUNA_PREDICTION_RECORDED_MOTION_H_
#define LACUNA_PREDICTION_RECORDED_MOTION_H_

#include <string>
#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

// Whether the markers stay in place within their noise over the fitted frames. False for scans,
// whose points differ from frame to frame.
bool IsAtRest(const PredictedRecording& item);
// Whether this is true of all fitted recordings.
bool IsAtRest(const PredictionStudy& study);
// A warning where nothing moves; empty otherwise.
std::string RestWarning(const PredictionStudy& study);
// All warnings that a user should see before the computation: RestWarning, the warnings of the
// recordings, frames that show no marker, and frames so far apart that a motion with inertia takes
// very many steps between them.
std::vector<std::string> StudyWarnings(const PredictionStudy& study);

// For markers at rest, the largest mean distance of a marker from its place on the undeformed
// object, m.
double RestDeformation(const PredictedRecording& item);

// The standard deviation of a recording's noise, m, estimated from `frames` (ascending). For
// markers it is that of a coordinate: the scatter while the markers rest or, where they never rest,
// the white part of their motion (WhiteNoise); 0 for fewer than three frames. For a scan it is that
// of a point along the surface normal (EstimateScanNoise).
double EstimateRecordingNoise(const PredictedRecording& item, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDED_MOTION_H_
