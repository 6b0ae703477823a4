// Counts the evaluations that a search needs, on the problems of tests/search/problem_collection.h.
//
//   search_benchmark smooth [--method M] [--ratio 1e-4] [--budget 5000] [--starts 10]
//   search_benchmark noisy  [--method M] [--ratio 4e-3] [--budget 200] [--starts 5] [--seeds 20]
//
// M: modern (the default), powell, modern-restarts, powell-restarts, gaussian-process (noisy only),
// nlopt-cobyla, nlopt-bobyqa (noisy only). One line of CSV per run on standard output;
// tests/benchmark/README.md explains the columns.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "search/cobyla.h"
#include "search/gaussian_process_search.h"
#include "search/nlopt_search.h"
#include "search/problem_collection.h"

namespace lacuna {
namespace {

struct Run {
  std::string method = "modern";
  double ratio = 0;  // of the final to the initial radius; 0: the default of the kind of problem
  int budget = 0;
  int starts = 0;  // 0: the default of the kind of problem
  int seeds = 20;
};

bool BeginsWith(const std::string& text, const char* prefix) { return text.rfind(prefix, 0) == 0; }

SearchResult Minimise(const Run& run, const SearchProblem& problem, double radius, uint64_t seed) {
  SearchControl control;
  control.max_evaluations = run.budget;
  if (run.method == "gaussian-process") {
    GaussianProcessSearchOptions options;
    options.seed = seed;
    return MinimiseByGaussianProcess(problem, control, options);
  }
  if (BeginsWith(run.method, "nlopt")) {
    NloptOptions options;
    options.algorithm =
        run.method == "nlopt-bobyqa" ? NloptAlgorithm::kBobyqa : NloptAlgorithm::kCobyla;
    options.initial_radius = radius;
    options.final_radius = run.ratio * radius;
    return MinimiseByNlopt(problem, control, options);
  }
  CobylaOptions options;
  options.mode = BeginsWith(run.method, "powell") ? CobylaMode::kPowell : CobylaMode::kModern;
  options.initial_radius = radius;
  options.final_radius = run.ratio * radius;
  if (run.method.find("restarts") != std::string::npos) options.restarts.max_restarts = 1000;
  return MinimiseByCobyla(problem, control, options);
}

double Scale(double minimum) { return std::max(1.0, std::abs(minimum)); }

// The first evaluation within `tolerance` of the minimum, in value and in violation; -1 for none.
int FirstWithin(const SearchResult& result, double minimum, double tolerance) {
  for (size_t i = 0; i < result.trace.size(); ++i) {
    const Evaluation& outcome = result.trace[i].outcome;
    if (outcome.value && Violation(outcome.constraints) <= tolerance &&
        *outcome.value - minimum <= tolerance * Scale(minimum)) {
      return static_cast<int>(i) + 1;
    }
  }
  return -1;
}

// G: the global minimum, to 1e-3; L: another known one, to 1e-2; N: neither.
char ClassOf(const SearchResult& result, const KnownProblem& known) {
  if (!result.IsUsable() || result.violation() > 1e-3) return 'N';
  if (result.value() - known.minimum <= 1e-3 * Scale(known.minimum)) return 'G';
  for (const double other : known.other_minima) {
    if (std::abs(result.value() - other) <= 1e-2 * Scale(other)) return 'L';
  }
  return 'N';
}

void RunSmooth(const Run& run) {
  fmt::print(
      "solver,problem,family,n,m,start,rhoend_rel,nevals,f_ret,cv_ret,f_bestfeas,relgap,hit1e-3,"
      "hit1e-6,n_oob,max_oob,n_dup,minclass,status,ms\n");
  for (const KnownProblem& known : SmoothProblems()) {
    for (int start = 0; start < run.starts; ++start) {
      const KnownProblem jittered = Jittered(known, start);
      const auto begin = std::chrono::steady_clock::now();
      const SearchResult result = Minimise(run, jittered.problem, known.radius, 1);
      const std::chrono::duration<double, std::milli> time =
          std::chrono::steady_clock::now() - begin;
      int outside = 0;
      double best = std::numeric_limits<double>::infinity();
      for (const SearchStep& step : result.trace) {
        if ((step.x.array() < jittered.problem.lower.array()).any() ||
            (step.x.array() > jittered.problem.upper.array()).any()) {
          ++outside;
        }
        if (step.outcome.value && Violation(step.outcome.constraints) <= 1e-6) {
          best = std::min(best, *step.outcome.value);
        }
      }
      const double value = result.IsUsable() ? result.value() : NAN;
      fmt::print(
          "{},{},{},{},{},{},{},{},{:.12g},{:.3g},{:.12g},{:.3g},{},{},{},0,0,{},{},{:.2f}\n",
          run.method, known.name, known.family, known.problem.start.size(),
          known.problem.constraint_count, start, run.ratio, result.trace.size(), value,
          result.IsUsable() ? result.violation() : NAN, best,
          (value - known.minimum) / Scale(known.minimum), FirstWithin(result, known.minimum, 1e-3),
          FirstWithin(result, known.minimum, 1e-6), outside, ClassOf(result, known),
          ToString(result.status), time.count());
    }
  }
}

// The smooth valley at the best point after `count` evaluations, as a share of that at the start.
double GapAfter(const SearchResult& result, const SteppedProblem& stepped, size_t count) {
  double least = std::numeric_limits<double>::infinity();
  double gap = 1;
  for (size_t i = 0; i < std::min(count, result.trace.size()); ++i) {
    const SearchStep& step = result.trace[i];
    if (step.outcome.value && *step.outcome.value < least) {
      least = *step.outcome.value;
      gap = stepped.smooth(step.x) / stepped.smooth(stepped.problem.start);
    }
  }
  return gap;
}

void RunNoisy(const Run& run) {
  fmt::print("solver,variant,seed,start,rhoend_rel,nevals,gap25,gap50,gap100,gap200,status\n");
  struct Variant {
    const char* name;
    double noise, failing;
  };
  for (const Variant& variant :
       {Variant{"smooth", 0, 0}, {"lo", 0.005, 0}, {"hi", 0.02, 0}, {"lo_fail", 0.005, 0.03}}) {
    for (int seed = 1; seed <= run.seeds; ++seed) {
      for (int start = 0; start < run.starts; ++start) {
        SteppedProblem stepped =
            MakeSteppedProblem(variant.noise, variant.failing, static_cast<uint64_t>(seed));
        for (int i = 0; i < 4 && start > 0; ++i) {
          stepped.problem.start[i] = 0.15 + 0.7 * UniformOf(77 * start + i);
        }
        const SearchResult result = Minimise(run, stepped.problem, 0.25, seed);
        fmt::print("{},{},{},{},{},{},{:.5g},{:.5g},{:.5g},{:.5g},{}\n", run.method, variant.name,
                   seed, start, run.ratio, result.trace.size(), GapAfter(result, stepped, 25),
                   GapAfter(result, stepped, 50), GapAfter(result, stepped, 100),
                   GapAfter(result, stepped, 200), ToString(result.status));
      }
    }
  }
}

int Main(int argc, char** argv) {
  CLI::App app("Counts the evaluations that a search needs");
  Run run;
  app.add_option("--method", run.method)
      ->check(CLI::IsMember({"modern", "powell", "modern-restarts", "powell-restarts",
                             "gaussian-process", "nlopt-cobyla", "nlopt-bobyqa"}));
  app.add_option("--ratio", run.ratio)->check(CLI::PositiveNumber);
  app.add_option("--budget", run.budget)->check(CLI::PositiveNumber);
  app.add_option("--starts", run.starts)->check(CLI::PositiveNumber);
  app.add_option("--seeds", run.seeds)->check(CLI::PositiveNumber);
  CLI::App* smooth = app.add_subcommand("smooth")->fallthrough();
  app.add_subcommand("noisy")->fallthrough();
  app.require_subcommand(1);
  CLI11_PARSE(app, argc, argv);
  const bool is_smooth = smooth->parsed();
  if (run.ratio == 0) run.ratio = is_smooth ? 1e-4 : 4e-3;
  if (run.starts == 0) run.starts = is_smooth ? 10 : 5;
  if (run.budget == 0) run.budget = is_smooth ? 5000 : 200;
  is_smooth ? RunSmooth(run) : RunNoisy(run);
  return 0;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) { return lacuna::Main(argc, argv); }
