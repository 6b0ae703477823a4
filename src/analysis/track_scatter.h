// How far tracked points scatter about their own smooth motion.
//
// The tracks of m points over n frames form a 3m × n matrix as in residual_statistics.h: the x, y
// and z of a point in consecutive rows, frames in temporal order, NaN where a point was not seen;
// in m.
#ifndef LACUNA_ANALYSIS_TRACK_SCATTER_H_
#define LACUNA_ANALYSIS_TRACK_SCATTER_H_

#include <Eigen/Core>

#include "analysis/residual_statistics.h"

namespace lacuna {

struct TrackNoise {
  double deviation = kUnknown;  // m, σ of a coordinate; NaN for fewer than three frames
  bool is_at_rest = false;      // whether it is that of frames in which all points rest
  StaticSpan rest;              // those frames, if it is
};

// The noise of a coordinate: the scatter about a straight line while the points rest for at least
// eight frames (StaticSpans), noise that is correlated over frames included; of several rests the
// smallest, because a body that is not quite at rest makes it larger. Where the points never rest,
// the white part of their motion (WhiteNoise), which is an upper bound: a vibration that is fast
// for the frame rate looks like noise.
TrackNoise EstimateTrackNoise(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions);

// Points that leave their tracks for a frame, as when two markers are exchanged or an image is
// matched wrongly.
struct TrackOutliers {
  double share = kUnknown;  // of the places that could be judged; NaN where none could be
  int worst_frame = -1;     // the column with the most of them; −1 without any
  int in_worst_frame = 0;
  double farthest = 0;  // m, the largest deviation of a coordinate of such a point
};

// A place is an outlier if a coordinate differs from the cubic through the two frames before and
// the two after by more than five standard deviations: of the point's noise (`deviations`: m, one σ
// of a coordinate for each point) and of what three quarters of all coordinates show in the frame,
// since a jerk moves many points at once. Of consecutive frames that an outlier affects only the
// one with the largest difference counts.
//
// Not judged are frames whose five `times` (s) are not equally spaced within 5 %, and frames with
// fewer than five points: one point that leaves its track would there raise what three quarters of
// the coordinates show. For the same reason points that leave their tracks in the same frame are
// found only if they are fewer than a quarter of those that are seen there.
TrackOutliers FindTrackOutliers(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                const Eigen::VectorXd& deviations);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_TRACK_SCATTER_H_
