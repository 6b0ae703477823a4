// What becomes of each part of a model in a file format.
#ifndef LACUNA_EXCHANGE_COUNTERPART_H_
#define LACUNA_EXCHANGE_COUNTERPART_H_

#include <string>
#include <vector>

#include "exchange/portable_model.h"

namespace lacuna {

struct Counterpart {
  enum class Kind {
    kExact,      // the format has the same law
    kConverted,  // re-expressed by a formula, which `how` states
    kNone        // left out; `how` says why
  };
  std::string part;  // the effect's name in the catalogue, or another part of the model
  Kind kind = Kind::kNone;
  std::string how;
};
using Counterparts = std::vector<Counterpart>;

// The parts that have no counterpart.
Counterparts Missing(const Counterparts& counterparts);
// One line for each: "gravity: *DLOAD, GRAV", "corotational: converted: …", "drag: none: …".
std::vector<std::string> CounterpartLines(const Counterparts& counterparts);
// Where the model comes from, its units and its parameters, one line each, for the comment at the
// top of a file.
std::vector<std::string> ProvenanceLines(const PortableModel& model);
// The lines as paragraphs of at most 100 characters, with `prefix` in front of each line.
std::string Commented(const std::vector<std::string>& lines, const std::string& prefix);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_COUNTERPART_H_
