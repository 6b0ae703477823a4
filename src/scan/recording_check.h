// What an examination of all frames of a recording finds, beyond the first frame.
#ifndef LACUNA_SCAN_RECORDING_CHECK_H_
#define LACUNA_SCAN_RECORDING_CHECK_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "scan/recording.h"

namespace lacuna {

// Sentences about frames that repeat the one before exactly, about frames whose size differs from
// that of frame 0 by a factor of 50, about small components beside the object in scans and meshes,
// about points that repeat within later frames, about tables of loads and paths whose first line is
// doubtful, and about held or loaded regions beside the bounding box of the reference shape. Reads
// the frames one after the other until `most_points` rows have been read, and says if it stopped
// there. Each frame that is read is given to `also`, for examinations that need more than this
// module. Throws InputError when a frame cannot be read, and Interrupted.
std::vector<std::string> ExamineFrames(const Recording& recording,
                                       int64_t most_points = std::numeric_limits<int64_t>::max(),
                                       const std::function<void(const Frame&)>& also = {});

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDING_CHECK_H_
