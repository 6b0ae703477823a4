// Quality measures of the tetrahedra of a mesh.
#ifndef LACUNA_MESHING_TET_QUALITY_H_
#define LACUNA_MESHING_TET_QUALITY_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// The smallest, mean and largest value of a measure over all tetrahedra.
struct Spread {
  double min = 0, mean = 0, max = 0;
};

// All measures but the total volume refer to the four corners, also for quadratic tetrahedra.
struct TetQuality {
  Eigen::Index nodes = 0, tets = 0;
  double total_volume = 0;        // m³, with the curved edges of quadratic tetrahedra
  Spread volume;                  // m³
  Spread edge_length;             // m; an edge counts once for each of its tetrahedra
  Spread radius_edge_ratio;       // circumradius over shortest edge; √6/4 ≈ 0.612 if regular
  Spread aspect_ratio;            // longest edge over 2√6 inradii; 1 if regular
  double min_dihedral_angle = 0;  // rad; 70.5° if regular
  double max_dihedral_angle = 0;  // rad
  Eigen::Index inverted = 0;      // tetrahedra of zero or negative volume
  Eigen::Index above_ratio = 0;   // tetrahedra above the requested radius-edge ratio
  Eigen::Index above_volume = 0;  // tetrahedra above the requested volume
  // One value for each tetrahedron, for histograms.
  Eigen::VectorXd radius_edge_ratios;
  Eigen::VectorXd min_dihedral_angles;  // rad
};

// Measures all tetrahedra and counts those above the bounds: the radius-edge ratio and the volume
// (m³). A bound of 0 means none. All values are 0 for a mesh without tetrahedra. A flat tetrahedron
// counts as inverted, and its ratios may be infinite.
TetQuality MeasureTets(const TetMesh& mesh, double radius_edge_bound = 0, double volume_bound = 0);

}  // namespace lacuna

#endif  // LACUNA_MESHING_TET_QUALITY_H_
