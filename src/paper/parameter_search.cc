#include "paper/parameter_search.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "fit/gradient_search.h"
#include "paper/evaluation_record.h"
#include "search/gaussian_process_search.h"
#include "search/nlopt_search.h"

namespace lacuna {
namespace {

SearchVariable ReadVariable(const Config& search, const std::string& name,
                            const Dimension& dimension, const Bounds& bounds, SearchScale scale) {
  const Config entry = search.Child(name);
  SearchVariable variable{name, 0, 0, 0, scale};
  variable.start = entry.Quantity("start", dimension, bounds);
  if (entry.Has("lower") != entry.Has("upper"))
    entry.Fail(entry.Has("lower") ? "lower" : "upper",
               "lower and upper go together; without both the parameter stays at its start");
  variable.lower = entry.Quantity("lower", dimension, bounds, variable.start);
  variable.upper = entry.Quantity("upper", dimension, bounds, variable.start);
  if (variable.lower > variable.start || variable.start > variable.upper)
    entry.Fail("start", "lies outside of lower and upper");
  return variable;
}

// Refuses the keys that the chosen method would ignore.
void RefuseIgnored(const Config& search, SearchMethod method) {
  const bool is_cobyla =
      method == SearchMethod::kCobylaModern || method == SearchMethod::kCobylaPowell;
  const bool is_process = method == SearchMethod::kGaussianProcess;
  const auto refuse = [&search](const char* key, bool acts, const char* methods) {
    if (search.Has(key) && !acts)
      search.Fail(key, fmt::format("acts with method {} only; remove it", methods));
  };
  refuse("restarts", is_cobyla, "cobyla or cobyla_1994");
  refuse("difference", method == SearchMethod::kCeres, "ceres");
  refuse("seed", is_process, "gaussian_process");
}

SearchResult Run(const SearchProblem& problem, const SearchControl& control,
                 const ParameterSearchSettings& settings) {
  CobylaOptions cobyla = settings.cobyla;
  GaussianProcessSearchOptions process;
  process.seed = settings.seed;
  NloptOptions library;
  library.initial_radius = cobyla.initial_radius;
  library.final_radius = cobyla.final_radius;
  switch (settings.method) {
    case SearchMethod::kCobylaModern:
      cobyla.mode = CobylaMode::kModern;
      return MinimiseByCobyla(problem, control, cobyla);
    case SearchMethod::kCobylaPowell:
      cobyla.mode = CobylaMode::kPowell;
      return MinimiseByCobyla(problem, control, cobyla);
    case SearchMethod::kGaussianProcess:
      return MinimiseByGaussianProcess(problem, control, process);
    case SearchMethod::kNloptBobyqa:
      library.algorithm = NloptAlgorithm::kBobyqa;
      return MinimiseByNlopt(problem, control, library);
    case SearchMethod::kCeres:
      return MinimiseByGradient(problem, control,
                                {cobyla.initial_radius, cobyla.final_radius, settings.difference});
    case SearchMethod::kNloptCobyla:
      break;
  }
  return MinimiseByNlopt(problem, control, library);
}

// The residual of an evaluation by the chosen measure, or the slopes of that residual.
template <typename Residuals>
double Chosen(const Residuals& residuals, ObjectiveMeasure measure) {
  switch (measure) {
    case ObjectiveMeasure::kSum:
      return residuals.residual_sum;
    case ObjectiveMeasure::kRms:
      return residuals.residual_rms;
    case ObjectiveMeasure::kPerPoint:
      break;
  }
  return residuals.residual_per_point;
}

// Whether the search's log and the record have the same value of an evaluation, or both none.
bool Agree(const Evaluation& logged, const ObjectiveEvaluation& recorded,
           ObjectiveMeasure measure) {
  const double value = recorded.usable ? Chosen(recorded, measure) : kNotMeasured;
  return logged.value ? *logged.value == value : !std::isfinite(value);
}

// The derivatives with respect to q, v, y and p; NaN where the evaluation has none.
Eigen::VectorXd GradientOf(const ObjectiveEvaluation& evaluation, ObjectiveMeasure measure) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Constant(4, kNotMeasured);
  for (size_t i = 0; i < evaluation.by_moduli.size(); ++i)
    gradient[static_cast<Eigen::Index>(2 + i)] = Chosen(evaluation.by_moduli[i], measure);
  return gradient;
}

}  // namespace

