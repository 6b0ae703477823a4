#include "paper/reduced_bend.h"

#include <utility>

#include "reconstruction/reconstruction_study.h"
#include "reconstruction/recorded_states.h"
#include "support/silent_progress.h"

namespace lacuna {

std::filesystem::path ReducedBendRecording() {
  return std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend";
}

std::unique_ptr<const Table1Scans> ReducedBendTest::scans_;

void ReducedBendTest::SetUpTestSuite() {
  SilentProgress progress;
  Table1Scans scans{ReadReconstruction(Config::Parse(kReducedBend, "reduced.yaml"),
                                       LoadRecording(ReducedBendRecording())),
                    {},
                    {}};
  scans.states = LoadFrameStates(scans.study, &progress);
  scans.tracked = TrackFrames(scans.study, scans.states, &progress);
  scans_ = std::make_unique<const Table1Scans>(std::move(scans));
}

ParameterObjective ReducedBendTest::Problem(const ReconstructionStudy& study) {
  return {study, Scans().states, Scans().tracked};
}

}  // namespace lacuna
