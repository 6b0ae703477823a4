// Normals of a cloud from the points around each, for the normal-weighted M-step.
#ifndef LACUNA_REGISTRATION_SURFACE_NORMALS_H_
#define LACUNA_REGISTRATION_SURFACE_NORMALS_H_

#include <Eigen/Core>

#include "registration/block_tree.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// The direction of least spread of the neighbours of each point, weighted by a Gaussian as wide as
// about 1.5 times the local spacing (that of the sixteen points of its block): 3 × n, unit length,
// of either sign. Where the neighbours do not span a plane the normal is 0.
Eigen::Matrix3Xd EstimateNormals(const BlockTree& cloud, const GaussianKernels& kernels);

// The distance between neighbours on a surface, the median over the blocks, in units of the cloud.
double SurfaceSpacing(const BlockTree& cloud);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_SURFACE_NORMALS_H_
