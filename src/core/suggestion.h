// Suggestions for a misspelled name.
#ifndef LACUNA_CORE_SUGGESTION_H_
#define LACUNA_CORE_SUGGESTION_H_

#include <string>
#include <vector>

namespace lacuna {

// The entry of `names` with the smallest Levenshtein distance to `name`, the first one if there are
// several; empty if all distances are greater than `farthest`.
std::string Nearest(const std::string& name, const std::vector<std::string>& names, int farthest);

// The text `; did you mean "x"?` with the nearest of `names`, to be appended to a message. Empty if
// the distance is greater than about half of the length of `name`.
std::string Suggestion(const std::string& name, const std::vector<std::string>& names);

}  // namespace lacuna

#endif  // LACUNA_CORE_SUGGESTION_H_
