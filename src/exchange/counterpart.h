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
// A text of the user's for one line of a comment: control characters become spaces.
std::string CommentText(std::string text);
// CommentText() for XML, where two hyphens would end the comment.
std::string XmlCommentText(const std::string& text);
// The comment at the top of a file: where the model comes from, its units, its parameters and what
// becomes of its parts, in lines of at most 100 characters with `prefix` in front of each.
std::string FileComment(const PortableModel& model, const Counterparts& counterparts,
                        const std::string& prefix);
// FileComment() as a comment of an XML file.
std::string XmlComment(const PortableModel& model, const Counterparts& counterparts);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_COUNTERPART_H_
