// What ranking all effects costs, in forward simulations of the same model, both timed in one run:
//   ranking_benchmark EXPERIMENT [--repeats N]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

#include "calibration/calibration_fits.h"
#include "core/blas_kernels.h"
#include "core/error.h"
#include "core/logging.h"
#include "diagnosis/candidates.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/pilot_hypotheses.h"
#include "diagnosis/rank_effects.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "support/silent_progress.h"

namespace lacuna {
namespace {

double Seconds(const std::function<void()>& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// One for each amplitude of each variant of each effect that has a derivative where it vanishes.
std::vector<MisfitDirection> DirectionsOfEffects(const CalibrationProblem& problem) {
  const PredictionStudy& study = problem.study();
  std::vector<MisfitDirection> directions;
  for (const CandidateEffect& candidate : MakeCandidates(
           {*problem.body(), study.effects, ScaleOf(study), study.time_step, Duration(study), {}}))
    for (const int parameter : candidate.amplitude)
      directions.push_back({.perturbation = {.effect = candidate.effect, .parameter = parameter}});
  return directions;
}

int Run(const std::string& file, int repeats) {
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  const ReferenceBody reference = MakeReferenceBody(study);
  const CalibrationProblem problem(study, reference.mesh);
  SilentProgress progress;
  const Eigen::VectorXd values = FitFromStart(problem, &progress).parameters;
  const std::vector<MisfitDirection> directions = DirectionsOfEffects(problem);
  std::vector<double> forward, tangents, pilots, nuisances, ranking;
  for (int k = 0; k < repeats; ++k) {
    LinearisedMisfit misfit;
    forward.push_back(Seconds([&] { misfit = problem.Linearise(values); }));
    tangents.push_back(Seconds(
        [&] { problem.Linearise(values, {.with_jacobian = true, .directions = directions}); }));
    pilots.push_back(Seconds([&] { RunPilots(problem, values, misfit, {}); }));
    misfit = problem.Linearise(values, {.with_jacobian = true});
    nuisances.push_back(Seconds([&] {
      ModelNuisances({problem, values, misfit, GripMotions{}, Eigen::MatrixXd()});
    }));
    ranking.push_back(Seconds([&] { RankEffects(problem, values, &progress); }));
  }
  const double unit = Median(forward);
  fmt::print("{} unknowns; medians of {}\n", 3 * reference.mesh.nodes.cols(), repeats);
  const auto print = [&](const std::string& what, double seconds) {
    fmt::print("  {:<44} {:8.3f} s  {:6.2f}\n", what, seconds, seconds / unit);
  };
  print("one forward simulation of all recordings", unit);
  print(fmt::format("it with its tangents in {} directions", directions.size()), Median(tangents));
  print("contact and other elasticity laws", Median(pilots));
  print("finer mesh and steps, other dimensions", Median(nuisances));
  print("the whole ranking", Median(ranking));
  return 0;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  lacuna::UseFastBlasKernels(argv);
  lacuna::InitialiseLogging(argv[0]);
  CLI::App app("Cost of ranking all effects against one forward simulation");
  std::string file;
  int repeats = 3;
  app.add_option("experiment", file, "An experiment that predicts")->required();
  app.add_option("--repeats", repeats, "Of each timing")->check(CLI::Range(1, 100));
  CLI11_PARSE(app, argc, argv);
  try {
    return lacuna::Run(file, repeats);
  } catch (const lacuna::InputError& problem) {
    fmt::print(stderr, "{}\n", problem.what());
    return 1;
  }
}
