// Whether the first frame of a recording shows the markers where `marker_places` has them on the
// undeformed object, and if not, which mistake would explain it.
#ifndef LACUNA_PREDICTION_PLACE_DOUBTS_H_
#define LACUNA_PREDICTION_PLACE_DOUBTS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

// What limits the distance between the places of markers and where a frame shows them.
struct ExpectedPlaces {
  double deviation = 0;  // m, σ of a coordinate, from errors of the places and of the registration
  // Whether the object as a whole cannot be turned: it is held along all axes at its undeformed
  // place, and the markers are spread over most of it.
  bool cannot_turn = false;
};

// A sentence about markers that are farther from their `places` (3 × m, m) than the deviation
// explains, where one of these mistakes would bring at least three quarters of that distance to
// zero: exchanged names, another unit of length, a mirrored coordinate system, or, of an object
// that cannot turn, one turned by more than 60°. A deformation does none of this. `measured`
// (3 × m, m) are the markers in the first frame, NaN where one was not seen. Empty if there is no
// doubt, and where fewer than four markers are seen, unless names are exchanged.
std::string DoubtOfPlaces(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& measured,
                          const std::vector<std::string>& names, const ExpectedPlaces& expected);

// DoubtOfPlaces() in the first frame that is used of a recording of markers; empty for scans and
// for tracked points, whose places are those of that frame.
std::string DoubtOfPlaces(const PredictionStudy& study, const PredictedRecording& item);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PLACE_DOUBTS_H_
