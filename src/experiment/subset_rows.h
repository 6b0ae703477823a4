// The displacement of a point as image correlation measures it: over a subset around the point.
#ifndef LACUNA_EXPERIMENT_SUBSET_ROWS_H_
#define LACUNA_EXPERIMENT_SUBSET_ROWS_H_

#include <Eigen/Core>

#include "experiment/observation_matrix.h"
#include "geometry/tet_mesh.h"
#include "scan/instrument.h"

namespace lacuna {

// The observation matrix, with rows x, y and z of each of `places` (3 × n, m, on the undeformed
// object), of the value at the place of the affine function that is fitted to the positions over
// the subset by least squares, as correlation with a shape function of first order does (M. Sutton,
// J.-J. Orteu, H. Schreier, Image Correlation for Shape, Motion and Deformation Measurements,
// Springer 2009, ch. 5). In the middle of a surface this is the mean over the subset: gradients
// that are constant over it are seen as they are, curvature is smoothed. Parts of a subset beyond
// an edge of the object are left out.
//
// The square lies in the plane that touches the surface at the place, with its edges along the
// projections of the coordinate axes, as it would in images along one of them.
ObservationMatrix SubsetRows(const TetMesh& mesh, const Eigen::Matrix3Xd& places,
                             const Instrument& instrument);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SUBSET_ROWS_H_
