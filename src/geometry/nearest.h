// Nearest points of clouds and of surfaces.
#ifndef LACUNA_GEOMETRY_NEAREST_H_
#define LACUNA_GEOMETRY_NEAREST_H_

#include <Eigen/Core>
#include <memory>

#include "geometry/tri_mesh.h"

namespace lacuna {

// For each query point the nearest point of a surface. The search structure is built once and keeps
// its own copy. Of equally near triangles the first is taken; a query that is not finite gets
// triangle −1, distance ∞ and NaN. The surface must have triangles.
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

  SurfaceHits Nearest(const Eigen::Matrix3Xd& queries) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// The same for a cloud of points, which must not be empty.
struct PointHits {
  Eigen::MatrixXi index;     // k × n, nearest first
  Eigen::MatrixXd distance;  // k × n, m
};
class PointSearch {
 public:
  explicit PointSearch(const Eigen::Matrix3Xd& points);
  ~PointSearch();
  PointSearch(PointSearch&&) noexcept;
  PointSearch& operator=(PointSearch&&) noexcept;

  // k ≤ the number of points.
  PointHits Nearest(const Eigen::Matrix3Xd& queries, int k = 1) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_NEAREST_H_
