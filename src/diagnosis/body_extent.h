// The size of a body at rest along its principal axes, and places that are spread evenly in it.
#ifndef LACUNA_DIAGNOSIS_BODY_EXTENT_H_
#define LACUNA_DIAGNOSIS_BODY_EXTENT_H_

#include <Eigen/Core>

#include "fem/body.h"

namespace lacuna {

struct BodyExtent {
  Eigen::Vector3d centre;  // m, of mass
  Eigen::Matrix3d axis;    // columns: principal axes, the longest first; their largest component is
                           // positive
  Eigen::Vector3d length;  // m, along the axes
  // The centres of parts of about equal volume (3 × places, m), and the distance below which two of
  // them are neighbours, m. Empty for a bar, whose places lie along its length.
  Eigen::Matrix3Xd places;
  double spacing = 0;

  bool IsBar() const { return places.cols() == 0; }
};

// The principal axes are those of the second moments of the lumped masses about their centre. Where
// two moments are nearly equal, their axes are chosen close to the coordinate axes.
BodyExtent MeasureExtent(const Body& body);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_BODY_EXTENT_H_
