// Reads an experiment with a prediction. docs/prediction.md lists the keys.
#ifndef LACUNA_PREDICTION_PREDICTION_STUDY_READER_H_
#define LACUNA_PREDICTION_PREDICTION_STUDY_READER_H_

#include "core/config.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// Reads and checks everything that can be checked before the computation. Throws InputError.
PredictionStudy ReadPredictionStudy(const Config& config);

// Whether an experiment's YAML describes a prediction study rather than a reconstruction.
bool IsPredictionStudy(const Config& config);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTION_STUDY_READER_H_
