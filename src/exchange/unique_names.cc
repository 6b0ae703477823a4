#include "exchange/unique_names.h"

#include <fmt/format.h>

#include <cctype>

namespace lacuna {

std::string Identifier(std::string_view text) {
  constexpr size_t kLongest = 60;
  std::string name;
  for (const unsigned char letter : text.substr(0, kLongest))
    name += letter < 128 && std::isalnum(letter) != 0 ? static_cast<char>(letter) : '_';
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name[0])) == 0) name = "N_" + name;
  return name;
}

std::string UniqueNames::Add(const std::string& name) {
  if (taken_.insert(name).second) return name;
  int& number = next_.try_emplace(name, 2).first->second;
  std::string unique;
  do {
    unique = fmt::format("{}_{}", name, number++);
  } while (!taken_.insert(unique).second);
  return unique;
}

}  // namespace lacuna
