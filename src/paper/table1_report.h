// Table 1 as a text, as JSON and as plots; and which of the paper's claims it bears out.
#ifndef LACUNA_PAPER_TABLE1_REPORT_H_
#define LACUNA_PAPER_TABLE1_REPORT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paper/table1.h"

namespace lacuna {

// Median and extremes over the seeds: with ten or fewer of them, the extremes are the honest
// interval.
struct SeedRange {
  double median = kNotMeasured, least = kNotMeasured, largest = kNotMeasured;
};
SeedRange RangeOf(std::vector<double> values);

// A configuration over all seeds whose search found something.
struct Table1Row {
  std::string name;
  int seeds = 0;
  SeedRange drop_from_max;  // 1 − best / largest met, of the measure searched: what the paper has
  SeedRange drop_from_start;  // 1 − best / start
  SeedRange sum_drop;         // 1 − |D_anim| at the best / its largest, the paper's sum
  SeedRange best, young_modulus, poisson_ratio;  // m per point, Pa, 1
  // 1 − best / value at the true parameters; > 0: the search beats the truth.
  SeedRange below_truth;
  int with_start = 0;  // seeds whose start succeeded, too
};

struct Table1Summary {
  int seeds = 0;
  std::vector<Table1Row> rows;
  // Seeds in which the last configuration does at least as well as each of the others.
  int last_is_best = 0, compared = 0;
  // Standard deviation over small turns of S_0 over the mean: of the value searched, of the sum.
  double mesh_noise = kNotMeasured, mesh_noise_of_sum = kNotMeasured;
};
Table1Summary Summarise(const Table1Study& study, const Table1Result& result);

std::string Table1Text(const Table1Study& study, const Table1Result& result);
// table1.txt, table1.json, and of the first seed's searches NAME.csv and traces.svg.
void WriteTable1(const Table1Study& study, const Table1Result& result,
                 const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_REPORT_H_
