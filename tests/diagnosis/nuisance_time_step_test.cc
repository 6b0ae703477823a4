#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/nuisance_catalogue.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Norms over all rows, m: of the change of the residual by steps that are 16 times shorter, of the
// difference between that and the nuisance's first column, and of what the nuisance calls unknown.
struct StepChange {
  double change = 0, missed = 0, unknown = 0;
};

StepChange StepChangeOf(const std::map<std::string, std::string>& replaced) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path(), replaced);
  const CalibrationProblem problem(study, MakeReferenceBody(study).mesh);
  Eigen::VectorXd values = problem.Start();
  // A force holds the bar aside, without which it would not move.
  for (size_t k = 0; k < problem.parameters().size(); ++k)
    if (problem.UnitOf(k) == "N") values[static_cast<Eigen::Index>(k)] = 0.03;
  const LinearisedMisfit misfit = problem.Linearise(values, {.with_jacobian = true});
  const std::vector<NuisanceCandidate> nuisances =
      ModelNuisances({problem, values, misfit, GripMotions{}, Eigen::MatrixXd()});
  const auto step = std::find_if(nuisances.begin(), nuisances.end(),
                                 [](const auto& own) { return own.card.name == "time_step"; });
  if (step == nuisances.end()) return {};
  PredictionStudy short_steps = problem.WithEstimatedNoise();
  short_steps.time_step /= 16;
  const Eigen::VectorXd change =
      256.0 / 255 *
      (CalibrationProblem(short_steps, problem.body()->mesh).Linearise(values).residual -
       misfit.residual);
  return {change.norm(), (step->columns.col(0) - change).norm(), step->unknown.norm()};
}

TEST(TimeStepNuisance, IsExtrapolatedToTheLimitOfShortSteps) {
  const std::string coarse = "max_volume: 4000 mm^3, preserve_surface: false";
  const StepChange damped = StepChangeOf(
      {{"max_volume: 1000 mm^3", coarse},
       {"{type: mass_damping, alpha: 1 1/s}",
        "{type: mass_damping, alpha: 1 1/s}\n  - {type: stiffness_damping, beta: 1 ms}"}});
  EXPECT_GT(damped.change, 0);
  EXPECT_LT(damped.missed, 0.05 * damped.change) << "it must be less than its prior allows";
  EXPECT_LT(damped.missed, damped.unknown);
  // The release excites vibrations that no step resolves.
  const StepChange ringing =
      StepChangeOf({{"max_volume: 1000 mm^3", coarse}, {"time_step: 1.5 ms", "time_step: 4 ms"}});
  EXPECT_GT(ringing.missed, 0.1 * ringing.change);
  EXPECT_LT(ringing.missed, ringing.unknown);
}

}  // namespace
}  // namespace lacuna
