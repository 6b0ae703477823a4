// What a user may have meant by a name that is not known.
#ifndef LACUNA_CORE_SUGGESTION_H_
#define LACUNA_CORE_SUGGESTION_H_

#include <string>
#include <vector>

namespace lacuna {

// `; did you mean "x"?` with the nearest of `names` (edit distance), or nothing where none is near
// enough to be what was meant.
std::string Suggestion(const std::string& name, const std::vector<std::string>& names);

}  // namespace lacuna

#endif  // LACUNA_CORE_SUGGESTION_H_