ParameterSearchSettings ReadParameterSearch(const Config& search) {
  ParameterSearchSettings settings;
  settings.variables = {
      ReadVariable(search, "radius_edge_ratio", kDimensionless, {1, 100, true, false},
                   SearchScale::kLinear),
      ReadVariable(search, "max_volume", kVolume, kPositive, SearchScale::kLogarithmic),
      ReadVariable(search, "young_modulus", kPressure, kPositive, SearchScale::kLogarithmic),
      ReadVariable(search, "poisson_ratio", kDimensionless, {0, 0.5, false, true},
                   SearchScale::kLinear)};
  settings.method =
      search.Choice<SearchMethod>("method",
                                  {{"cobyla", SearchMethod::kCobylaModern},
                                   {"cobyla_1994", SearchMethod::kCobylaPowell},
                                   {"gaussian_process", SearchMethod::kGaussianProcess},
                                   {"nlopt_cobyla", SearchMethod::kNloptCobyla},
                                   {"nlopt_bobyqa", SearchMethod::kNloptBobyqa},
                                   {"ceres", SearchMethod::kCeres}},
                                  "cobyla");
  settings.measure = search.Choice<ObjectiveMeasure>("measure",
                                                     {{"per_point", ObjectiveMeasure::kPerPoint},
                                                      {"rms", ObjectiveMeasure::kRms},
                                                      {"sum", ObjectiveMeasure::kSum}},
                                                     "per_point");
  settings.registration_in_loop =
      search.Choice<bool>("registration", {{"tracked", false}, {"in_loop", true}}, "tracked");
  settings.remesh_surface = search.Flag("remesh_surface", settings.remesh_surface);
  settings.evaluations = search.Integer("evaluations", 1, 100000, settings.evaluations);
  CobylaOptions& cobyla = settings.cobyla;
  cobyla.initial_radius =
      search.Number("initial_radius", {0, 0.5, true, false}, cobyla.initial_radius);
  cobyla.final_radius = search.Number("final_radius", {0, 0.5, true, false}, 0.01);
  if (cobyla.final_radius > cobyla.initial_radius)
    search.Fail("final_radius", "is larger than initial_radius");
  RefuseIgnored(search, settings.method);
  cobyla.restarts.max_restarts = search.Integer("restarts", 0, 1000, 20);
  settings.difference = search.Number("difference", {0, 0.5, true, false}, settings.difference);
  const auto is_free = [](const SearchVariable& variable) {
    return variable.lower < variable.upper;
  };
  const auto free = std::count_if(settings.variables.begin(), settings.variables.end(), is_free);
  if (settings.method == SearchMethod::kNloptBobyqa && free < 2)
    search.Fail("method", "nlopt_bobyqa needs two free parameters at least");
  settings.seed = static_cast<uint64_t>(search.Integer("seed", 0, 1 << 30, 1));
  return settings;
}

SearchedParameters ParametersOf(const Eigen::VectorXd& x) { return {x[0], x[1], x[2], x[3]}; }

double ValueOf(const ObjectiveEvaluation& evaluation, ObjectiveMeasure measure) {
  return Chosen(evaluation, measure);
}

double ParameterSearchResult::Seconds() const {
  double seconds = 0;
  for (const ObjectiveEvaluation& evaluation : evaluations) seconds += evaluation.seconds;
  return seconds;
}

int ParameterSearchResult::Worst(ObjectiveMeasure measure) const {
  int worst = best;
  for (size_t k = 0; k < evaluations.size(); ++k) {
    if (!evaluations[k].usable) continue;
    if (worst < 0 || ValueOf(evaluations[k], measure) > ValueOf(evaluations[worst], measure))
      worst = static_cast<int>(k);
  }
  return worst;
}

ParameterSearchResult RunParameterSearch(const ParameterObjective& problem,
                                         const ParameterSearchSettings& settings,
                                         const std::filesystem::path& folder,
                                         const std::string& key, Progress* progress) {
  MakeFolder(folder);
  const std::filesystem::path record_file = folder / "evaluations.jsonl";
  EvaluationRecord record(record_file, key);
  for (const std::string& other : record.other_instructions()) {
    LOG(WARNING) << record_file.string() << ": some evaluations were made with other vector "
                 << "instructions (" << other << ") than this processor's (" << InstructionsInUse()
                 << "); here their values, and the path of the search, would be slightly different";
  }
  const SearchSpace space(settings.variables);
  progress->Begin("search", settings.evaluations);
  int64_t done = 0;
  ParameterObjective asked = problem;
  asked.slopes = settings.method == SearchMethod::kCeres;
  const auto evaluate = [&](const Eigen::VectorXd& x) {
    const ObjectiveEvaluation& known = record.FindOrEvaluate(asked, ParametersOf(x));
    Evaluation outcome;
    if (known.usable) outcome.value = ValueOf(known, settings.measure);
    outcome.failure = known.failure;
    progress->Report(++done, outcome.value.value_or(kNotMeasured));
    return outcome;
  };
  const auto gradient = [&](const Eigen::VectorXd& x) {
    // The outcome may have come from search.log, and the record may lack it.
    return GradientOf(record.FindOrEvaluate(asked, ParametersOf(x)), settings.measure);
  };
  const SearchProblem search_problem = space.ProblemOf(evaluate, 0, gradient);
  SearchControl control;
  control.max_evaluations = settings.evaluations;
  control.log = folder / "search.log";
  control.log_key = key;
  const SearchResult found = Run(search_problem, control, settings);
  ParameterSearchResult result;
  result.status = found.status;
  result.message = found.message;
  result.trace_hash = found.trace_hash;
  result.best = found.best.value_or(-1);
  result.failures = found.failures;
  for (const SearchStep& step : found.trace) {
    result.parameters.push_back(ParametersOf(space.FromUnit(step.x)));
    const ObjectiveEvaluation& known = record.FindOrEvaluate(asked, result.parameters.back());
    if (!Agree(step.outcome, known, settings.measure)) {
      throw InputError(
          SourcePosition{record_file.string()},
          fmt::format("has another value of an evaluation than {}, because one of them "
                      "was changed or comes from another processor or version of the "
                      "program; remove both to search anew",
                      control.log.string()));
    }
    result.evaluations.push_back(known);
  }
  progress->End(
      fmt::format("{} evaluations, {} failed", result.evaluations.size(), result.failures));
  return result;
}

}  // namespace lacuna
