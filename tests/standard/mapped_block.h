// Bodies of the standard problems: the unit cube, cut into tetrahedra and mapped.
//
// A point of a body is named by its coordinates (u, v, w) in the unit cube, so that faces, edges
// and points are the same on every mesh. Lengths are in m.
#ifndef LACUNA_STANDARD_MAPPED_BLOCK_H_
#define LACUNA_STANDARD_MAPPED_BLOCK_H_

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>

#include "core/config.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

using BlockMap = std::function<Eigen::Vector3d(const Eigen::Vector3d& uvw)>;

// Reads one of
//   {shape: box, size: [x, y, z], origin: [x, y, z]}  origin: the corner u = v = w = 0; default 0
//   {shape: panel, corner_00: [x, y], …, thickness}   corner_10 is that at u = 1, v = 0
//   {shape: elliptic_plate, inner: [x, y], outer: [x, y], thickness}  a quarter; u goes outwards,
//                                                     v from the x axis to the y axis
//   {shape: paraboloid, size: [x, y, z], radius}      a quarter of a block whose lower face, w = 0,
//                                                     is z = (x² + y²)/(2 radius); cells become
//                                                     smaller towards its vertex
//   {shape: round_bar, radius, length}                along z; the sides of the square u, v become
//                                                     quarters of the circle about x = y = 0
//   {shape: cylinder_taper_sphere}                    the quarter of NAFEMS LE11; u goes outwards,
//                                                     v from the x axis to the y axis, w upwards;
//                                                     the parts meet at w = 1/2 and w = 3/4
BlockMap ReadBlockMap(const Config& config);

// A part of the block: the points at which the given coordinates have these values.
struct BlockPart {
  std::array<std::optional<double>, 3> at;
  bool Contains(const Eigen::Vector3d& uvw) const;
};
// Reads {u: 0, w: 1}.
BlockPart ReadBlockPart(const Config& config);

struct MappedBlock {
  TetMesh mesh;
  Eigen::Matrix3Xd uvw;  // of each node

  // The nodes of a part, ascending. Throws InputError where there is none.
  Eigen::VectorXi NodesOf(const BlockPart& part) const;
};

// cells[0] × cells[1] × cells[2] cells of six tetrahedra. The midpoints of quadratic elements are
// mapped too, so that these are curved.
MappedBlock MeshBlock(const BlockMap& map, const std::array<int, 3>& cells, int order);

}  // namespace lacuna

#endif  // LACUNA_STANDARD_MAPPED_BLOCK_H_
