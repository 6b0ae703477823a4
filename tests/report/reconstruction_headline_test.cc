#include "report/reconstruction_headline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ReconstructionHeadline, DoesNotJudgePhysics) {
  RunRecord record;
  record.object_size = 0.1;
  record.relative_animation_residual = 0.004;
  record.frames.resize(3);
  record.frames[0].solver.usable = record.frames[1].solver.usable = true;
  const std::vector<std::string> sentences = ReconstructionHeadline(record);
  EXPECT_THAT(sentences.at(0), HasSubstr("follows 2 of 3 frames; its points are 0.400 mm "
                                         "from their measured places on average"));
  EXPECT_THAT(sentences.at(1), HasSubstr("says nothing about which physics"));
  record.relative_animation_residual = kNotMeasured;
  EXPECT_THAT(ReconstructionHeadline(record).at(0),
              HasSubstr("follows 2 of 3 frames; how far its points are from their measured places "
                        "is not known"));
  record.frames.clear();
  EXPECT_THAT(ReconstructionHeadline(record).at(0), HasSubstr("could not follow any of 0 frames"));
}

TEST(ReconstructionHeadline, CountsAllFramesAndNamesItsForces) {
  RunRecord record;
  record.frames.resize(2);
  record.frames[0].solver.usable = true;
  record.frames_not_tried = 17;
  EXPECT_THAT(ReconstructionHeadline(record).at(0),
              HasSubstr("With fitted forces the model follows 1 of 19 frames"));
  record.forces = RunForces::kKnown;
  EXPECT_THAT(ReconstructionHeadline(record),
              ElementsAre(HasSubstr("Under the recorded loads the model follows")));
  record.forces = RunForces::kNone;
  EXPECT_THAT(ReconstructionHeadline(record),
              ElementsAre(HasSubstr("Without fitted or recorded forces the model follows")));
  record.frames[0].solver.usable = false;
  EXPECT_THAT(ReconstructionHeadline(record).at(0), HasSubstr("could not follow any of 19 frames"));
}

}  // namespace
}  // namespace lacuna
