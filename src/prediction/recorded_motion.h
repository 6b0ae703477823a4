// Checks of what recordings show, before a long computation starts: above all, whether anything
// moves.
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
// The frames of a recording that are fitted, ascending; none where it is only predicted. The other
// used frames are held out.
std::vector<int> FittedFrames(const PredictedRecording& item);
// All warnings that a user should see before the computation: RestWarning, the warnings of the
// recordings, frames that show no marker, markers and tracked points that are elsewhere because of
// a mistake (place_doubts.h), a `fit_until` that holds out no frame, frames so far apart that a
// motion with inertia takes very many steps between them, a recording under gravity of which the
// model has none, and settings of scans where no recording is one.
std::vector<std::string> StudyWarnings(const PredictionStudy& study);

// For markers at rest, the largest mean distance of a marker from its place on the undeformed
// object, m.
double RestDeformation(const PredictedRecording& item);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDED_MOTION_H_
