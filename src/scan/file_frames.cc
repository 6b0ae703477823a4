#include "scan/file_frames.h"

#include <fmt/format.h>

#include <utility>

#include "scan/similarity.h"

namespace lacuna {

void ReadObjectChoice(const Config& frames, const DataLocation& data, FileFrames* source) {
  if (const auto crop = frames.OptionalChild("crop")) {
    source->crop = ReadRegion(*crop, data.folder, "crop");
    if (std::holds_alternative<NodeRegion>(source->crop->shape))
      frames.Fail("crop", "expected box, sphere or half_space");
  }
  source->keep_largest = frames.Flag("keep_largest", false);
}

void KeepFrames(const std::vector<int>& chosen, FileFrames* source) {
  std::vector<std::vector<std::filesystem::path>> kept;
  for (const int i : chosen) kept.push_back(source->files[i]);
  source->files = std::move(kept);
}

std::vector<std::filesystem::path> AllFiles(const FileFrames& source) {
  std::vector<std::filesystem::path> files;
  for (const auto& frame : source.files) files.insert(files.end(), frame.begin(), frame.end());
  return files;
}

std::string ExplainSize(const FileFrames&, double size, const std::string& length_unit) {
  std::string hint;
  for (const std::string unit : {"m", "cm", "mm", "um"}) {
    const double other = size / LengthOf(length_unit) * LengthOf(unit);
    if (other >= 5 * kSmallestObject && other <= kLargestObject / 5) {
      hint += fmt::format("{} {:.3g} m with length_unit: {}",
                          hint.empty() ? "; it would be" : " or", other, unit);
    }
  }
  return fmt::format(" with length_unit: {}{}", length_unit, hint);
}

}  // namespace lacuna
