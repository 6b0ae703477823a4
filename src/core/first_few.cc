#include "core/first_few.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace lacuna {
namespace {

constexpr size_t kShown = 4;

template <typename Item>
std::string Joined(const std::vector<Item>& items) {
  const auto end = items.begin() + static_cast<std::ptrdiff_t>(std::min(kShown, items.size()));
  return fmt::format("{}{}", fmt::join(items.begin(), end, ", "),
                     end != items.end() ? fmt::format(", … ({} in all)", items.size()) : "");
}

}  // namespace

std::string FirstFew(const std::vector<std::string>& items) { return Joined(items); }
std::string FirstFew(const std::vector<int>& numbers) { return Joined(numbers); }

}  // namespace lacuna
