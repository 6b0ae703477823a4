#include "core/suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace lacuna {
namespace {

int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string Nearest(const std::string& name, const std::vector<std::string>& names, int farthest) {
  std::string nearest;
  int distance = farthest + 1;
  for (const std::string& candidate : names) {
    const int d = EditDistance(name, candidate);
    if (d >= distance) continue;
    distance = d;
    nearest = candidate;
  }
  return nearest;
}

std::string Suggestion(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = Nearest(name, names, static_cast<int>(name.size()) / 2 + 1);
  return nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest);
}

}  // namespace lacuna
