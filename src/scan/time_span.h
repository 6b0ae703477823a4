// Doubts about the times of loads and paths, which are often in another unit than was said.
#ifndef LACUNA_SCAN_TIME_SPAN_H_
#define LACUNA_SCAN_TIME_SPAN_H_

#include <Eigen/Core>
#include <string>

namespace lacuna {

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
