#include "plan/protocol_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "plan/planned_bar.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

class ProtocolReader : public ::testing::Test {
 protected:
  ProtocolFile Read(const std::string& text) const {
    return ReadProtocols(Config::Parse(text, "protocols.yaml"), bar_.study);
  }
  std::string ErrorOf(const std::string& text) const {
    try {
      Read(text);
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "";
  }

  PlannedBar bar_;
};

TEST_F(ProtocolReader, ReadsEveryKey) {
  const ProtocolFile file = Read(R"(schema_version: 1
stock: false
protocols:
  - name: sideways
    duration: 2
    pull: 1.5
    turn: {axis: [0, 2, 0], angle: 90 deg}
    shake: {amplitude: [0, 5 mm, 0], frequency: 8 Hz}
    weight: {mass: 5 g, place: [70 mm, 0, 0], radius: 4 mm}
    more_markers: 8
  - {name: again}
)");
  EXPECT_FALSE(file.stock);
  ASSERT_EQ(file.protocols.size(), 2u);
  const Protocol& protocol = file.protocols[0];
  EXPECT_EQ(protocol.recording, bar_.Name());
  EXPECT_EQ(protocol.duration, 2);
  EXPECT_EQ(protocol.pull, 1.5);
  EXPECT_TRUE(protocol.turn.isApprox(0.5 * std::numbers::pi * Eigen::Vector3d::UnitY()));
  ASSERT_TRUE(protocol.shake && protocol.weight);
  EXPECT_NEAR(protocol.shake->amplitude.y(), 0.005, 1e-12);
  EXPECT_NEAR(protocol.shake->frequency, 8, 1e-12);
  EXPECT_NEAR(protocol.weight->mass, 0.005, 1e-12);
  EXPECT_EQ(protocol.more_markers, 8);
  EXPECT_THAT(DescribeProtocol(protocol), HasSubstr("clamp turned by 90° about y"));
  EXPECT_THAT(DescribeProtocol(file.protocols[1]), HasSubstr("once more"));
}

TEST_F(ProtocolReader, NamesWhatIsWrongAndWhere) {
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols: []\n"), HasSubstr("protocols.yaml:2"));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a, pul: 2}\n"), HasSubstr("pul"));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a}\n  - {name: a}\n"),
              HasSubstr("protocols[1].name: \"a\" is already the name of another"));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a, recording: baa}\n"),
              HasSubstr("has no recording \"baa\""));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a, recording: baa}\n"),
              HasSubstr("its recordings: " + bar_.Name()));
  EXPECT_THAT(ErrorOf("schema_version: 1\n"), HasSubstr("protocols: is absent"));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a b}\n  - {name: a_b}\n"),
              HasSubstr("protocols[1].name: \"a_b\" would have the same folder, a_b, as \"a b\""));
  const auto turned_by = [](const std::string& angle) {
    return "schema_version: 1\nprotocols:\n  - {name: a, turn: {axis: [0, 0, 1], angle: " + angle +
           "}}\n";
  };
  EXPECT_EQ(ErrorOf(turned_by("-180 deg")), "");
  EXPECT_THAT(ErrorOf(turned_by("190 deg")), HasSubstr("from -180 deg to 180 deg"));
  EXPECT_THAT(ErrorOf("schema_version: 1\nprotocols:\n  - {name: a, pull: 0}\n"),
              HasSubstr("pull"));
  EXPECT_THAT(
      ErrorOf(
          "schema_version: 1\nprotocols:\n  - {name: a, turn: {axis: [0, 0, 0], angle: 1 deg}}\n"),
      HasSubstr("axis"));
}

// Frames every 10 ms show at most 50 Hz, and steps of 5 ms follow at most 33.3 Hz.
TEST_F(ProtocolReader, RefusesAShakingThatCannotBeSeenOrSimulated) {
  const auto with = [](const std::string& amplitude, const std::string& frequency) {
    return "schema_version: 1\nprotocols:\n  - {name: a, shake: {amplitude: " + amplitude +
           ", frequency: " + frequency + "}}\n";
  };
  EXPECT_EQ(ErrorOf(with("[0, 5 mm, 0]", "49 Hz")), "");
  EXPECT_THAT(ErrorOf(with("[0, 5 mm, 0]", "51 Hz")),
              HasSubstr("shake.frequency: at most 50 Hz can be resolved"));
  EXPECT_THAT(ErrorOf(with("[0, 0, 0]", "8 Hz")), HasSubstr("shake.amplitude: expected"));
  bar_.study.time_step = 0.005;
  EXPECT_EQ(ErrorOf(with("[0, 5 mm, 0]", "33 Hz")), "");
  EXPECT_THAT(ErrorOf(with("[0, 5 mm, 0]", "49 Hz")),
              HasSubstr("shake.frequency: at most 33.3 Hz can be resolved"));
  // The stock protocols keep to that, too: four periods in 0.2 s are 19.4 Hz.
  bar_.study.time_step = 0.0125;
  for (const Protocol& protocol : StockProtocols(bar_.study, bar_.mesh))
    if (protocol.shake) {
      EXPECT_NEAR(protocol.shake->frequency, 1 / (6 * 0.0125), 1e-9);
    }
}

TEST_F(ProtocolReader, StockSuitsTheRecording) {
  const std::vector<Protocol> stock = StockProtocols(bar_.study, bar_.mesh);
  for (const char* name : {"repeat", "longer", "pull twice", "turn about y", "shake along z",
                           "added mass", "more markers"})
    EXPECT_THAT(stock, Contains(Field(&Protocol::name, name)));
  // A turn about the vertical changes nothing.
  EXPECT_THAT(stock, ::testing::Not(Contains(Field(&Protocol::name, "turn about z"))));
  PredictionStudy loose = bar_.study;
  loose.recordings[0].hold.reset();
  loose.recordings[0].recording.object.fixed.clear();
  for (const Protocol& protocol : StockProtocols(loose, bar_.mesh)) {
    EXPECT_EQ(protocol.pull, 1) << protocol.name;
    EXPECT_TRUE(protocol.turn.isZero(0) && !protocol.shake) << protocol.name;
  }
}

}  // namespace
}  // namespace lacuna
