// An ablation: the parameter search is repeated with one thing changed at a time.
//
// Each row is an experiment file like those of Table 1 (paper/table1.h). It names what varies, the
// question that it answers, and the row that it is compared with.
#ifndef LACUNA_PAPER_ABLATION_H_
#define LACUNA_PAPER_ABLATION_H_

#include <filesystem>
#include <string>
#include <vector>

#include "paper/table1_report.h"

namespace lacuna {

// The residual of a row: at its start, at its best parameters and at the truth.
struct AblationResidual {
  SeedRange start, best;          // mean of D per point, m, whatever measure was searched
  SeedRange start_sum, best_sum;  // |D_anim| of the paper, m
  SeedRange drop;                 // 1 − best / start of the searched measure
  SeedRange at_truth;  // mean of D per point, m, at the true y and p and the row's own q and v
};

// The parameters that a row found, SI, and their errors.
struct AblationOptimum {
  SeedRange radius_edge_ratio, max_volume, young_modulus, poisson_ratio;
  SeedRange modulus_factor;  // y divided by its true value
  SeedRange poisson_error;   // p minus its true value
};

// One row, summarised over all seeds whose search succeeded.
struct AblationRow {
  std::string name, varies, question, against;
  int seeds = 0;
  AblationResidual residual;
  AblationOptimum optimum;
  SeedRange evaluations, failures, seconds;
  std::string method_message;  // from the search of the first seed
  std::string shows;           // a sentence that is derived from the numbers alone
};

struct AblationSummary {
  std::vector<AblationRow> rows;
  // Noise of the mean of D per point, see Table1Summary. Where it was not measured, the sentences
  // of the rows assume 1 % and say so.
  double mesh_noise = kNotMeasured;
  int turns = 0;  // the number of rotated meshes from which it was measured
};

// Rows in the order of the configurations. A row is compared with the one that it names, or the
// first.
AblationSummary SummariseAblation(const Table1Study& study, const Table1Result& result);

std::string AblationText(const Table1Study& study, const Table1Result& result);
// Writes ablation.txt, ablation.json and ablation.csv.
void WriteAblation(const Table1Study& study, const Table1Result& result,
                   const std::filesystem::path& folder);

// Throws InputError when a row's `against` names no row.
void CheckAblation(const Table1Study& study);

}  // namespace lacuna

#endif  // LACUNA_PAPER_ABLATION_H_
