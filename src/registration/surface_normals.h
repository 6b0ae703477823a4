// Estimation of the normals and the spacing of a cloud from the neighbourhoods of its points.
#ifndef LACUNA_REGISTRATION_SURFACE_NORMALS_H_
#define LACUNA_REGISTRATION_SURFACE_NORMALS_H_

#include <Eigen/Core>

#include "registration/block_tree.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// The normals (3 × n, unit length, of either sign): for each point the direction of least variance
// of its neighbours, weighted by a Gaussian whose width is 1.5 times the local spacing (that of the
// sixteen points of its block). The normal is 0 if the neighbours do not span a plane.
Eigen::Matrix3Xd EstimateNormals(const BlockTree& cloud, const GaussianKernels& kernels);

// The distance between neighbours on the surface (the square root of the area per point), as the
// median over the blocks, in the unit of the cloud. 0 if no block spans a surface.
double SurfaceSpacing(const BlockTree& cloud);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_SURFACE_NORMALS_H_
