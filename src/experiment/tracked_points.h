// Points that are tracked, row by row, through the frames of a recording (image correlation), seen
// as markers: of each it is known which point of the object it is, along the surface too.
#ifndef LACUNA_EXPERIMENT_TRACKED_POINTS_H_
#define LACUNA_EXPERIMENT_TRACKED_POINTS_H_

#include <vector>

#include "scan/recording.h"

namespace lacuna {

// Fills the recording's markers ("p0", "p1", … by row) and their places, which are where the first
// of `frames` shows them: there the object must be undeformed. Points that it does not show are
// left out; of more than some hundreds, as many are used, evenly spread. What is gripped and
// follows the scan follows the points that lie in its region. Throws InputError (file named) where
// a region shows none, and what LoadFrame does.
void SeeAsMarkers(const std::vector<int>& frames, Recording* recording);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_TRACKED_POINTS_H_
