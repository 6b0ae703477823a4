#include "diagnosis/recording_power.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

TEST(RecordingPower, SaysWhatTheRecordingsCouldTell) {
  const SyntheticSpace alike(0.05);
  const DecisionInput input =
      InputOf(alike, SyntheticSpace::Noise(17) - 8 * alike.Of("drag") - 10 * alike.Of("fibres"));
  const std::vector<RecordedPower> power = SimulatePower(input, {"drag", "fibres"});
  ASSERT_EQ(power.size(), 3u);
  for (const RecordedPower& one : power)
    EXPECT_NEAR(one.named + one.wrong_member + one.wrong + one.open + one.unknown, 1, 1e-9);
  EXPECT_GT(power[0].named, 0.9);  // nothing
  EXPECT_GT(power[1].open, 0.7);   // drag, or mass damping
  EXPECT_GT(power[2].named, 0.9);  // fibres
  const std::vector<RecordedSeparation> separations =
      Separations(input, {"drag", "mass_damping", "fibres"});
  ASSERT_EQ(separations.size(), 3u);
  EXPECT_LT(separations[0].lambda, 1);
  EXPECT_GT(separations[1].lambda, 12);  // separable in four cases of five
}

// Of an effect that the catalogue lacks it is right to say that something unknown is left.
TEST(RecordingPower, SaysWhetherAnEffectOutsideTheCatalogueWouldBeSeen) {
  const SyntheticSpace synthetic;
  const DecisionInput drag =
      InputOf(synthetic, SyntheticSpace::Noise(17) - 12 * synthetic.Of("drag"));
  const std::optional<RecordedPower> known = PowerToFind(drag, "drag", true);
  ASSERT_TRUE(known);
  EXPECT_GT(known->named, 0.6);
  // Mass damping takes its place.
  const std::optional<RecordedPower> unknown = PowerToFind(drag, "drag", false);
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->named, 0);
  EXPECT_EQ(unknown->most_wrong, "mass_damping");
  EXPECT_GT(unknown->wrong_member, 0.5);
  EXPECT_FALSE(PowerToFind(drag, "pressure", true));  // has no columns
  // Nothing can take the place of fibres.
  const DecisionInput fibres =
      InputOf(synthetic, SyntheticSpace::Noise(17) - 20 * synthetic.Of("fibres"));
  const std::optional<RecordedPower> seen = PowerToFind(fibres, "fibres", false);
  ASSERT_TRUE(seen);
  EXPECT_GT(seen->unknown, 0.8);
}

}  // namespace
}  // namespace lacuna
