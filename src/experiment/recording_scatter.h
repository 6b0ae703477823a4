// How far the points of a recording scatter, over all of its frames.
#ifndef LACUNA_EXPERIMENT_RECORDING_SCATTER_H_
#define LACUNA_EXPERIMENT_RECORDING_SCATTER_H_

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "scan/recording.h"

namespace lacuna {

struct RecordingScatter {
  // Whether the scatter is that of scanned points, σ of a point about the surface through its
  // neighbours along the normal (scan/surface_scatter.h), or that of markers and tracked points, σ
  // of a coordinate about the motion of its point (analysis/track_scatter.h).
  bool is_of_surface = false;
  // m, σ: of scans the median over the frames, of tracks that of all of them together, or of a
  // marker of weight 1 where they have weights. NaN where nothing can be said.
  double typical = std::numeric_limits<double>::quiet_NaN();
  // The scatter includes shape or motion that the recording does not resolve; that of tracks was
  // not taken from frames in which the points rest.
  bool is_upper_bound = false;
  double largest = 0;        // m, σ of the frame, marker or tracked point that scatters most
  std::string largest_in;    // its name: "frame 7", "marker tip", or "point p12" of row 12
  double spacing = 0;        // m, of the points of a cloud (median over the frames); 0: none
  double outlier_share = 0;  // of all points in all frames; NaN where none could be judged
  int worst_frame = -1;      // the frame with the largest share of outliers; −1 without any
  double worst_share = 0;    // that share
  // m: of scans the largest distance of an outlier from the surface, of tracks the largest
  // deviation of a coordinate of an outlier; 0 without any.
  double farthest = 0;
};

// Measures the frames of a recording one after the other, as they are read. Deterministic.
class ScatterSurvey {
 public:
  // `recording` must outlive the survey.
  explicit ScatterSurvey(const Recording& recording) : recording_(recording) {}

  void Add(const Frame& frame);
  RecordingScatter Result() const;

 private:
  void AddSurface(const Frame& frame);
  RecordingScatter OfSurfaces() const;
  RecordingScatter OfTracks() const;

  const Recording& recording_;
  // What the scans added so far show, one entry per frame in which the scatter is known:
  std::vector<int> frames_;
  std::vector<double> deviations_, spacings_, outlier_shares_;  // m, m, –
  std::vector<bool> is_upper_bound_;
  double farthest_ = 0;  // m
  // The places of the tracked points added so far by row (3 × rows, NaN: not seen), one per frame.
  std::vector<int> tracked_frames_;
  std::vector<Eigen::Matrix3Xd> places_;
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_RECORDING_SCATTER_H_
