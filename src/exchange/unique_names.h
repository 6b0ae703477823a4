// Names for parts of a model in formats that restrict what a name may be.
#ifndef LACUNA_EXCHANGE_UNIQUE_NAMES_H_
#define LACUNA_EXCHANGE_UNIQUE_NAMES_H_

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace lacuna {

// `text` as a name of ASCII letters, digits and underscores that begins with a letter and has at
// most 62 characters: other bytes become underscores, and "N_" is put in front where no letter is.
std::string Identifier(std::string_view text);

// Gives no name twice.
class UniqueNames {
 public:
  explicit UniqueNames(std::set<std::string> taken = {}) : taken_(std::move(taken)) {}

  // `name`, or the first of name_2, name_3, … that is new.
  std::string Add(const std::string& name);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> next_;  // the number to try next behind a name that is taken
};

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_UNIQUE_NAMES_H_
