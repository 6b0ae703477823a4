// The noise of a recording of markers, estimated from the recording itself without a model.
#ifndef LACUNA_COMPARISON_NOISE_FLOOR_H_
#define LACUNA_COMPARISON_NOISE_FLOOR_H_

#include "record/comparison_record.h"
#include "record/recorded_residuals.h"

namespace lacuna {

// The white part of the noise from second differences, the scatter about a straight line in the
// periods in which the markers rest, and the larger of the two (analysis/residual_statistics.h).
// `sigma`, m, is the noise that the fit assumed for a typical marker; it decides what counts as
// rest where the white part is unknown. The tracks of other markers are scaled to the noise of a
// typical one, so that the result is that of a typical marker. What cannot be determined is NaN.
NoiseFloor MeasureNoiseFloor(const RecordedResiduals& residuals, double sigma);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_NOISE_FLOOR_H_
