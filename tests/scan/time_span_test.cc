#include "scan/time_span.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// The doubt about a ramp that starts at `begin` and ends at `end`, for a recording of 0 s to 0.5 s.
std::string OfRamp(double begin, double end) {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, 51);
  values.row(2).setLinSpaced(0, 1);
  return DoubtOfTimeSpan(Eigen::VectorXd::LinSpaced(51, begin, end), values, 0, 0.5);
}

TEST(TimeSpan, NamesTheLikelyUnit) {
  EXPECT_THAT(OfRamp(0, 490), HasSubstr("its times are 0 s to 490 s, those of the recording 0 s to "
                                        "0.5 s, in which it changes by 0.1 % of its range; they "
                                        "would fit divided by 1000 (milliseconds, not seconds?)"));
  EXPECT_THAT(OfRamp(0, 5.2e5), HasSubstr("microseconds"));
  EXPECT_THAT(OfRamp(0, 0.0005), HasSubstr("multiplied by 1000 (seconds, not milliseconds?)"));
  EXPECT_THAT(OfRamp(1000, 1000.5), HasSubstr("check their unit and their origin"));
}

TEST(TimeSpan, DoesNotDoubtASeriesThatCoversTheRecording) {
  EXPECT_EQ(OfRamp(0, 0.5), "");
  EXPECT_EQ(OfRamp(-0.2, 1), "");
  EXPECT_EQ(OfRamp(0.1, 0.3), "") << "a pulse";
  EXPECT_EQ(OfRamp(0.1, 0.104), "") << "a knock of a few milliseconds";
  const Eigen::Matrix3Xd constant = Eigen::Matrix3Xd::Ones(3, 2);
  EXPECT_EQ(DoubtOfTimeSpan(Eigen::Vector2d(0, 1), constant, 0, 0.5), "");
}

// The last of 50 frames at 30 Hz is at 1.6333… s, which a table gives with five decimals.
TEST(TimeSpan, OfASeriesMayBeRounded) {
  std::vector<double> frames;
  for (int k = 0; k < 50; ++k) frames.push_back(k / 30.0);
  const double margin = TimeMargin(frames), last = frames.back();
  EXPECT_NEAR(margin, 1e-3 / 30, 1e-15);
  EXPECT_TRUE(CoversTimes(Eigen::Vector2d(0, 1.63333), 0, last, margin));
  EXPECT_TRUE(CoversTimes(Eigen::Vector2d(0.00003, 2), 0, last, margin));
  EXPECT_FALSE(CoversTimes(Eigen::Vector2d(0, 1.633), 0, last, margin));
  EXPECT_FALSE(CoversTimes(Eigen::Vector2d(0.001, 2), 0, last, margin));
  EXPECT_GT(TimeMargin({1e3}), 0) << "one frame has no interval";
}

// A margin of a billionth of the time would be 1.7 s.
TEST(TimeSpan, OfClocksThatCountFrom1970IsCheckedAsFinely) {
  constexpr double kEpoch = 1.7e9;
  std::vector<double> frames;
  for (int k = 0; k < 19; ++k) frames.push_back(kEpoch + 0.1 * k);
  const double margin = TimeMargin(frames), first = frames.front(), last = frames.back();
  EXPECT_TRUE(CoversTimes(Eigen::Vector2d(first, last), first, last, margin));
  EXPECT_FALSE(CoversTimes(Eigen::Vector2d(first, kEpoch + 1.15), first, last, margin));
  EXPECT_THAT(
      DoubtOfTimeSpan(Eigen::Vector2d(kEpoch, kEpoch + 20), Eigen::RowVector2d(0, 1), first, last),
      HasSubstr("its times are 1700000000 s to 1700000020 s, those of the recording "
                "1700000000 s to 1700000001.8 s"));
}

}  // namespace
}  // namespace lacuna
