#include "geometry/tri_mesh.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace lacuna {
namespace {

Eigen::Vector3d Corner(const TriMesh& mesh, Eigen::Index triangle, int corner) {
  return mesh.vertices.col(mesh.triangles(corner, triangle));
}

// The vector along the normal whose length is twice the area.
Eigen::Vector3d AreaVector(const TriMesh& mesh, Eigen::Index triangle) {
  const Eigen::Vector3d a = Corner(mesh, triangle, 0);
  return (Corner(mesh, triangle, 1) - a).cross(Corner(mesh, triangle, 2) - a);
}

Eigen::Vector3d UnitOrZero(const Eigen::Vector3d& v) {
  const double length = v.stableNorm();
  return length > 0 ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

// A number in [0, 1). Unlike the standard library's distributions it is the same on every platform.
double UniformFrom(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1p-53;
}

}  // namespace

Eigen::VectorXd TriangleAreas(const TriMesh& mesh) {
  Eigen::VectorXd areas(mesh.triangles.cols());
  for (Eigen::Index t = 0; t < areas.size(); ++t) areas(t) = 0.5 * AreaVector(mesh, t).norm();
  return areas;
}

Eigen::Matrix3Xd TriangleNormals(const TriMesh& mesh) {
  Eigen::Matrix3Xd normals(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < normals.cols(); ++t)
    normals.col(t) = UnitOrZero(AreaVector(mesh, t));
  return normals;
}

Eigen::Matrix3Xd VertexNormals(const TriMesh& mesh) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d area_vector = AreaVector(mesh, t);
    for (int corner = 0; corner < 3; ++corner) {
      normals.col(mesh.triangles(corner, t)) += area_vector;
    }
  }
  for (auto normal : normals.colwise()) normal = UnitOrZero(normal);
  return normals;
}

Eigen::VectorXd VertexAreas(const TriMesh& mesh) {
  const Eigen::VectorXd triangle_areas = TriangleAreas(mesh);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      areas(mesh.triangles(corner, t)) += triangle_areas(t) / 3;
    }
  }
  return areas;
}

double EnclosedVolume(const TriMesh& mesh) {
  if (mesh.triangles.cols() == 0) return 0;
  // A reference point near the mesh reduces the cancellation between the signed cones.
  const Eigen::Vector3d apex = BoundingBox(mesh.vertices).center();
  double sixfold = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    sixfold += AreaVector(mesh, t).dot(Corner(mesh, t, 0) - apex);
  }
  return sixfold / 6;
}

Eigen::AlignedBox3d BoundingBox(const Eigen::Matrix3Xd& points) {
  Eigen::AlignedBox3d box;
  for (const auto point : points.colwise()) box.extend(Eigen::Vector3d(point));
  return box;
}

double BoundingBoxDiagonal(const Eigen::Matrix3Xd& points) {
  return points.cols() > 0 ? BoundingBox(points).diagonal().norm() : 0;
}

SurfaceSamples SampleSurface(const TriMesh& mesh, Eigen::Index count, uint64_t seed) {
  const Eigen::VectorXd areas = TriangleAreas(mesh);
  std::vector<double> area_up_to(areas.size());
  std::partial_sum(areas.begin(), areas.end(), area_up_to.begin());
  CHECK(count == 0 || (!area_up_to.empty() && area_up_to.back() > 0))
      << "a surface without area cannot be sampled";

  SurfaceSamples samples{Eigen::VectorXi(count), Eigen::Matrix3Xd(3, count)};
  std::mt19937_64 generator(seed);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double stratum = (static_cast<double>(i) + UniformFrom(generator)) / count;
    const auto found =
        std::upper_bound(area_up_to.begin(), area_up_to.end(), stratum * area_up_to.back());
    // Rounding may carry the last stratum past the end: step back to a triangle that has area.
    Eigen::Index triangle = std::min<Eigen::Index>(found - area_up_to.begin(), areas.size() - 1);
    while (areas(triangle) == 0) --triangle;

    const double root = std::sqrt(UniformFrom(generator));
    const double along = UniformFrom(generator);
    samples.triangle(i) = static_cast<int>(triangle);
    samples.barycentric.col(i) << 1 - root, root * (1 - along), root * along;
  }
  return samples;
}

PointCloud EvaluateSamples(const TriMesh& mesh, const SurfaceSamples& samples) {
  const Eigen::Index count = samples.triangle.size();
  PointCloud cloud{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const int triangle = samples.triangle(i);
    cloud.points.col(i).setZero();
    for (int corner = 0; corner < 3; ++corner) {
      cloud.points.col(i) += samples.barycentric(corner, i) * Corner(mesh, triangle, corner);
    }
    cloud.normals.col(i) = UnitOrZero(AreaVector(mesh, triangle));
  }
  return cloud;
}

}  // namespace lacuna
