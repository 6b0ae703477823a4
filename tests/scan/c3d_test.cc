// C3D files of markers, in the number formats of all processors.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "scan/marker_files.h"
#include "scan/test_files.h"
#include "support/shared_data.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum Processor { kIntel = 84, kDec = 85, kMips = 86 };

// Writes C3D files in the number formats of the three kinds of processors.
class C3dWriter {
 public:
  explicit C3dWriter(Processor processor) : processor_(processor) {}

  void Byte(int value) { bytes_.push_back(static_cast<char>(value)); }
  void Word(int value) {
    const int low = value & 0xff, high = (value >> 8) & 0xff;
    Byte(processor_ == kMips ? high : low);
    Byte(processor_ == kMips ? low : high);
  }
  void Real(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(processor_ == kDec ? value * 4 : value);
    const int low = bits & 0xffff, high = bits >> 16;
    Word(processor_ == kIntel ? low : high);
    Word(processor_ == kIntel ? high : low);
  }
  void Text(const std::string& text) { bytes_ += text; }
  void PadTo(size_t size) { bytes_.resize(size, '\0'); }

  void Group(const std::string& name, int number) {
    Byte(static_cast<int>(name.size()));
    Byte(-number);
    Text(name);
    Word(3);
    Byte(0);
  }
  void Parameter(const std::string& name, int group, const std::string& body) {
    Byte(static_cast<int>(name.size()));
    Byte(group);
    Text(name);
    Word(static_cast<int>(body.size()) + 3);
    Text(body);
    Byte(0);
  }
  std::string Content() const { return bytes_; }

 private:
  Processor processor_;
  std::string bytes_;
};

// Two markers, three frames; the second marker is hidden in frame 1. Coordinates k·0.25.
std::string MakeC3d(Processor processor, bool integers) {
  constexpr float kScale = 0.25f;
  C3dWriter c3d(processor);
  c3d.Byte(2);  // parameters begin in block 2
  c3d.Byte(0x50);
  c3d.Word(2);  // points
  c3d.Word(1);  // analog values per frame
  c3d.Word(1);  // first frame
  c3d.Word(3);  // last
  c3d.Word(0);
  c3d.Real(integers ? kScale : -kScale);
  c3d.Word(3);  // data begin in block 3
  c3d.Word(1);
  c3d.Real(50.0f);
  c3d.PadTo(512);
  c3d.Byte(0), c3d.Byte(0), c3d.Byte(1), c3d.Byte(processor);
  c3d.Group("POINT", 1);
  const std::string labels = std::string("\xff\x02\x05\x02", 4) + "LEFT RIGHT";
  c3d.Parameter("LABELS", 1, labels);
  c3d.Parameter("UNITS", 1, std::string("\xff\x01\x02", 3) + "mm");
  c3d.PadTo(1024);
  for (int frame = 0; frame < 3; ++frame) {
    for (int marker = 0; marker < 2; ++marker) {
      const bool hidden = frame == 1 && marker == 1;
      for (int axis = 0; axis < 3; ++axis) {
        const int count = 100 * frame - 10 * marker + axis - 7;
        if (integers) {
          c3d.Word(count);
        } else {
          c3d.Real(kScale * count);
        }
      }
      if (integers) {
        c3d.Word(hidden ? -1 : 0);
      } else {
        c3d.Real(hidden ? -1.0f : 0.0f);
      }
    }
    if (integers) {
      c3d.Word(77);
    } else {
      c3d.Real(77.0f);  // the analog value
    }
  }
  c3d.PadTo(1536);
  return c3d.Content();
}

