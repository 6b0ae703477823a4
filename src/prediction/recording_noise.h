// The estimate of a recording's noise, σ.
#ifndef LACUNA_PREDICTION_RECORDING_NOISE_H_
#define LACUNA_PREDICTION_RECORDING_NOISE_H_

#include <vector>

#include "prediction/prediction_study.h"

namespace lacuna {

// The standard deviation of a recording's noise, m, estimated from `frames` (ascending). For
// markers it is that of a coordinate of a marker of weight 1 (EstimateTrackNoise); 0 for fewer than
// three frames. For a scan it is that of a point along the surface normal (EstimateScanNoise).
double EstimateRecordingNoise(const PredictedRecording& item, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDING_NOISE_H_
