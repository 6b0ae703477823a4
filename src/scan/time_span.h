// Whether the times of loads and paths fit those of the frames: whether they cover them, and doubts
// about their unit.
#ifndef LACUNA_SCAN_TIME_SPAN_H_
#define LACUNA_SCAN_TIME_SPAN_H_

#include <Eigen/Core>
#include <string>
#include <vector>

namespace lacuna {

// The difference, s, up to which a time in another file is that of a frame: a thousandth of the
// mean interval between the frames, so that times may be rounded, and at least their rounding as
// floating-point numbers. `frame_times`: s, ascending, at least one.
double TimeMargin(const std::vector<double>& frame_times);

// Whether a series at `times` (k ≥ 1, s, ascending) covers the time from `first` to `last` (s) up
// to `margin` (s) or rounding. Beyond its ends the values of a series are constant (time_series.h);
// the path of a grip goes on after its last row (recorded_grip.h).
bool CoversTimes(const Eigen::VectorXd& times, double first, double last, double margin);

// A sentence about a series of `values` (c × k) at `times` (k, s, ascending) beside a recording
// from `first` to `last` (s): its times end more than four durations of the recording after it, or
// it goes on outside the recording and changes by less than a twentieth of its range within it, or
// it covers less than a hundredth of the recording and another unit would make it end with the
// recording. Names that unit. Empty if there is no doubt.
std::string DoubtOfTimeSpan(const Eigen::VectorXd& times,
                            const Eigen::Ref<const Eigen::MatrixXd>& values, double first,
                            double last);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TIME_SPAN_H_
