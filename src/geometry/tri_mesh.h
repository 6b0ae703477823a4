// A triangulated surface and the measures that every stage asks of it.
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

// Area of each triangle, m².
Eigen::VectorXd TriangleAreas(const TriMesh& mesh);

// Unit normals of the triangles (3 × m) and of the vertices (3 × n, area-weighted). A triangle
// without area and a vertex without triangles have the normal 0.
Eigen::Matrix3Xd TriangleNormals(const TriMesh& mesh);
Eigen::Matrix3Xd VertexNormals(const TriMesh& mesh);

// A third of the area of the triangles around each vertex, m².
Eigen::VectorXd VertexAreas(const TriMesh& mesh);

// The signed volume that a closed mesh encloses (divergence theorem), m³; positive when outward.
double EnclosedVolume(const TriMesh& mesh);

Eigen::AlignedBox3d BoundingBox(const Eigen::Matrix3Xd& points);

// The length that relative errors refer to: the diagonal of the bounding box, m.
double BoundingBoxDiagonal(const Eigen::Matrix3Xd& points);

// `count` points spread over the surface with density proportional to area (stratified, so that
// the same seed gives the same points), with the normals of their triangles. Fixed barycentric
// coordinates let the same material points be followed through a deformation.
struct SurfaceSamples {
  Eigen::VectorXi triangle;      // n
  Eigen::Matrix3Xd barycentric;  // 3 × n, columns sum to 1
};
SurfaceSamples SampleSurface(const TriMesh& mesh, Eigen::Index count, uint64_t seed);
PointCloud EvaluateSamples(const TriMesh& mesh, const SurfaceSamples& samples);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TRI_MESH_H_
