// The undeformed body of a prediction study.
#ifndef LACUNA_PREDICTION_PREDICTED_BODY_H_
#define LACUNA_PREDICTION_PREDICTED_BODY_H_

#include "experiment/reference_body.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// Makes it from the reference shape of the first recording or, where that shape is a scan, from the
// first frame that the study uses. Throws InputError when the shape cannot be meshed.
ReferenceBody MakeReferenceBody(const PredictionStudy& study);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTED_BODY_H_
