// Reads one entry of a prediction study's `recordings`.
#ifndef LACUNA_PREDICTION_PREDICTED_RECORDING_READER_H_
#define LACUNA_PREDICTION_PREDICTED_RECORDING_READER_H_

#include "core/config.h"
#include "experiment/scan_settings.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// Loads the recording that the entry names and checks that a prediction can be compared with it.
// `of_study`: the effects that act in all recordings, the material first. `defines_body_shape` is
// true for the first recording of the study, whose reference shape is meshed. Throws InputError
// with the position of the entry's key.
PredictedRecording ReadRecordingEntry(const Config& config, const EffectList& of_study,
                                      const ScanSettings& scan, TimeScheme scheme,
                                      bool defines_body_shape);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTED_RECORDING_READER_H_
