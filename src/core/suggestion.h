// What a user may have meant by a name that is not known.
#ifndef LACUNA_CORE_SUGGESTION_H_
#define LACUNA_CORE_SUGGESTION_H_

#include <string>
#include <vector>

namespace lacuna {

// The nearest of `names` that is at most `farthest` edits away; "": none is.
std::string Nearest(const std::string& name, const std::vector<std::string>& names, int farthest);

// `; did you mean "x"?` with the nearest of `names`, or "" where none is near enough to be meant.
std::string Suggestion(const std::string& name, const std::vector<std::string>& names);

}  // namespace lacuna

#endif  // LACUNA_CORE_SUGGESTION_H_
