#include "calibration/data_shares.h"

#include "calibration/linear_misfit.h"

namespace lacuna {
namespace {

using ShareOfKind = double DataShares::*;

ShareOfKind ShareOfPoints(const RecordingModel& model) {
  return model.Markers() != nullptr ? &DataShares::markers : &DataShares::scans;
}

// Whether the fitted recordings have several kinds of data.
bool HasSeveralKinds(const CalibrationProblem& problem) {
  bool markers = false, scans = false, forces = false;
  for (const RecordingModel& model : problem.models()) {
    if (!model.item().fitted) continue;
    (model.Markers() != nullptr ? markers : scans) = true;
    forces = forces || !model.Reactions().empty();
  }
  return static_cast<int>(markers) + static_cast<int>(scans) + static_cast<int>(forces) > 1;
}

}  // namespace

std::vector<std::optional<DataShares>> SharesOfData(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values) {
  if (!HasSeveralKinds(problem)) return {};
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return {};
  // The parts are whitened independently of one another, so that the squares of each are its own.
  const Eigen::MatrixXd squares =
      WhitenedRows(misfit.jacobian, misfit, 0, /*fitted_only=*/true).cwiseAbs2();
  const Eigen::RowVectorXd all = squares.colwise().sum();
  std::vector<std::optional<DataShares>> shares(static_cast<size_t>(all.size()));
  for (Eigen::Index k = 0; k < all.size(); ++k) {
    if (!(all[k] > 0)) continue;
    DataShares& own = shares[static_cast<size_t>(k)].emplace();
    for (const LinearisedMisfit::Part& part : misfit.parts) {
      const ShareOfKind share =
          part.IsOfPoints() ? ShareOfPoints(problem.models()[part.recording]) : &DataShares::forces;
      own.*share += squares.col(k).segment(part.first_row, part.layout.Rows()).sum() / all[k];
    }
  }
  return shares;
}

}  // namespace lacuna
