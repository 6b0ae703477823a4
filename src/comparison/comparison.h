// A comparison: the record that is kept, and the data that it was computed from.
#ifndef LACUNA_COMPARISON_COMPARISON_H_
#define LACUNA_COMPARISON_COMPARISON_H_

#include <optional>
#include <vector>

#include "comparison/unexplained_force.h"
#include "record/comparison_record.h"
#include "record/recorded_residuals.h"

namespace lacuna {

struct Comparison {
  ComparisonRecord record;
  // One entry for each recording of the record, in the same order.
  std::vector<RecordedResiduals> residuals;
  std::vector<std::optional<UnexplainedForce>> forces;  // absent where the model was not run again
};

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_COMPARISON_H_
