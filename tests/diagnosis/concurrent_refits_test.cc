// Refits of one diagnosis share the fitted problem, its effects and its recordings. They may run
// side by side: what each finds does not depend on the other. The preset tsan looks for races.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "calibration/calibration_fits.h"
#include "diagnosis/effect_refit.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

ScoredEffect Candidate(const std::string& type, const std::map<std::string, double>& at_null,
                       double expected, const Eigen::VectorXd& fitted) {
  ScoredEffect effect;
  effect.candidate = {type, "", MakeEffect(type, at_null), {0}};
  effect.score.size = Eigen::VectorXd::Constant(1, expected);
  effect.expected_values = fitted;
  return effect;
}

TEST(ConcurrentRefits, FindTheSameBitsAsOneAfterTheOther) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({4, 1, 1}, 1));
  SilentProgress progress;
  const Calibration fit = FitShortHorizon(problem, problem.Start(), &progress);
  ASSERT_FALSE(fit.estimates.empty()) << fit.message;
  const LinearisedMisfit misfit = problem.Linearise(fit.parameters, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  // One whose areas are derived from the rest shape once and shared, and one with memory.
  const std::vector<ScoredEffect> effects{
      Candidate("elastic_support", {{"modulus", 0}}, 1e4, fit.parameters),
      Candidate("viscoelastic_branch",
                {{"modulus", 0}, {"relaxation_time", 0.03}, {"poisson_ratio", 0.4}}, 1e4,
                fit.parameters)};
  const auto refit = [&](const ScoredEffect& effect) {
    SilentProgress own;
    return Refit({{problem, fit.parameters, misfit, &own},
                  {Eigen::MatrixXd(misfit.residual.size(), 0), {}, 0}},
                 &effect);
  };
  std::vector<EffectRefit> in_turn, at_once(effects.size());
  for (const ScoredEffect& effect : effects) in_turn.push_back(refit(effect));
  {
    std::vector<std::jthread> threads;
    for (size_t k = 0; k < effects.size(); ++k)
      threads.emplace_back([&, k] { at_once[k] = refit(effects[k]); });
  }
  for (size_t k = 0; k < effects.size(); ++k) {
    ASSERT_TRUE(in_turn[k].message.empty()) << in_turn[k].message;
    EXPECT_GT(in_turn[k].calibration.predictions, 1);
    EXPECT_EQ(at_once[k].calibration.parameters, in_turn[k].calibration.parameters);
    EXPECT_EQ(at_once[k].hypothesis.misfit.residual, in_turn[k].hypothesis.misfit.residual);
  }
}

}  // namespace
}  // namespace lacuna
