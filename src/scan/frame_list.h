// Which files make up the frames of a recording, in their order.
#ifndef LACUNA_SCAN_FRAME_LIST_H_
#define LACUNA_SCAN_FRAME_LIST_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"

namespace lacuna {

// Reads either `files` (a list, or one text with the wildcards * and ?) or `pattern` with `first`
// and `count` ("frames/points_%02d.csv"). Wildcards are sorted by the numbers in the names
// (scan_9 before scan_10); a gap in evenly spaced numbers is a missing frame. Throws InputError
// when a file is absent, naming file and frame.
std::vector<std::filesystem::path> ReadFrameFiles(const Config& config,
                                                  const std::filesystem::path& data_folder);

// `pattern` with its one %d, %0Nd filled in. Throws std::invalid_argument when it has not one.
std::string FillPattern(const std::string& pattern, int number);

// Orders texts with runs of digits compared as numbers: "a9" before "a10".
bool NaturalLess(const std::string& a, const std::string& b);

// The number missing from names that differ in one evenly stepped number ("a1", "a2", "a4" → 3).
std::optional<long> FindMissingNumber(const std::vector<std::string>& sorted_names);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_LIST_H_
