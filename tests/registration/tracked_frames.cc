#include "registration/tracked_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "core/error.h"
#include "support/shared_data.h"

namespace lacuna {

namespace fs = std::filesystem;

fs::path RubberStripFrames() { return SharedData() / "rubber_strip" / "frames"; }

Eigen::Matrix3Xd ReadTrackedFrame(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError({file.string()}, "cannot be read");
  constexpr double kMillimetre = 1e-3;
  std::vector<double> numbers;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    const char* at = line.c_str();
    for (int axis = 0; axis < 3; ++axis) {
      char* rest = nullptr;
      numbers.push_back(kMillimetre * std::strtod(at, &rest));
      if (rest == at) throw InputError({file.string()}, "a line without three numbers");
      at = *rest == ',' ? rest + 1 : rest;
    }
  }
  return Eigen::Map<Eigen::Matrix3Xd>(numbers.data(), 3, numbers.size() / 3);
}

TrackedPair MakeTrackedPair(const Eigen::Matrix3Xd& first, const Eigen::Matrix3Xd& second,
                            int hold_out_every) {
  TrackedPair pair;
  std::vector<int> held_out;
  for (int row = 0; row < first.cols(); ++row) {
    const bool in_first = first.col(row).allFinite(), in_second = second.col(row).allFinite();
    if (hold_out_every > 0 && row % hold_out_every == hold_out_every - 1) {
      if (in_first && in_second) held_out.push_back(row);
      continue;
    }
    if (in_first) pair.source_row.push_back(row);
    if (in_second) pair.target_row.push_back(row);
  }
  pair.source.points = first(Eigen::all, pair.source_row);
  pair.target.points = second(Eigen::all, pair.target_row);
  pair.held_out = first(Eigen::all, held_out);
  pair.held_out_target = second(Eigen::all, held_out);
  return pair;
}

CorrespondenceError ErrorOf(const TrackedPair& pair, const Eigen::Matrix3Xd& displaced) {
  CorrespondenceError error;
  double squared = 0.0;
  int count = 0;
  for (size_t i = 0; i < pair.source_row.size(); ++i) {
    const auto own =
        std::lower_bound(pair.target_row.begin(), pair.target_row.end(), pair.source_row[i]);
    if (own == pair.target_row.end() || *own != pair.source_row[i]) continue;
    const Eigen::RowVectorXd distances =
        (pair.target.points.colwise() - displaced.col(i)).colwise().squaredNorm();
    const auto partner = own - pair.target_row.begin();
    squared += distances[partner];
    ++count;
    // The negated comparison also catches NaN.
    if (!(distances[partner] <= distances.minCoeff())) ++error.mistaken;
  }
  error.rms = std::sqrt(squared / std::max(1, count));
  return error;
}

}  // namespace lacuna
