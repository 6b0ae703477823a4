#include "calibration/far_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {
namespace {

constexpr double kNear = 0.85;  // share of points with a correspondence at a start that is near
constexpr double kStep = 2;     // factor between the moduli that are tried
constexpr int kMostSteps = 10;  // in each direction
// A direction is given up after so many steps without improvement. The distance is not exactly
// unimodal, because the nearest part of the surface may be the wrong one.
constexpr int kFruitlessSteps = 2;
// The first reach, as a multiple of the mean distance. Larger: more wrong correspondences;
// smaller: the farthest points, which determine most, are left out.
constexpr double kReachOfMean = 3;

using FitMemory = CalibrationProblem::FitMemory;

// `values` with the fitted moduli multiplied by `factor`, within their bounds.
Eigen::VectorXd Scaled(const CalibrationProblem& problem, Eigen::VectorXd values, double factor) {
  for (size_t k = 0; k < problem.parameters().size(); ++k) {
    if (!problem.IsModulus(k)) continue;
    const CalibratedParameter& parameter = problem.parameters()[k];
    double& value = values[static_cast<Eigen::Index>(k)];
    value = std::clamp(value * factor, parameter.min, parameter.max);
  }
  return values;
}

// The nearest prediction so far, and the range of factors that were tried.
struct Search {
  Eigen::VectorXd best;
  double distance = std::numeric_limits<double>::infinity();  // m
  double softest = 1, stiffest = 1;
  int predictions = 0;
};

// Multiplies the moduli by `factor` again and again. `memory`: of the prediction at `start`.
void SearchTowards(double factor, const CalibrationProblem& problem, const Eigen::VectorXd& start,
                   FitMemory memory, Search* search) {
  Eigen::VectorXd values = start;
  double total = 1;
  for (int step = 0, fruitless = 0; step < kMostSteps && fruitless < kFruitlessSteps; ++step) {
    const Eigen::VectorXd next = Scaled(problem, values, factor);
    if (next == values) return;  // no modulus is fitted, or all are at their bounds
    values = next;
    total *= factor;
    ++search->predictions;
    const auto distance = problem.DistanceOfScans(values, &memory);
    // A softer object than one that collapses collapses too; a stiffer one need not.
    if (!distance && factor < 1) return;
    search->softest = std::min(search->softest, total);
    search->stiffest = std::max(search->stiffest, total);
    if (distance && distance->mean < search->distance) {
      search->distance = distance->mean;
      search->best = values;
      fruitless = 0;
    } else if (std::isfinite(search->distance)) {
      ++fruitless;
    }
  }
}

}  // namespace

FarStart FindFarStart(const CalibrationProblem& problem, const Eigen::VectorXd& start) {
  FarStart far;
  far.values = start;
  if (!problem.HasScans() || problem.study().scheme != TimeScheme::kQuasiStatic) return far;
  FitMemory memory;
  Search search{.best = start, .predictions = 1};
  const auto at_start = problem.DistanceOfScans(start, &memory);
  if (at_start && at_start->used >= kNear) {
    far.predictions = search.predictions;
    return far;
  }
  if (at_start) search.distance = at_start->mean;
  if (at_start) SearchTowards(1 / kStep, problem, start, memory, &search);
  SearchTowards(kStep, problem, start, memory, &search);
  far.predictions = search.predictions;
  if (!std::isfinite(search.distance)) {
    far.summary = fmt::format(
        "no equilibrium was found with moduli of 1 to {:g} times their start "
        "values",
        search.stiffest);
    return far;
  }
  const double size = BoundingBoxDiagonal(problem.body()->mesh.nodes);
  const double reach = problem.study().scan.reach;
  far.values = search.best;
  far.reach_factor =
      std::clamp(kReachOfMean * search.distance / (reach * size), 1.0, std::max(1.0, 1 / reach));
  far.summary = fmt::format(
      "with moduli of {:g} to {:g} times their start values the scanned points are at best {:.3g} "
      "mm "
      "from the predicted surface on average (scan.reach is {:.3g} mm)",
      search.softest, search.stiffest, 1e3 * search.distance, 1e3 * reach * size);
  return far;
}

}  // namespace lacuna
