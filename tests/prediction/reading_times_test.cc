#include "prediction/reading_times.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(ReadingTimes, AreThoseOfFramesAndOfLateCells) {
  const std::vector<double> frames = {1, 2, 3};
  // The first cell has no delay; the second is late by 1.5, the third early by 1.
  const std::vector<ReadingTime> times =
      ReadingTimesOf(frames, {{}, Delayed(frames, 1.5), Delayed(frames, -1)});
  EXPECT_THAT(TimesOf(times), ElementsAre(-0.5, 0.5, 1, 1.5, 2, 2, 3, 3, 4));
  EXPECT_FALSE(times[0].shows_frame);
  EXPECT_EQ(times[0].frame, 0u);
  EXPECT_THAT(times[0].cells, ElementsAre(1u));
  EXPECT_TRUE(times[2].shows_frame);
  EXPECT_THAT(times[2].cells, ElementsAre(0u));
  // At equal times the frame comes first.
  EXPECT_TRUE(times[4].shows_frame);
  EXPECT_EQ(times[4].frame, 1u);
  EXPECT_FALSE(times[5].shows_frame);
  EXPECT_EQ(times[5].frame, 0u);
  EXPECT_THAT(times[5].cells, ElementsAre(2u));
  EXPECT_THAT(ReadingTimesOf({}, {{}}), IsEmpty());
}

}  // namespace
}  // namespace lacuna
