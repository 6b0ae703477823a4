#include "calibration/in_phase.h"

#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"

namespace lacuna {

InPhase KeptInPhase(const Eigen::MatrixXd& columns, const CalibrationProblem& problem,
                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit,
                    bool fitted_only) {
  const Eigen::MatrixXd jacobian = misfit.jacobian.leftCols(values.size());
  const Eigen::MatrixXd by = WhitenedRows(jacobian, misfit, 0, fitted_only);
  std::vector<LinearPrior> priors = PriorsAbout(problem.parameters(), values);
  for (LinearPrior& prior : priors) prior.mean = 0;
  const LinearGaussianModel model(Eigen::VectorXd::Zero(by.rows()), by, std::move(priors));
  const Eigen::MatrixXd whitened = WhitenedRows(columns, misfit, 0, fitted_only);
  InPhase kept{Eigen::MatrixXd(values.size(), columns.cols()), columns};
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    kept.parameters.col(k) = model.WithResidual(whitened.col(k), by).FitAll(1).change;
    kept.residual.col(k) += jacobian * kept.parameters.col(k);
  }
  return kept;
}

}  // namespace lacuna
