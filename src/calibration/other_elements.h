// Another mesh of the body of a study, with elements of another size.
#ifndef LACUNA_CALIBRATION_OTHER_ELEMENTS_H_
#define LACUNA_CALIBRATION_OTHER_ELEMENTS_H_

#include <optional>

#include "geometry/tet_mesh.h"
#include "prediction/prediction_study.h"

namespace lacuna {

struct OtherElements {
  TetMesh mesh;      // of the order of the study's own mesh
  double ratio = 1;  // mean volume of the study's elements over the mean volume of these
};

// A mesh of the study's body whose elements have about 1/`ratio` of the volume of those of `own`,
// the study's mesh. The reference shape is meshed anew with another `mesh.max_volume`. Where that
// leaves the elements much as they are, because the triangles of a preserved surface determine
// them, because no `mesh.max_volume` was given or because the mesh itself was given, smaller
// elements are made by dividing the triangles of the boundary of `own`, too. `ratio` of the result
// is that of the meshes, which only roughly is the one that was asked for.
//
// Returns nothing where such a mesh cannot be made: for sheets, where regions list nodes of the
// surface, where the elements should be larger than a given mesh or surface allows, and where
// TetGen fails.
std::optional<OtherElements> MeshWithOtherElements(const PredictionStudy& study, const TetMesh& own,
                                                   double ratio);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_OTHER_ELEMENTS_H_
