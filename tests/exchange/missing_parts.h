// Which parts of a model a format cannot express.
#ifndef LACUNA_TESTS_EXCHANGE_MISSING_PARTS_H_
#define LACUNA_TESTS_EXCHANGE_MISSING_PARTS_H_

#include <string>
#include <vector>

#include "exchange/counterpart.h"

namespace lacuna {

// The names of the parts without a counterpart, in their order.
inline std::vector<std::string> MissingParts(const Counterparts& counterparts) {
  std::vector<std::string> names;
  for (const Counterpart& part : Missing(counterparts)) names.push_back(part.part);
  return names;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_MISSING_PARTS_H_
