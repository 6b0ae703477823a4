// Suggestions for a misspelled name.
#ifndef LACUNA_CORE_SUGGESTION_H_
#define LACUNA_CORE_SUGGESTION_H_

#include <string>
#include <vector>

namespace lacuna {

// The one of `names` with the least Levenshtein distance to `name`, the first of several; empty if
// all are more than `farthest` edits away.
std::string Nearest(const std::string& name, const std::vector<std::string>& names, int farthest);

// `; did you mean "x"?` with the nearest of `names`, to be appended to a message. Empty if more
// than about half of the characters would have to change.
std::string Suggestion(const std::string& name, const std::vector<std::string>& names);

}  // namespace lacuna

#endif  // LACUNA_CORE_SUGGESTION_H_
