// A smooth path through positions that are known at some times.
#ifndef LACUNA_GEOMETRY_SMOOTH_PATH_H_
#define LACUNA_GEOMETRY_SMOOTH_PATH_H_

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "geometry/hermite.h"

namespace lacuna {

// The path x(t) through the positions x₀ … xₙ at the ascending times t₀ … tₙ.
//
// Until t₀ it rests at x₀. From there to T = tₙ it is a cubic Hermite spline, whose velocity at an
// inner time is that of the parabola through this position and its two neighbours, and at t₀ and T
// the mean velocity of the first and of the last interval.
//
// After T it is reflected through its last point (the odd extension of signal processing):
//   x(T + s) = 2 x(T) − x(T − s), s > 0,
// so that it goes as far in the time s as it came in an equally long time before. Neither the
// position nor the velocity jumps at T. A path that rested for the time s before T stays at rest.
// Errors of the positions are magnified by about 3 at most, however short the intervals are; on the
// straight line through the last two positions they would grow like 2 s / (tₙ − tₙ₋₁). The path
// goes no farther than it came: after s = T − t₀ it rests at 2 xₙ − x₀. A single position rests.
//
// The rule is meant for times s in which the velocity changes little, such as the part of a
// simulation's last step that lies after T. A path that was slowing down until T goes on by the
// distance that it covered meanwhile.
//
// `PositionOf` is called with k = 0 … n and returns xₖ, a double or an Eigen matrix.
template <typename PositionOf>
class SmoothPath {
 public:
  using Position = std::remove_cvref_t<std::invoke_result_t<PositionOf, size_t>>;

  // At least one time. What `times` refers to must outlive this.
  SmoothPath(std::span<const double> times, PositionOf position)
      : times_(times), position_(std::move(position)) {}

  Position At(double time) const {
    const size_t last = times_.size() - 1;
    if (time > times_[last]) return 2 * position_(last) - At(2 * times_[last] - time);
    const auto after = std::upper_bound(times_.begin(), times_.end(), time);
    const auto right = static_cast<size_t>(after - times_.begin());
    if (right == 0) return position_(0);
    if (right > last) return position_(last);
    const double length = Length(right - 1);
    return Interpolate(KnotOf(right - 1), KnotOf(right), length,
                       (time - times_[right - 1]) / length)
        .position;
  }

 private:
  // Of the interval between the times k and k + 1.
  double Length(size_t k) const { return times_[k + 1] - times_[k]; }
  Position MeanVelocity(size_t k) const { return (position_(k + 1) - position_(k)) / Length(k); }

  Knot<Position> KnotOf(size_t k) const {
    if (k == 0) return {position_(k), MeanVelocity(k)};
    if (k + 1 == times_.size()) return {position_(k), MeanVelocity(k - 1)};
    return {position_(k),
            VelocityOfParabola(MeanVelocity(k - 1), Length(k - 1), MeanVelocity(k), Length(k))};
  }

  std::span<const double> times_;
  PositionOf position_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SMOOTH_PATH_H_
