// Orients the normals of a scanned surface, i.e. decides which of its sides is outside.
#ifndef LACUNA_SCAN_NORMAL_ORIENTATION_H_
#define LACUNA_SCAN_NORMAL_ORIENTATION_H_

#include <Eigen/Core>

#include "scan/frame.h"

namespace lacuna {

enum class OrientationMethod {
  kNotRun,
  kGiven,              // the normals came with the points
  kSensorOfEachPoint,  // each point faces the sensor that saw it
  kSensorsAround,      // signs are propagated, then each part faces the sensors
  kPropagation         // signs are propagated, then each part faces outward
};

struct Orientation {
  OrientationMethod method = OrientationMethod::kNotRun;
  int component_count = 0;           // connected parts of the neighbour graph
  int doubtful_component_count = 0;  // parts of which either side may be outside, such as flat
                                     // sheets without a sensor
  double disagreement = -1;  // 0 (best) to 1: the fraction of neighbours side by side on the
                             // surface and nearly parallel (lines within 45°) whose normals point
                             // in opposite directions; −1: not run
};

// Flips those of the unit normals (3 × n) of `points` (3 × n, m) that point inward.
//
// A point whose sensor is known faces that sensor; if the ray only grazes the surface, the
// neighbours of the point decide. Without the sensor of each point, signs are propagated along a
// minimum spanning tree of the graph of the `neighbours` nearest points (Hoppe et al. 1992). Across
// each edge of the tree the normal is reflected at the bisecting plane of the edge, which carries
// signs correctly around sharp edges and across thin sheets (criteria compared in König & Gumhold
// 2009). Each connected part is then flipped as a whole to face the sensors or, when no sensor is
// known, such that the outermost points of the cloud face outward.
Orientation OrientNormals(const Eigen::Matrix3Xd& points, const Sensors& sensors, int neighbours,
                          Eigen::Matrix3Xd* normals);

}  // namespace lacuna

#endif  // LACUNA_SCAN_NORMAL_ORIENTATION_H_