TEST(C3d, ReadsIntegersAndRealsOfEveryProcessor) {
  const TestFolder folder;
  for (const Processor processor : {kIntel, kDec, kMips}) {
    for (const bool integers : {true, false}) {
      const auto file = folder.Write("a.c3d", MakeC3d(processor, integers));
      const MarkerTracks tracks = ReadC3d(file);
      SCOPED_TRACE(testing::Message() << "processor " << processor << " integers " << integers);
      EXPECT_THAT(tracks.names, ElementsAre("LEFT", "RIGHT"));
      EXPECT_EQ(tracks.length_unit, "mm");
      ASSERT_EQ(tracks.positions.size(), 3u);
      EXPECT_DOUBLE_EQ(tracks.times[2], 0.04);
      for (int frame = 0; frame < 3; ++frame) {
        for (int marker = 0; marker < 2; ++marker) {
          const Eigen::Vector3d place = tracks.positions[frame].col(marker);
          if (frame == 1 && marker == 1) {
            EXPECT_TRUE(place.array().isNaN().all());
            continue;
          }
          const double first = 100 * frame - 10 * marker - 7;
          // Multiples of 1/4 are exact in every one of the formats.
          EXPECT_EQ(place, 0.25 * Eigen::Vector3d(first, first + 1, first + 2));
        }
      }
    }
  }
}

TEST(C3d, RefusesTruncatedAndForeignFiles) {
  const TestFolder folder;
  const std::string whole = MakeC3d(kIntel, false);
  const auto message = [&](const std::string& content) {
    const auto file = folder.Write("bad.c3d", content);
    return ErrorOf([&] { ReadC3d(file); });
  };
  EXPECT_THAT(message(whole.substr(0, 1024 + 40)), HasSubstr("bad.c3d: is truncated: it announces "
                                                             "3 frames and ends within frame 1"));
  EXPECT_THAT(message(whole.substr(0, 700)), HasSubstr("is truncated"));
  EXPECT_THAT(message(whole.substr(0, 100)), HasSubstr("is not a C3D file"));
  EXPECT_THAT(message(std::string(2000, 'x')), HasSubstr("is not a C3D file"));
  std::string foreign = whole;
  foreign[512 + 3] = 90;
  EXPECT_THAT(message(foreign), HasSubstr("unknown processor (90)"));
  // No corrupted byte of the header or the parameters may lead to a read outside the file.
  for (size_t at = 0; at < 640; ++at) {
    if (at == 24) at = 512;
    std::string damaged = whole;
    damaged[at] = static_cast<char>(0xff);
    message(damaged);
  }
}

TEST(C3d, NumbersLabelsThatRepeat) {
  const TestFolder folder;
  std::string content = MakeC3d(kIntel, true);
  content.replace(content.find("RIGHT"), 5, "LEFT ");
  const MarkerTracks tracks = ReadC3d(folder.Write("a.c3d", content));
  EXPECT_THAT(tracks.names, ElementsAre("LEFT", "LEFT (2)"));
  EXPECT_THAT(tracks.warnings, ElementsAre(HasSubstr("several markers are called LEFT")));
}

// Their extents announce 255·255·255 texts without letters.
TEST(C3d, LabelsWithoutLettersAreNumbered) {
  const TestFolder folder;
  std::string content = MakeC3d(kIntel, true);
  const std::string labels("\xff\x02\x05\x02", 4);
  content.replace(content.find(labels), 6, std::string("\xff\x04\x00\xff\xff\xff", 6));
  EXPECT_THAT(ReadC3d(folder.Write("a.c3d", content)).names, ElementsAre("point 1", "point 2"));
}

TEST(C3d, ReadsAsManyLabelsAsPoints) {
  const TestFolder folder;
  std::string content = MakeC3d(kIntel, true);
  const std::string labels("\xff\x02\x05\x02", 4);
  content.replace(content.find(labels), 4, std::string("\xff\x02\x05\xff", 4));  // 255 of them
  EXPECT_THAT(ReadC3d(folder.Write("a.c3d", content)).names, ElementsAre("LEFT", "RIGHT"));
}

TEST(C3d, GivesLabelsInUtf8) {
  const TestFolder folder;
  std::string content = MakeC3d(kIntel, true);
  content.replace(content.find("RIGHT"), 5,
                  "F\xfc\xdf"
                  "e ");  // Latin-1
  EXPECT_THAT(ReadC3d(folder.Write("a.c3d", content)).names, ElementsAre("LEFT", "Füße"));
}

