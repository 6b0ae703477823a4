#include "reconstruction/recorded_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(RecordedStates, NotesThatDifferInTheirNumbersAreOneWarning) {
  ReconstructionStudy study;
  study.frames = {3, 4, 7};
  study.recording.warnings = {"a doubt about the first frame's file"};
  std::vector<FrameState> states(3);
  states[0].notes = {"the surface: removed 2 slivers", "a doubt about the first frame's file"};
  states[1].notes = {"which side is outside is uncertain"};
  states[2].notes = {"the surface: removed 15 slivers", "the surface: removed 1 slivers"};
  EXPECT_THAT(WarningsOfStates(study, states),
              testing::ElementsAre("frame 3: the surface: removed 2 slivers; so has frame 7",
                                   "frame 4: which side is outside is uncertain"));
}

TEST(RecordedStates, NumbersMayHaveSignsFractionsAndExponents) {
  ReconstructionStudy study;
  study.frames = {0, 5, 10};
  std::vector<FrameState> states(3);
  states[0].notes = {"a hole at (-0.01, 0.2, 1e-05)"};
  states[1].notes = {"a hole at (0.01, 0, 0.3)"};
  states[2].notes = {"a hole at (0, -1e+03, 2.)"};
  EXPECT_THAT(WarningsOfStates(study, states),
              testing::ElementsAre("frame 0: a hole at (-0.01, 0.2, 1e-05); 2 other frames have "
                                   "such a note, up to frame 10"));
}

}  // namespace
}  // namespace lacuna
