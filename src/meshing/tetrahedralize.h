// A tetrahedral mesh inside a closed surface.
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
  // q: the radius of a tetrahedron's circumsphere over its shortest edge stays below this, > 1.
  // Lowering it makes tetrahedra more even and more numerous; below 1.414 TetGen need not end.
  double radius_edge_ratio = 2.0;
  // Dihedral angles stay above this where possible, rad. Raising it (to 0.3 or so) removes slivers
  // at the cost of more tetrahedra; 0 leaves them.
  double min_dihedral_angle = 0.2;
  // v: the largest volume of a tetrahedron, m³; 0 sets no limit. Raising it makes coarser meshes.
  double max_volume = 0;
  // Keep the triangles of the surface as they are, so that boundary nodes 0..n−1 are its vertices:
  // the better choice for even triangles about as large as the tetrahedra should be. Otherwise
  // TetGen splits triangles that are too coarse for `max_volume`.
  bool preserve_surface = true;
  // Order of the result, 1 or 2 (straight edges with midpoints).
  int order = 1;
  // The most nodes that may be added: a guard against a bound that cannot be met.
  int max_added_nodes = 5'000'000;
};

enum class MeshStatus {
  kNotRun,
  kUsable,
  kFaultySurface,    // open, non-manifold, inside out or self-intersecting: see `surface_report`
  kTooSmallFeature,  // parts of the surface all but touch
  kOutOfMemory,
  kInternalError,  // TetGen gave up
};

struct MeshResult {
  TetMesh mesh;
  TetQuality quality;
  SurfaceReport surface_report;  // of the input
  MeshStatus status = MeshStatus::kNotRun;
  std::string message = "not run";
  std::vector<std::string> notes;  // bounds that were not met everywhere, and why

  bool IsUsable() const { return status == MeshStatus::kUsable; }
};

// Constrained Delaunay tetrahedra inside `surface`, refined to the bounds (Si 2015, by TetGen 1.5).
// The surface must bound a volume; several bodies beside each other may share one mesh, cavities
// are refused. The same input gives the same mesh, bit by bit. Bounds that are not met everywhere
// (a coarse surface that must be kept, sharp angles between its edges) stand in `quality` and
// `notes`; they do not make the mesh unusable.
MeshResult MeshTetrahedra(const TriMesh& surface, const TetOptions& options);

}  // namespace lacuna

#endif  // LACUNA_MESHING_TETRAHEDRALIZE_H_