// The file of MakeC3d with this rate in its header and, unless it is 0, this one in POINT:RATE.
std::string WithRates(float in_header, float in_parameter) {
  std::string content = MakeC3d(kIntel, true);
  C3dWriter header(kIntel), rate(kIntel), parameter(kIntel);
  header.Real(in_header);
  content.replace(20, 4, header.Content());
  rate.Byte(4), rate.Byte(0), rate.Real(in_parameter);
  parameter.Parameter("RATE", 1, rate.Content());
  if (in_parameter == 0) return content;
  const size_t at = content.find("UNITS") - 2;  // in front of the last parameter
  content.insert(at, parameter.Content());
  return content.erase(1024, parameter.Content().size());
}

TEST(C3d, TakesTheRateFromItsParametersWhereTheHeaderHasNone) {
  const TestFolder folder;
  const auto read = [&](float in_header, float in_parameter, FileTimes use) {
    return ReadC3d(folder.Write("a.c3d", WithRates(in_header, in_parameter)), use);
  };
  EXPECT_DOUBLE_EQ(read(0, 10, FileTimes::kUsed).times[2], 0.2);
  EXPECT_THAT(ErrorOf([&] { read(0, 0, FileTimes::kUsed); }),
              HasSubstr("a.c3d: has no frame rate; give `rate:"));
  EXPECT_EQ(read(0, 0, FileTimes::kReplaced).times.size(), 0);
  EXPECT_TRUE(read(50, 50, FileTimes::kUsed).warnings.empty());
  EXPECT_THAT(read(50, 10, FileTimes::kUsed).warnings,
              ElementsAre(HasSubstr("its header states 50 Hz and POINT:RATE 10 Hz")));
}

// Of a number of frames that is no number, the conversion to an integer would be undefined.
TEST(C3d, RefusesANumberOfFramesThatIsNoNumber) {
  const TestFolder folder;
  const float bad = std::numeric_limits<float>::quiet_NaN();
  for (const float frames : {bad, 1e30f, -3.0f}) {
    C3dWriter c3d(kIntel);
    c3d.Text(MakeC3d(kIntel, true).substr(0, 512 + 4));
    c3d.Group("POINT", 1);
    C3dWriter body(kIntel);
    body.Byte(4), body.Byte(0), body.Real(frames);
    c3d.Parameter("LONG_FRAMES", 1, body.Content());
    c3d.PadTo(1536);
    const auto file = folder.Write("a.c3d", c3d.Content());
    EXPECT_THAT(
        ErrorOf([&] { ReadC3d(file); }),
        HasSubstr("a.c3d: gives " + fmt::format("{}", frames) + " as its number of frames"));
  }
}

// Two markers in `frames` frames of integers, of which a 16-bit header announces `last`. The last
// frame is at (7, 7, 7) counts. With `has_trial` TRIAL:ACTUAL_END_FIELD has the true number.
std::string MakeLongC3d(int frames, int last, bool has_trial) {
  C3dWriter c3d(kIntel);
  c3d.Byte(2), c3d.Byte(0x50);
  c3d.Word(2), c3d.Word(0), c3d.Word(1), c3d.Word(last), c3d.Word(0);
  c3d.Real(1.0f);
  c3d.Word(3), c3d.Word(0);
  c3d.Real(100.0f);
  c3d.PadTo(512);
  c3d.Byte(0), c3d.Byte(0), c3d.Byte(1), c3d.Byte(kIntel);
  const auto words = [](int value) {
    return std::string("\x02\x01\x02", 3) + static_cast<char>(value & 0xff) +
           static_cast<char>(value >> 8 & 0xff) + static_cast<char>(value >> 16 & 0xff) + '\0';
  };
  if (has_trial) {
    c3d.Group("TRIAL", 1);
    c3d.Parameter("ACTUAL_START_FIELD", 1, words(1));
    c3d.Parameter("ACTUAL_END_FIELD", 1, words(frames));
  }
  c3d.PadTo(1024);
  std::string content = c3d.Content();
  content.resize(1024 + 16 * static_cast<size_t>(frames), '\0');
  for (const int at : {0, 2, 4}) content[content.size() - 16 + at] = 7;
  return content;
}

