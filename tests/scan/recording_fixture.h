// A fixture for tests that write a recording and read it.
#ifndef LACUNA_TESTS_SCAN_RECORDING_FIXTURE_H_
#define LACUNA_TESTS_SCAN_RECORDING_FIXTURE_H_

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "scan/recording.h"
#include "scan/test_files.h"

namespace lacuna {

// The lines of a table with `rows` points of a body that measures 100 × 50 × 20 in units of the
// file.
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
  // Writes `count` point clouds as f/p0.csv, f/p1.csv, …
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
