// Cubic Hermite interpolation between two times.
#ifndef LACUNA_GEOMETRY_HERMITE_H_
#define LACUNA_GEOMETRY_HERMITE_H_

namespace lacuna {

// Positions and velocities at one time. `Matrix` is any Eigen type; the unit of velocity is that of
// position per unit of time.
template <typename Matrix>
struct Knot {
  Matrix position, velocity;
};

// The value of the cubic that interpolates positions and velocities of two knots, `h` > 0 apart in
// time, at the fraction t ∈ [0, 1] of the interval:
//   x(t) = (1 + 2t)(1 − t)² x₀ + t²(3 − 2t) x₁ + h (t (1 − t)² v₀ − t² (1 − t) v₁).
template <typename Matrix>
Matrix InterpolatePosition(const Knot<Matrix>& from, const Knot<Matrix>& to, double h, double t) {
  const double s = 1 - t;
  return (1 + 2 * t) * s * s * from.position + t * t * (3 - 2 * t) * to.position +
         h * (t * s * s * from.velocity - t * t * s * to.velocity);
}

// The value and the velocity of the same cubic.
template <typename Matrix>
Knot<Matrix> Interpolate(const Knot<Matrix>& from, const Knot<Matrix>& to, double h, double t) {
  const double s = 1 - t;
  return {InterpolatePosition(from, to, h, t), 6 * t * s / h * (to.position - from.position) +
                                                   s * (1 - 3 * t) * from.velocity +
                                                   t * (3 * t - 2) * to.velocity};
}

// The velocity at the middle one of three points, of the parabola through them, from the mean
// velocities in the two intervals and the lengths of these (s).
template <typename Matrix>
Matrix VelocityOfParabola(const Matrix& velocity_before, double length_before,
                          const Matrix& velocity_after, double length_after) {
  return (length_after * velocity_before + length_before * velocity_after) /
         (length_before + length_after);
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_HERMITE_H_
