// Lists the files that the frames of a recording consist of, in the order of the frames.
#ifndef LACUNA_SCAN_FRAME_LIST_H_
#define LACUNA_SCAN_FRAME_LIST_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"

namespace lacuna {

// Reads either `files` (a list, or one text with the wildcards * and ?; other characters, and those
// of `data_folder`, stand for themselves) or `pattern`
// ("frames/points_%02d.csv") with `first` and `count`. Names that match wildcards are sorted by the
// numbers in them (scan_9 before scan_10); a gap in evenly spaced numbers (FindMissingNumber) means
// that a frame is missing. Throws InputError (file, line, column and field) when a frame is
// missing, when a file does not exist, and when both or neither of the two ways are used.
std::vector<std::filesystem::path> ReadFrameFiles(const Config& config,
                                                  const std::filesystem::path& data_folder);

// Arranges one file per frame as FileFrames::files.
std::vector<std::vector<std::filesystem::path>> OneFilePerFrame(
    const std::vector<std::filesystem::path>& files);

// Fills `number` into the one %d or %0Nd of `pattern`, in which another % stands for itself. Throws
// std::invalid_argument when there is not exactly one.
std::string FillPattern(const std::string& pattern, int number);

// Sorts names of files by the numbers in them: "a9" comes before "a10", and "a0.25" before "a0.5".
// Digits behind a point are decimals unless one of the names ends them with a zero: "a1.10" is the
// tenth of a count, behind "a1.9".
void SortNaturally(std::vector<std::string>* names);

// The number that is missing from names that differ in one evenly spaced number ("a1", "a2", "a4"
// → 3), or nothing when none is missing or the names are not of this form. Numbers are evenly
// spaced where at least half of their differences equal the smallest one and the others are
// multiples of it; times at which frames were taken usually are not.
std::optional<long> FindMissingNumber(const std::vector<std::string>& sorted_names);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_LIST_H_
