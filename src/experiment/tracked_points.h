// Converts tracked points, as image correlation gives them, into markers. A tracked point is the
// same material point in all frames, so that its motion along the surface is known too.
#ifndef LACUNA_EXPERIMENT_TRACKED_POINTS_H_
#define LACUNA_EXPERIMENT_TRACKED_POINTS_H_

#include <Eigen/Core>
#include <vector>

#include "scan/recording.h"

namespace lacuna {

// Fills in the recording's markers ("p0", "p1", … by row) and their places, which are their
// positions in the first of `frames`, where the object must be undeformed. Points that this frame
// does not show are left out; where the program of image correlation gives the standard deviation
// of each point, it becomes the marker's weight. Of more than some hundred points an evenly spread
// subset is used. A grip that follows the scan then follows the points in its region. Throws
// InputError, which names the file, where a region contains no visible point, and whatever
// LoadFrame throws.
void ConvertTrackedPointsToMarkers(const std::vector<int>& frames, Recording* recording);

// For each marker the root of its mean weight in `frames`, which must have weights: its tracks,
// multiplied by this, have the noise of a marker of weight 1.
Eigen::VectorXd TrackFactors(const Markers& markers, const std::vector<int>& frames);

// The tracks of the markers in `frames` (3m × frames, m; NaN: not seen), each multiplied by its
// TrackFactors there, so that all have the noise of a marker of weight 1.
Eigen::MatrixXd WeightedTracks(const Markers& markers, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_TRACKED_POINTS_H_
