// Text tables that hold all steps of a test: the rows of each step have the same value in one
// column.
#ifndef LACUNA_SCAN_STEPPED_TABLE_H_
#define LACUNA_SCAN_STEPPED_TABLE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "scan/delimited_table.h"

namespace lacuna {

struct SteppedTable {
  DelimitedTable table;
  std::vector<std::vector<Eigen::Index>> rows;  // of each step, in the order of the file
  std::vector<double> times;  // of each step, in the unit of the file; empty without a column
};

// Divides the rows of `table` by the column `step`, ascending. `time`: the column with the time of
// each row, which must be the same in all rows of a step; empty: there is none. Throws InputError
// naming file and line where a step or time is missing or the times of a step differ.
SteppedTable DivideIntoSteps(DelimitedTable table, const std::string& step,
                             const std::string& time);

// The rows of one step as a table of their own.
DelimitedTable TableOfStep(const SteppedTable& steps, size_t step);

}  // namespace lacuna

#endif  // LACUNA_SCAN_STEPPED_TABLE_H_
