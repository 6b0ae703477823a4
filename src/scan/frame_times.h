// When the frames of a recording were taken, and which of them are used.
#ifndef LACUNA_SCAN_FRAME_TIMES_H_
#define LACUNA_SCAN_FRAME_TIMES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"

namespace lacuna {

struct FrameTimes {
  std::vector<double> in_files;          // s, ascending, one for each frame of the files
  std::vector<int> chosen;               // the frames that are used, numbered from 0, ascending
  std::filesystem::path file;            // file of the times; empty if there is none
  std::vector<double> OfChosen() const;  // s, ascending
};

// Reads the times of `count` frames from one of `rate`, `times` and `times_file` of the mapping
// `frames`, which override `file_times`, the times that the frame files themselves contain (s;
// empty when they have none). Of the frames with `from` ≤ time ≤ `to` it chooses every
// `every`-th. A single frame needs no time. Throws InputError (file, line, column and field) when
// there are no times or more than one source of them, when their number is not `count`, when they
// do not ascend, and when no frame is chosen. Appends to `warnings` where the times that are given
// and those of the files have different lengths (RatesDiffer).
FrameTimes ReadFrameTimes(const Config& frames, size_t count, const std::vector<double>& file_times,
                          const DataLocation& data, std::vector<std::string>* warnings);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_TIMES_H_
