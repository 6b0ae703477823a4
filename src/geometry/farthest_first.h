// Points spread evenly, chosen among many.
#ifndef LACUNA_GEOMETRY_FARTHEST_FIRST_H_
#define LACUNA_GEOMETRY_FARTHEST_FIRST_H_

#include <algorithm>
#include <limits>
#include <vector>

namespace lacuna {

// `count` of the points 0 … size − 1: `first`, then always the one farthest from all before it
// (Gonzalez, Theor. Comput. Sci. 38, 1985). Of equally far ones the first is taken.
// `distance(i, j)`: of two points, or any growing function of it. 0 < count ≤ size.
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
