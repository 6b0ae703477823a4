// A triangulated surface with its areas, normals, volume and random samples.
#ifndef LACUNA_GEOMETRY_TRI_MESH_H_
#define LACUNA_GEOMETRY_TRI_MESH_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "geometry/point_cloud.h"

namespace lacuna {

struct TriMesh {
  Eigen::Matrix3Xd vertices;   // 3 × n, m
  Eigen::Matrix3Xi triangles;  // 3 × m, 0-based, counter-clockwise seen from outside
};

// The area of each triangle, m².
Eigen::VectorXd TriangleAreas(const TriMesh& mesh);

// The unit normals of the triangles (3 × m) and of the vertices (3 × n, area-weighted means). The
// normal of a triangle without area and of a vertex without triangles is 0.
Eigen::Matrix3Xd TriangleNormals(const TriMesh& mesh);
Eigen::Matrix3Xd VertexNormals(const TriMesh& mesh);

// A third of the total area of the triangles around each vertex, m².
Eigen::VectorXd VertexAreas(const TriMesh& mesh);

// The signed volume (m³) that a closed mesh encloses, by the divergence theorem; positive if the
// mesh is oriented outward.
double EnclosedVolume(const TriMesh& mesh);

// The axis-aligned bounding box of `points` (3 × n), in their unit; empty for no points.
Eigen::AlignedBox3d BoundingBox(const Eigen::Matrix3Xd& points);

// The diagonal of the bounding box (m), the length that relative errors refer to; 0 for no points.
double BoundingBoxDiagonal(const Eigen::Matrix3Xd& points);

// Points on a surface by fixed barycentric coordinates, so that the same material points can be
// followed through a deformation.
struct SurfaceSamples {
  Eigen::VectorXi triangle;      // n
  Eigen::Matrix3Xd barycentric;  // 3 × n, columns sum to 1
};
// Draws `count` points with a density proportional to area, by stratified sampling. The same seed
// gives the same points on every platform. CHECKs that the surface has an area.
SurfaceSamples SampleSurface(const TriMesh& mesh, Eigen::Index count, uint64_t seed);
// The samples as points (m) with the unit normals of their triangles. `mesh` may be a deformed
// state of the mesh that was sampled.
PointCloud EvaluateSamples(const TriMesh& mesh, const SurfaceSamples& samples);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TRI_MESH_H_
