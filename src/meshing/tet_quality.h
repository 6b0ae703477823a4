// How good the tetrahedra of a mesh are.
#ifndef LACUNA_MESHING_TET_QUALITY_H_
#define LACUNA_MESHING_TET_QUALITY_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// Smallest, mean and largest of a measure over all tetrahedra.
struct Spread {
  double min = 0, mean = 0, max = 0;
};

// Shape measures are of the four corners.
struct TetQuality {
  Eigen::Index nodes = 0, tets = 0;
  double total_volume = 0;        // m³
  Spread volume;                  // m³
  Spread edge_length;             // m, every tetrahedron counting its six
  Spread radius_edge_ratio;       // circumradius over shortest edge; √6/4 ≈ 0.612 when regular
  Spread aspect_ratio;            // longest edge over 2√6 inradii; 1 when regular
  double min_dihedral_angle = 0;  // rad; 70.5° when regular
  double max_dihedral_angle = 0;  // rad
  Eigen::Index inverted = 0;      // of no volume or negative
  Eigen::Index above_ratio = 0;   // with a radius-edge ratio above the bound asked for
  Eigen::Index above_volume = 0;  // with a volume above the bound asked for
  // Of each tetrahedron, for histograms.
  Eigen::VectorXd radius_edge_ratios;
  Eigen::VectorXd min_dihedral_angles;  // rad
};

// Bounds of 0 are no bounds.
TetQuality MeasureTets(const TetMesh& mesh, double radius_edge_bound = 0, double volume_bound = 0);

}  // namespace lacuna

#endif  // LACUNA_MESHING_TET_QUALITY_H_
