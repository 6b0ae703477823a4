#include "calibration/data_shares.h"

#include "calibration/data_kinds.h"
#include "calibration/linear_misfit.h"

namespace lacuna {

std::vector<std::optional<DataShares>> SharesOfData(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values,
                                                    const std::function<void()>& on_frame) {
  if (!HasSeveralKinds(problem)) return {};
  const LinearisedMisfit misfit =
      problem.Linearise(values, {.with_jacobian = true, .on_frame = on_frame});
  if (!misfit.usable) return {};
  // The kinds are whitened independently of one another, so that the squares of each are its own.
  const Eigen::MatrixXd squares =
      WhitenedRows(misfit.jacobian, misfit, {.fitted_only = true}).cwiseAbs2();
  const Eigen::RowVectorXd all = squares.colwise().sum();
  const std::vector<DataKind> kinds = KindsOfParts(misfit, problem);
  std::vector<std::optional<DataShares>> shares(static_cast<size_t>(all.size()));
  for (Eigen::Index k = 0; k < all.size(); ++k)
    if (all[k] > 0)
      shares[static_cast<size_t>(k)] = SumsByKind(squares.col(k) / all[k], misfit, kinds);
  return shares;
}

}  // namespace lacuna
