#include "registration/surface_alignment.h"

#include <utility>

namespace lacuna {

Alignment Align(const PointCloud& points, const PointCloud& state, const CpdOptions& options,
                const DisplacementField* previous) {
  CpdResult registration = RegisterNonrigid(points, state, options, previous);
  Alignment alignment;
  alignment.status = registration.status;
  alignment.message = std::move(registration.message);
  if (registration.displaced.cols() != points.Size()) return alignment;
  alignment.displacement = registration.displaced - points.points;
  alignment.weight = std::move(registration.weight);
  alignment.standard_deviation = registration.field.StandardDeviation(points.points);
  alignment.field = std::move(registration.field);
  return alignment;
}

}  // namespace lacuna
