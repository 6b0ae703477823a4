#include "trials/trial_load_cell.h"

#include <glog/logging.h>

#include "prediction/reading_times.h"

namespace lacuna {
namespace {

// Streams of Gauss(). That of the noise is followed by those of further recordings.
constexpr uint64_t kNoise = 50, kTare = 58, kDelay = 59;

}  // namespace

Eigen::Vector3d CellTare(const TrialCase& trial, int recording) {
  CHECK(trial.load_cell.has_value());
  const uint64_t r = static_cast<uint64_t>(recording);
  return trial.load_cell->tare_deviation * Eigen::Vector3d(Gauss(trial, kTare, r, 0),
                                                           Gauss(trial, kTare, r, 1),
                                                           Gauss(trial, kTare, r, 2));
}

double CellDelay(const TrialCase& trial, int recording) {
  CHECK(trial.load_cell.has_value());
  return trial.load_cell->delay_deviation *
         Gauss(trial, kDelay, static_cast<uint64_t>(recording), 0);
}

std::vector<double> CellTimes(const TrialCase& trial, int recording,
                              const std::vector<double>& stamps) {
  if (!trial.load_cell) return {};
  return Delayed(stamps, CellDelay(trial, recording));
}

MeasuredReaction CellReading(const TrialCase& trial, int recording,
                             const std::vector<double>& stamps, const Eigen::Matrix3Xd& forces) {
  CHECK_EQ(static_cast<Eigen::Index>(stamps.size()), forces.cols());
  MeasuredReaction reading;
  reading.name = "clamp";
  reading.labels = {"x", "y", "z"};
  reading.directions = Eigen::Matrix3d::Identity();
  reading.deviation = trial.load_cell->deviation;
  reading.tare_deviation = trial.load_cell->tare_deviation;
  reading.delay_deviation = trial.load_cell->delay_deviation;
  reading.times = Eigen::Map<const Eigen::VectorXd>(stamps.data(), forces.cols());
  reading.values = forces.colwise() + CellTare(trial, recording);
  for (Eigen::Index f = 0; f < forces.cols(); ++f)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      reading.values(axis, f) +=
          reading.deviation * Gauss(trial, kNoise + static_cast<uint64_t>(recording),
                                    static_cast<uint64_t>(f), static_cast<uint64_t>(axis));
  return reading;
}

}  // namespace lacuna
