// Cubic Hermite interpolation between two times.
#ifndef LACUNA_GEOMETRY_HERMITE_H_
#define LACUNA_GEOMETRY_HERMITE_H_

namespace lacuna {

// Position and velocity, and what they change with, at one time.
template <typename Matrix>
struct Knot {
  Matrix position, velocity;
};

// The cubic through two knots `h` apart, at the fraction t of the interval.
template <typename Matrix>
Knot<Matrix> Interpolate(const Knot<Matrix>& from, const Knot<Matrix>& to, double h, double t) {
  const double s = 1 - t;
  return {(1 + 2 * t) * s * s * from.position + t * t * (3 - 2 * t) * to.position +
              h * (t * s * s * from.velocity - t * t * s * to.velocity),
          6 * t * s / h * (to.position - from.position) + s * (1 - 3 * t) * from.velocity +
              t * (3 * t - 2) * to.velocity};
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_HERMITE_H_
