// The error of the fitted or of the held-out frames of one recording: how large it is, whether it
// is noise, where and when it is largest, and with which quantities it grows.
#ifndef LACUNA_COMPARISON_PART_COMPARISON_H_
#define LACUNA_COMPARISON_PART_COMPARISON_H_

#include <Eigen/Core>
#include <string>

#include "record/comparison_record.h"
#include "record/recorded_residuals.h"

namespace lacuna {

// `recording` gives the noise floor and, where they are known, the points' distances from the grip.
// The statistics are those of analysis/residual_statistics.h and analysis/whiteness.h. Those of
// whiteness are of the errors over the σ of each point: of the coordinates of a marker, and of the
// signed error of a patch along its normal.
ComparedPart ComparePart(const RecordedResiduals& residuals, const FrameRange& range,
                         const ComparedRecording& recording);

// m × n: the length of each error over the rms length that noise alone gives that point in that
// frame, i.e. over √3 σ for a marker and over σ for a patch. NaN where a point was not observed.
Eigen::MatrixXd LengthsOverNoise(const RecordedResiduals& residuals,
                                 const ComparedRecording& recording);

// 3 × m: the mean of each point's measured places over all frames.
Eigen::Matrix3Xd MeanPlaces(const RecordedResiduals& residuals);

// The error, m, and its multiple of the noise as functions of a quantity: one entry for each frame,
// or for each point. `quantity` names it with its unit.
ErrorTrend TrendWith(const std::string& quantity, const Eigen::VectorXd& values,
                     const Eigen::VectorXd& error, const Eigen::VectorXd& over_noise);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_PART_COMPARISON_H_
