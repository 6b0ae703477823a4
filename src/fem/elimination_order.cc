#include "fem/elimination_order.h"

#include <glog/logging.h>
#include <metis.h>

#include <mutex>
#include <numeric>

#include "core/process_random.h"

namespace lacuna {

EliminationOrder NestedDissection(const BlockPattern& pattern, const std::vector<char>& fixed) {
  CHECK_EQ(fixed.size(), static_cast<size_t>(pattern.nodes));
  std::vector<int> free_nodes, number(pattern.nodes, -1);
  for (int i = 0; i < pattern.nodes; ++i) {
    if (fixed[i]) continue;
    number[i] = static_cast<int>(free_nodes.size());
    free_nodes.push_back(i);
  }

  std::vector<idx_t> begin(1, 0), neighbour;
  for (const int i : free_nodes) {
    for (int k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k) {
      const int j = number[pattern.column[k]];
      if (j >= 0 && j != number[i]) neighbour.push_back(j);
    }
    begin.push_back(static_cast<idx_t>(neighbour.size()));
  }

  idx_t count = static_cast<idx_t>(free_nodes.size());
  std::vector<idx_t> order(count), place(count);
  std::iota(order.begin(), order.end(), 0);
  if (!neighbour.empty()) {
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = 1;
    // METIS installs signal handlers and uses the random numbers of the process.
    const std::lock_guard lock(ProcessRandomMutex());
    const int status = METIS_NodeND(&count, begin.data(), neighbour.data(), nullptr, options,
                                    order.data(), place.data());
    CHECK_EQ(status, METIS_OK) << "METIS could not order the nodes";
  }

  EliminationOrder result;
  result.place.assign(pattern.nodes, -1);
  for (const idx_t k : order) {
    result.place[free_nodes[k]] = static_cast<int>(result.node.size());
    result.node.push_back(free_nodes[k]);
  }
  return result;
}

}  // namespace lacuna
