// An ablation: the outer search again and again with one thing changed, and what each change does.
//
// Each row is an experiment file like those of Table 1 (paper/table1.h), run by the same machinery;
// it names what varies, the question it answers and the row that it is held against.
#ifndef LACUNA_PAPER_ABLATION_H_
#define LACUNA_PAPER_ABLATION_H_

#include <filesystem>
#include <string>
#include <vector>

#include "paper/table1_report.h"

namespace lacuna {

// A row over all seeds whose search found something; medians and extremes.
struct AblationRow {
  std::string name, varies, question, against;
  int seeds = 0;
  SeedRange start, best;          // D per point, m, whatever was searched
  SeedRange start_sum, best_sum;  // the paper's |D_anim|, m
  SeedRange drop;                 // 1 − best / start of the measure searched
  // What was found; of y and p also how far from the truth: y over it, and p less it.
  SeedRange radius_edge_ratio, max_volume, young_modulus, poisson_ratio;
  SeedRange modulus_factor, poisson_error;
  SeedRange at_truth;  // D per point at the true y and p, the row's own start q and v, m
  SeedRange evaluations, failures, seconds;
  std::string method_message;  // of the first seed's search
  std::string shows;           // in words, from the numbers alone
};

struct AblationSummary {
  std::vector<AblationRow> rows;
  double mesh_noise = kNotMeasured;  // of D per point, as in Table1Summary
};

// Rows in the order of the configurations. A row is held against the one it names, or the first.
AblationSummary SummariseAblation(const Table1Study& study, const Table1Result& result);

std::string AblationText(const Table1Study& study, const Table1Result& result);
// ablation.txt, ablation.json and ablation.csv.
void WriteAblation(const Table1Study& study, const Table1Result& result,
                   const std::filesystem::path& folder);

// Throws InputError when a row's `against` names no row.
void CheckAblation(const Table1Study& study);

}  // namespace lacuna

#endif  // LACUNA_PAPER_ABLATION_H_
