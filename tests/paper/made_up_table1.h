// Made-up searches of Table 1, of which each number is plain to see.
#ifndef LACUNA_TESTS_PAPER_MADE_UP_TABLE1_H_
#define LACUNA_TESTS_PAPER_MADE_UP_TABLE1_H_

#include <string>

#include "paper/table1.h"

namespace lacuna {

// A configuration that searches q and v, and y and p too if `seeks_material`.
inline Table1Configuration MadeUpConfiguration(const std::string& name, bool seeks_material) {
  ParameterSearchSettings settings;
  settings.variables = {{"radius_edge_ratio", 1.5, 3, 2, SearchScale::kLinear},
                        {"max_volume", 1e-5, 1e-3, 1e-4, SearchScale::kLogarithmic},
                        {"young_modulus", 1e5, 1e7, 5e5, SearchScale::kLogarithmic},
                        {"poisson_ratio", 0.1, 0.45, 0.2, SearchScale::kLinear}};
  if (!seeks_material)
    for (const size_t i : {2u, 3u})
      settings.variables[i].lower = settings.variables[i].upper = settings.variables[i].start;
  return {name, Config::Parse("row: 1", name + ".yaml"), settings, {}};
}

// D of `per_point`, m, at each of 300 points.
inline ObjectiveEvaluation MadeUpEvaluation(double per_point) {
  ObjectiveEvaluation evaluation;
  evaluation.usable = true;
  evaluation.residual_per_point = per_point;
  evaluation.residual_rms = 1.2 * per_point;
  evaluation.residual_sum = 300 * per_point;
  evaluation.seconds = 1;
  return evaluation;
}

// A search from D = 4 mm to `best`, m, at `young_modulus`, Pa; D is 3.5 mm at the true moduli.
inline Table1Search MadeUpSearch(double best, double young_modulus, double seconds = 1) {
  Table1Search search;
  search.found.evaluations = {MadeUpEvaluation(4e-3), MadeUpEvaluation(best)};
  search.found.evaluations[1].seconds = seconds;
  search.found.parameters = {{2, 1e-4, 5e5, 0.2}, {1.8, 2e-4, young_modulus, 0.25}};
  search.found.best = 1;
  search.worst = 0;
  search.at_truth = MadeUpEvaluation(3.5e-3);
  return search;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_PAPER_MADE_UP_TABLE1_H_
