// What the tests share that fit the held bar (support/held_bar.h) or predict a second recording of
// it.
#ifndef LACUNA_TESTS_CALIBRATION_HELD_BAR_FIT_H_
#define LACUNA_TESTS_CALIBRATION_HELD_BAR_FIT_H_

#include <map>
#include <string>

#include "support/held_bar.h"

namespace lacuna {

// Coarser than the mesh that was filmed.
inline TetMesh StudyMesh() { return BarMesh({7, 2, 2}, 2); }

// For ReadBarStudy(): adds the recording in <folder>/other, of a bar that was held at the same end,
// before the one in <folder>. `settings`: lines of the entry, such as "    fitted: false\n".
inline std::map<std::string, std::string> WithOtherRecording(const std::string& settings) {
  return {{"recordings:\n",
           "recordings:\n  - recording: other/recording.yaml\n    name: other\n" + settings +
               "    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: "
               "[1, 0, 0]}}\n      release: 0.0437 s\n"}};
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_CALIBRATION_HELD_BAR_FIT_H_