TEST(C3d, ReadsMoreFramesThanA16BitHeaderHolds) {
  const TestFolder folder;
  constexpr int kFrames = 70000;
  // Some programs stop at the largest number, others drop the higher bits.
  for (const int last : {65535, kFrames - 65536}) {
    const MarkerTracks tracks = ReadC3d(folder.Write("a.c3d", MakeLongC3d(kFrames, last, true)));
    ASSERT_EQ(tracks.positions.size(), size_t{kFrames}) << last;
    EXPECT_EQ(tracks.positions.back().col(0), Eigen::Vector3d(7, 7, 7));
    EXPECT_NEAR(tracks.times[kFrames - 1], 699.99, 1e-9);
    EXPECT_TRUE(tracks.warnings.empty());
  }
}

TEST(C3d, WarnsOfFramesThatNothingAnnounces) {
  const TestFolder folder;
  const MarkerTracks tracks = ReadC3d(folder.Write("a.c3d", MakeLongC3d(70000, 65535, false)));
  EXPECT_EQ(tracks.positions.size(), 65535u);
  EXPECT_THAT(tracks.warnings,
              ElementsAre(HasSubstr("the file has room for 70000 frames; 65535 are "
                                    "read")));
  EXPECT_TRUE(ReadC3d(folder.Write("b.c3d", MakeLongC3d(65535, 65535, false))).warnings.empty());
  const MarkerTracks cut = ReadC3d(folder.Write("c.c3d", MakeLongC3d(300, 200, false)));
  EXPECT_EQ(cut.positions.size(), 200u);
  EXPECT_THAT(cut.warnings, ElementsAre(HasSubstr("the header announces 200 frames, but the file "
                                                  "has room for 300 frames; 200 are read")));
}

TEST(C3d, AShorterRecordingDoesNotFollowTheFieldsOfItsTrial) {
  const TestFolder folder;
  const std::string cut = MakeLongC3d(300, 200, true);  // the trial says 300
  EXPECT_EQ(ReadC3d(folder.Write("a.c3d", cut.substr(0, 1024 + 16 * 200))).positions.size(), 200u);
}

TEST(C3d, ReadsTheRecordingOfTheSiliconeBeamLikeItsCsv) {
  const auto folder = SharedData() / "silicone_beam";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped, data absent";
  const MarkerTracks lab = ReadC3d(folder / "beam_gravity_V2_a.c3d");
  MarkerColumns columns;
  columns.time = "t_s";
  const MarkerTracks beam = ReadMarkerCsv(folder / "beam_gravity_V2_a.csv", columns);
  ASSERT_EQ(lab.names.size(), 6u);
  ASSERT_EQ(lab.positions.size(), 500u);
  ASSERT_EQ(beam.positions.size(), 500u);
  EXPECT_EQ(lab.length_unit, "m");
  EXPECT_NEAR(lab.times[499], beam.times[499], 1e-6);
  // The frames differ by a rigid motion, so the distances between markers agree; the CSV is
  // rounded to a micrometre in each coordinate.
  double largest = 0;
  for (size_t frame = 0; frame < 500; ++frame) {
    std::vector<double> left, right;
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < a; ++b) {
        left.push_back((lab.positions[frame].col(a) - lab.positions[frame].col(b)).norm());
        right.push_back((beam.positions[frame].col(a) - beam.positions[frame].col(b)).norm());
      }
    }
    std::sort(left.begin(), left.end()), std::sort(right.begin(), right.end());
    for (size_t i = 0; i < left.size(); ++i) {
      largest = std::max(largest, std::abs(left[i] - right[i]));
    }
  }
  EXPECT_LT(largest, 2e-6);
}

}  // namespace
}  // namespace lacuna
