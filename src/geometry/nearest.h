// Nearest-point queries on point clouds (point_search.cc) and triangulated surfaces
// (surface_search.cc).
//
// Both search structures are built once, keep their own copy of the data, and may be queried from
// several threads. An empty cloud or surface is a programming error (CHECK).
#ifndef LACUNA_GEOMETRY_NEAREST_H_
#define LACUNA_GEOMETRY_NEAREST_H_

#include <Eigen/Core>
#include <memory>

#include "geometry/tri_mesh.h"

namespace lacuna {

// The nearest point of a surface for each of n query points. If several triangles are equally near,
// the first is taken. A query that is not finite gets triangle −1, distance ∞ and NaN for the rest.
struct SurfaceHits {
  Eigen::Matrix3Xd point;        // 3 × n, m, on the surface
  Eigen::VectorXi triangle;      // n
  Eigen::Matrix3Xd barycentric;  // 3 × n
  Eigen::VectorXd distance;      // n, m, ≥ 0
};

class SurfaceSearch {
 public:
  explicit SurfaceSearch(const TriMesh& mesh);
  ~SurfaceSearch();
  SurfaceSearch(SurfaceSearch&&) noexcept;
  SurfaceSearch& operator=(SurfaceSearch&&) noexcept;

  // `queries`: 3 × n, m.
  SurfaceHits Nearest(const Eigen::Matrix3Xd& queries) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// The k nearest points of a cloud for each of n query points.
struct PointHits {
  Eigen::MatrixXi index;     // k × n, the nearest first
  Eigen::MatrixXd distance;  // k × n, m
};

class PointSearch {
 public:
  explicit PointSearch(const Eigen::Matrix3Xd& points);
  ~PointSearch();
  PointSearch(PointSearch&&) noexcept;
  PointSearch& operator=(PointSearch&&) noexcept;

  // `queries`: 3 × n, m; 1 ≤ k ≤ the number of points in the cloud.
  PointHits Nearest(const Eigen::Matrix3Xd& queries, int k = 1) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_NEAREST_H_
