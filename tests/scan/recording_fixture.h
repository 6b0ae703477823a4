// Recordings that a test writes and reads.
#ifndef LACUNA_TESTS_SCAN_RECORDING_FIXTURE_H_
#define LACUNA_TESTS_SCAN_RECORDING_FIXTURE_H_

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "scan/recording.h"
#include "scan/test_files.h"

namespace lacuna {

// A cloud of `rows` points of a 100 × 50 × 20 (units of the file) body, one per line.
inline std::string Cloud(int rows, double shift = 0) {
  std::ostringstream text;
  for (int i = 0; i < rows; ++i) {
    text << i * 100.0 / (rows - 1) + shift << ',' << (i * 7 % 11) * 5 << ',' << (i * 5 % 3) * 10
         << '\n';
  }
  return text.str();
}

inline std::string Yaml(const std::string& frames, const std::string& rest = "",
                        const std::string& unit = "mm") {
  return "schema_version: 1\nname: bar\nlength_unit: " + unit + "\n" + rest + "frames:\n" + frames;
}

class RecordingTest : public testing::Test {
 protected:
  // A recording of `count` clouds and whatever else the YAML tells.
  void WriteClouds(int count, int rows = 12) const {
    for (int i = 0; i < count; ++i) {
      folder_.Write("f/p" + std::to_string(i) + ".csv", "x,y,z\n" + Cloud(rows, i));
    }
  }
  Recording Load(const std::string& yaml) const {
    return LoadRecording(folder_.Write("recording.yaml", yaml));
  }
  std::string LoadError(const std::string& yaml) const {
    return ErrorOf([&] { Load(yaml); });
  }

  TestFolder folder_;
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_SCAN_RECORDING_FIXTURE_H_
