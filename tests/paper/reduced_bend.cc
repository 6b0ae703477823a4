#include "paper/reduced_bend.h"

#include <filesystem>

#include "reconstruction/reconstruction_study.h"
#include "reconstruction/recorded_states.h"
#include "support/silent_progress.h"

namespace lacuna {

Table1Scans LoadReducedBend() {
  SilentProgress progress;
  const std::filesystem::path bend =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend";
  Table1Scans scans{
      ReadReconstruction(Config::Parse(kReducedBend, "reduced.yaml"), LoadRecording(bend)), {}, {}};
  scans.states = LoadFrameStates(scans.study, &progress);
  scans.tracked = TrackFrames(scans.study, scans.states, &progress);
  return scans;
}

}  // namespace lacuna
