#include "diagnosis/single_frame_columns.h"

#include <fmt/format.h>

namespace lacuna {

std::string WhyTooLarge(Eigen::Index rows, Eigen::Index columns) {
  constexpr double kGigabytes = sizeof(double) / 1e9;  // of an entry
  const double entries = static_cast<double>(rows) * static_cast<double>(columns);
  if (entries <= kMostSingleFrameEntries) return "";
  return fmt::format(
      "the columns for the single frames of all recordings would need {:.1f} GB of memory, more "
      "than the {:.1f} GB that are allowed: thin the frames out with `every`",
      entries * kGigabytes, kMostSingleFrameEntries * kGigabytes);
}

}  // namespace lacuna
