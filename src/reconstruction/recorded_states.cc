#include "reconstruction/recorded_states.h"

#include "core/interrupt.h"

namespace lacuna {

std::vector<FrameState> LoadFrameStates(const ReconstructionStudy& study, Progress* progress) {
  const FrameStateOptions options{study.filter, study.surface, study.surfaces_of_frames,
                                  study.validation.hold_out_every};
  std::vector<FrameState> states;
  progress->Begin("surfaces", static_cast<int64_t>(study.frames.size()));
  for (const int frame : study.frames) {
    ThrowIfInterrupted();
    states.push_back(MakeFrameState(study.recording, frame, options));
    progress->Report(static_cast<int64_t>(states.size()));
  }
  progress->End();
  return states;
}

ReferenceBody MakeReferenceBody(const ReconstructionStudy& study, const FrameState& first) {
  ReferenceRequest request{study.name,         study.recording,      study.mesh,
                           study.sheet_layers, study.frames.front(), &first.surface};
  if (study.follow.forces.region) request.regions.push_back(*study.follow.forces.region);
  return MakeReferenceBody(request);
}

bool FirstFrameIsReference(const ReconstructionStudy& study) {
  return study.recording.reference.source == ReferenceSource::kFirstFrame;
}

}  // namespace lacuna
