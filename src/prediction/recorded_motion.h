// Whether recordings show anything at all: what is to be said of them before a long computation.
#ifndef LACUNA_PREDICTION_RECORDED_MOTION_H_
#define LACUNA_PREDICTION_RECORDED_MOTION_H_

#include <string>
#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

// Whether the markers stay in place, over the frames that are fitted, as far as their noise lets
// one see. Never of scans, whose points are not the same from frame to frame.
bool IsAtRest(const PredictedRecording& item);
// Of all recordings that are fitted.
bool IsAtRest(const PredictionStudy& study);
// What a user should know of a study at rest; empty where something moves.
std::string RestWarning(const PredictionStudy& study);
// All that a user should know of a study before the computation: that, what its recordings warn of,
// frames that show no marker, and frames between which a motion with inertia takes very many steps.
std::vector<std::string> StudyWarnings(const PredictionStudy& study);

// Of markers at rest: how far the farthest is on average from its place on the undeformed object,
// m.
double RestDeformation(const PredictedRecording& item);

// The standard deviation of a recording's noise, m, estimated from `frames` (ascending). For
// markers it is that of a coordinate: the scatter while the markers rest or, where they never rest,
// the white part of their motion (WhiteNoise); 0 for fewer than three frames. For a scan it is that
// of a point along the surface normal (EstimateScanNoise).
double EstimateRecordingNoise(const PredictedRecording& item, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDED_MOTION_H_
