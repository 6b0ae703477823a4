// Tetrahedral meshing of the volume inside a closed surface, by TetGen.
#ifndef LACUNA_MESHING_TETRAHEDRALIZE_H_
#define LACUNA_MESHING_TETRAHEDRALIZE_H_

#include <string>
#include <vector>

#include "geometry/surface_check.h"
#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"
#include "meshing/tet_quality.h"

namespace lacuna {

struct TetOptions {
  // TetGen's q: upper bound on the circumradius over the shortest edge, > 1. Lowering it gives
  // better shaped and more tetrahedra; below 1.414 TetGen is not guaranteed to terminate.
  double radius_edge_ratio = 2.0;
  // Lower bound on dihedral angles where possible, rad. Raising it (to about 0.3) removes slivers
  // at the cost of more tetrahedra; 0 keeps them.
  double min_dihedral_angle = 0.2;
  // TetGen's a (v in the paper): upper bound on the volume of a tetrahedron, m³; 0 means none.
  // Raising it gives a coarser mesh.
  double max_volume = 0;
  // Keep the triangles of the surface, so that the boundary nodes 0..n−1 are its vertices. This is
  // the better choice for a surface of uniform triangles about as large as the tetrahedra should
  // be. Otherwise TetGen splits triangles that are too large for `max_volume`.
  bool preserve_surface = true;
  // Order of the elements: 1, or 2 with straight edges and midpoints.
  int order = 1;
  // The most nodes that TetGen may add, as a guard against bounds that cannot be met.
  int max_added_nodes = 5'000'000;
};

enum class MeshStatus {
  kNotRun,
  kUsable,
  kFaultySurface,    // open, non-manifold, inside out or self-intersecting: see `surface_report`
  kTooSmallFeature,  // parts of the surface are too close to each other for TetGen
  kTooManyTets,      // the bounds would require more tetrahedra than the limit, 20 million
  kInternalError,    // TetGen failed or returned an invalid mesh
};

struct MeshResult {
  TetMesh mesh;
  TetQuality quality;
  SurfaceReport surface_report;  // report on the input
  MeshStatus status = MeshStatus::kNotRun;
  std::string message = "not run";
  std::vector<std::string> notes;  // which bounds are not met everywhere, and why

  bool IsUsable() const { return status == MeshStatus::kUsable; }
};

// A constrained Delaunay tetrahedralisation of the inside of `surface` (vertices in m), refined
// until it meets the bounds (H. Si, ACM TOMS 41, 2015, by TetGen 1.5). The surface must bound a
// volume; several separate bodies are allowed, cavities are refused. The same input gives the same
// mesh, bit by bit. A coarse surface that must be preserved, or sharp angles between its edges, can
// prevent a bound from being met everywhere; `quality` and `notes` then say so, but the mesh is
// still usable. Failures are reported in `status` and `message`; options out of their ranges are
// programming errors (CHECK). Throws OutOfMemory (core/memory_limit.h) where the mesh would exceed
// the memory limit or an allocation fails: unlike a failure, this depends on the machine.
MeshResult MeshTetrahedra(const TriMesh& surface, const TetOptions& options);

}  // namespace lacuna

#endif  // LACUNA_MESHING_TETRAHEDRALIZE_H_
