// Which side of a scanned surface is outside.
#ifndef LACUNA_SCAN_NORMAL_ORIENTATION_H_
#define LACUNA_SCAN_NORMAL_ORIENTATION_H_

#include <Eigen/Core>

#include "scan/frame.h"

namespace lacuna {

enum class OrientedBy { kNotRun, kGiven, kSensorOfEachPoint, kSensorsAround, kPropagation };

struct Orientation {
  OrientedBy by = OrientedBy::kNotRun;
  int component_count = 0;           // connected parts of the neighbour graph
  int doubtful_component_count = 0;  // parts for which outside and inside are nearly as likely:
                                     // flat sheets without a sensor
  double disagreement = -1;  // fraction of the nearly parallel neighbours (angle of the lines
                             // < 45°, apart by less than their tangent distance) whose
                             // normals point opposite ways; 0 is best, −1: not run
};

// Flips the unit normals (3 × n) of `points` so that they point outward.
//   A point whose sensor is known faces it; where the ray only grazes the surface, its neighbours
// decide. Otherwise signs spread along a minimum spanning tree of the `neighbours`-nearest graph
// (Hoppe et al. 1992), across each edge after reflecting the normal at the edge's bisecting plane,
// which carries signs around sharp edges and across thin sheets (criteria compared in König &
// Gumhold 2009). Each connected part is then turned as a whole towards the sensors, or, without
// any, so that the outermost points of the cloud face outward.
Orientation OrientNormals(const Eigen::Matrix3Xd& points, const Sensors& sensors, int neighbours,
                          Eigen::Matrix3Xd* normals);

}  // namespace lacuna

#endif  // LACUNA_SCAN_NORMAL_ORIENTATION_H_
