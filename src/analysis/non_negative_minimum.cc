#include "analysis/non_negative_minimum.h"

#include <algorithm>
#include <utility>

namespace lacuna {
namespace {

class ActiveSetSearch {
 public:
  using Indices = std::vector<Eigen::Index>;

  ActiveSetSearch(const MinimizeWithZeros& minimize, const Indices& restricted)
      : minimize_(minimize), restricted_(restricted), here_(Start()) {}

  NonNegativeMinimum Run() && {
    Indices rejected;
    for (;;) {
      const Eigen::Index released = SteepestBut(rejected);
      if (released < 0) return {std::move(here_.minimum.at), std::move(here_.zeros)};
      Point next = Released(released);
      // Not so where the slope is negative by rounding only.
      if (next.minimum.value < here_.minimum.value) {
        here_ = std::move(next);
        rejected.clear();
      } else {
        rejected.push_back(released);
      }
    }
  }

 private:
  struct Point {
    Indices zeros;
    MinimumWithZeros minimum;
  };

  Point With(Indices zeros) const {
    std::sort(zeros.begin(), zeros.end());
    MinimumWithZeros minimum = minimize_(zeros);
    return {std::move(zeros), std::move(minimum)};
  }

  // The restricted arguments that are not allowed as they are.
  Indices NegativesOf(const Eigen::VectorXd& at) const {
    Indices negatives;
    for (const Eigen::Index k : restricted_)
      if (!(at[k] >= 0)) negatives.push_back(k);
    return negatives;
  }

  Point Start() const {
    Point point = With({});
    for (;;) {
      const Indices negatives = NegativesOf(point.minimum.at);
      if (negatives.empty()) return point;
      Indices zeros = std::move(point.zeros);
      zeros.insert(zeros.end(), negatives.begin(), negatives.end());
      point = With(std::move(zeros));
    }
  }

  // The held argument by which f falls most steeply; −1: it falls by none.
  Eigen::Index SteepestBut(const Indices& rejected) const {
    Eigen::Index steepest = -1;
    double least = 0;
    for (size_t k = 0; k < here_.zeros.size(); ++k) {
      const double slope = here_.minimum.slopes[static_cast<Eigen::Index>(k)];
      if (!(slope < least) || std::count(rejected.begin(), rejected.end(), here_.zeros[k]) > 0)
        continue;
      steepest = here_.zeros[k];
      least = slope;
    }
    return steepest;
  }

  // The minimum where this argument is not held any more. On the way to it, each argument that
  // would become negative is held in its turn.
  Point Released(Eigen::Index argument) const {
    Eigen::VectorXd at = here_.minimum.at;
    Indices zeros = here_.zeros;
    std::erase(zeros, argument);
    for (;;) {
      Point point = With(zeros);
      const Indices negatives = NegativesOf(point.minimum.at);
      if (negatives.empty()) return point;
      const Eigen::VectorXd way = point.minimum.at - at;
      double share = 1;
      Eigen::Index first = negatives.front();
      for (const Eigen::Index k : negatives)
        if (const double until_zero = at[k] / -way[k]; until_zero < share) {
          share = until_zero;
          first = k;
        }
      at += share * way;
      at[first] = 0;
      zeros.push_back(first);
    }
  }

  const MinimizeWithZeros& minimize_;
  const Indices& restricted_;
  Point here_;
};

}  // namespace

NonNegativeMinimum MinimizeNonNegative(const MinimizeWithZeros& minimize,
                                       const std::vector<Eigen::Index>& restricted) {
  return ActiveSetSearch(minimize, restricted).Run();
}

}  // namespace lacuna
