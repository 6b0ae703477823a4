// The full description of an effect: `lacuna explain NAME` and `lacuna effects NAME`.
#ifndef LACUNA_APP_EXPLAIN_H_
#define LACUNA_APP_EXPLAIN_H_

#include <string>

namespace lacuna {

// Prints the whole card of this effect, and an example in YAML. Throws InputError with the nearest
// name when there is no such effect. Returns the exit status.
int Explain(const std::string& type);

}  // namespace lacuna

#endif  // LACUNA_APP_EXPLAIN_H_
