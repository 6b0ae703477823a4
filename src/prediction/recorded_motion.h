// Checks of what recordings show, before a long computation starts: above all, whether anything
// moves.
#ifndef LACUNA_PREDICTION_RECORDED_MOTION_H_
#define LACUNA_PREDICTION_RECORDED_MOTION_H_

#include <string>
#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

// Whether the markers of all fitted recordings stay in place within their noise over the fitted
// frames. False where one shows scans, whose points differ from frame to frame.
bool IsAtRest(const PredictionStudy& study);
// A warning where nothing moves; empty otherwise.
std::string RestWarning(const PredictionStudy& study);
// The warnings about negative Poisson's ratios, of the model and of each recording's own effects.
std::vector<std::string> AuxeticWarnings(const PredictionStudy& study);
// All warnings that a user should see before the computation: RestWarning, the warnings of the
// recordings, frames that show no marker, markers and tracked points that are elsewhere because of
// a mistake (place_doubts.h), an object that moves otherwise than the path of a part of it
// (driven_motion.h), a part on a given path that has moved before a first frame that is to
// show the object undeformed, a `fit_until` that holds out no frame, frames so far apart that a
// motion with inertia takes very many steps between them, states of one object in recordings of
// their own, a recording under gravity of which the model has none, a negative Poisson's ratio, and
// settings of scans where no recording is one.
std::vector<std::string> StudyWarnings(const PredictionStudy& study);

// For markers at rest, the largest mean distance of a marker from its place on the undeformed
// object over the fitted frames, m.
double RestDeformation(const PredictedRecording& item);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDED_MOTION_H_
