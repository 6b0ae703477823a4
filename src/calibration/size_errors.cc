#include "calibration/size_errors.h"

#include <algorithm>
#include <array>
#include <functional>

#include "core/parallel.h"

namespace lacuna {
namespace {

// The finite difference stretches the body by this share of the standard deviation: a larger change
// alters the phase of a long motion, which is not linear.
constexpr double kProbe = 0.1;

}  // namespace

Eigen::MatrixXd ChangesBySize(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const LinearisedMisfit& misfit) {
  const PredictionStudy study = problem.WithEstimatedNoise();
  if (study.size_deviation == 0) return {};
  const Model& model = problem.models().front().model();
  const TetMesh& mesh = problem.body()->mesh;
  Eigen::Vector3d centre = mesh.nodes.rowwise().mean();
  if (!model.grips.empty() && model.grips.front().nodes.size() > 0)
    centre = mesh.nodes(Eigen::all, model.grips.front().nodes).rowwise().mean();
  const Eigen::VectorXd& residual = misfit.residual;
  Eigen::MatrixXd changes(residual.size(), 3);
  std::array<bool, 3> is_usable{};
  ParallelFor(3, 1, [&](int64_t axis) {
    TetMesh larger = mesh;
    larger.nodes.row(axis).array() +=
        kProbe * study.size_deviation * (mesh.nodes.row(axis).array() - centre[axis]);
    const LinearisedMisfit changed =
        CalibrationProblem(study, larger).Linearise(values, false, {}, nullptr, &misfit);
    if (!changed.usable || changed.residual.size() != residual.size()) return;
    changes.col(axis) = (changed.residual - residual) / kProbe;
    is_usable[static_cast<size_t>(axis)] = true;
  });
  return std::all_of(is_usable.begin(), is_usable.end(), std::identity()) ? changes
                                                                          : Eigen::MatrixXd();
}

}  // namespace lacuna
