// What ranking all effects costs, in forward simulations of the same model, both timed in one run:
//   ranking_benchmark EXPERIMENT [--repeats N]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

#include "core/blas_kernels.h"
#include "core/error.h"
#include "core/logging.h"
#include "study/calibration_fits.h"
#include "study/effect_ranking.h"
#include "study/nuisance_candidates.h"
#include "study/reference.h"

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

int Run(const std::string& file, int repeats) {
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  const ReferenceBody reference = MakeReferenceBody(study);
  const CalibrationProblem problem(study, reference.mesh);
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  const Eigen::VectorXd values = FitFromStart(problem, &progress).parameters;
  std::vector<double> forward, nuisances, ranking;
  for (int k = 0; k < repeats; ++k) {
    LinearisedMisfit misfit;
    forward.push_back(Seconds([&] { misfit = problem.Linearise(values, false); }));
    nuisances.push_back(Seconds([&] { NuisancesAlwaysTaken(problem, values, misfit); }));
    ranking.push_back(Seconds([&] { RankEffects(problem, values, &progress); }));
  }
  const double unit = Median(forward);
  fmt::print("{} unknowns; medians of {}\n", 3 * reference.mesh.nodes.cols(), repeats);
  fmt::print("  one forward simulation of all recordings  {:8.3f} s\n", unit);
  fmt::print("  finer mesh and steps, other dimensions    {:8.3f} s  {:5.2f} forward simulations\n",
             Median(nuisances), Median(nuisances) / unit);
  std::vector<double> effects;
  for (int k = 0; k < repeats; ++k)
    effects.push_back(ranking[static_cast<size_t>(k)] - nuisances[static_cast<size_t>(k)]);
  fmt::print("  all effects, grips and measurement errors {:8.3f} s  {:5.2f} forward simulations\n",
             Median(effects), Median(effects) / unit);
  fmt::print("  the whole ranking                         {:8.3f} s  {:5.2f} forward simulations\n",
             Median(ranking), Median(ranking) / unit);
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
