#include "prediction/predicted_body.h"

#include "experiment/frame_states.h"

namespace lacuna {

ReferenceBody MakeReferenceBody(const PredictionStudy& study) {
  const PredictedRecording& first = study.recordings.front();
  ReferenceRequest request{study.name, first.recording, study.mesh, study.sheet_layers,
                           first.frames.front()};
  FrameState state;
  if (first.recording.reference.source == ReferenceSource::kFirstFrame) {
    state = MakeFrameState(first.recording, request.first_frame,
                           {study.scan.filter, study.scan.surface});
    request.first_surface = &state.surface;
  }
  return MakeReferenceBody(request);
}

}  // namespace lacuna
