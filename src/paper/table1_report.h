// Table 1 as text, JSON and plots, and which claims of the paper it supports.
#ifndef LACUNA_PAPER_TABLE1_REPORT_H_
#define LACUNA_PAPER_TABLE1_REPORT_H_

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paper/table1.h"

namespace lacuna {

// Median and extremes over the seeds. With ten seeds or fewer no narrower interval is justified.
struct SeedRange {
  double median = kNotMeasured, least = kNotMeasured, largest = kNotMeasured;
};
SeedRange RangeOf(std::vector<double> values);  // values that are NaN are left out
nlohmann::json JsonOf(const SeedRange& range);  // null for what was not measured

// A configuration, summarised over all seeds whose search succeeded.
struct Table1Row {
  std::string name;
  int seeds = 0;
  SeedRange drop_from_max;    // 1 − best / largest value of the searched measure, as in the paper
  SeedRange drop_from_start;  // 1 − best / start
  SeedRange sum_drop;         // drop_from_max of the paper's sum |D_anim|
  SeedRange best, young_modulus, poisson_ratio;  // m per point, Pa, 1
  // 1 − best / value at the true parameters; positive where the search finds less than the truth
  // has.
  SeedRange below_truth;
  int with_start = 0;  // seeds whose start could be evaluated
};

struct Table1Summary {
  int seeds = 0;
  std::vector<Table1Row> rows;
  // The number of seeds in which the last configuration is at least as good as all others.
  int last_is_best = 0, compared = 0;
  // Relative standard deviation under small rotations of S_0, of the searched measure and of the
  // sum.
  double mesh_noise = kNotMeasured, mesh_noise_of_sum = kNotMeasured;
  int turns = 0;  // the number of rotated meshes that could be evaluated
};
Table1Summary Summarise(const Table1Study& study, const Table1Result& result);

// The claims of the paper and whether they hold: the end of the whole text.
std::string Table1ClaimsText(const Table1Study& study, const Table1Result& result);
std::string Table1Text(const Table1Study& study, const Table1Result& result);
// Writes table1.txt, table1.json and, for the searches of the first seed, NAME.csv and traces.svg.
void WriteTable1(const Table1Study& study, const Table1Result& result,
                 const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PAPER_TABLE1_REPORT_H_
