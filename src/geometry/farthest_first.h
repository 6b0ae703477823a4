// Choosing a few evenly spread points among many (farthest-point sampling).
#ifndef LACUNA_GEOMETRY_FARTHEST_FIRST_H_
#define LACUNA_GEOMETRY_FARTHEST_FIRST_H_

#include <algorithm>
#include <limits>
#include <vector>

namespace lacuna {

// Returns `count` of the points 0 … size − 1, 0 < count ≤ size: `first`, and then repeatedly the
// point whose distance from the nearest chosen one is largest (Gonzalez, Theor. Comput. Sci. 38,
// 1985). The first of several equally distant points is taken. `distance(i, j)` is the distance of
// two points or any increasing function of it. Costs count · size evaluations of `distance`.
template <class Distance>
std::vector<int> FarthestFirst(int size, int first, int count, const Distance& distance) {
  std::vector<double> away(static_cast<size_t>(size), std::numeric_limits<double>::infinity());
  std::vector<int> chosen = {first};
  while (static_cast<int>(chosen.size()) < count) {
    for (int k = 0; k < size; ++k) away[k] = std::min(away[k], distance(k, chosen.back()));
    chosen.push_back(static_cast<int>(std::max_element(away.begin(), away.end()) - away.begin()));
  }
  return chosen;
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_FARTHEST_FIRST_H_
