#include "meshing/tet_quality.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Shape {
  double volume;
  double min_edge, max_edge, edge_sum;
  double radius_edge_ratio, aspect_ratio;
  double min_dihedral, max_dihedral;
};

// With the edges u, v, w from corner 0 and D = u·(v×w), the circumradius is
// |u²(v×w) + v²(w×u) + w²(u×v)| / 2|D| and the inradius |D| / Σ|face normals|.
Shape Measure(const std::array<Vector3d, 4>& corner) {
  Shape shape{0, kInfinity, 0, 0, kInfinity, kInfinity, std::numbers::pi, 0};
  for (const auto& [i, j] : kTetEdges) {
    const double length = (corner[j] - corner[i]).norm();
    shape.min_edge = std::min(shape.min_edge, length);
    shape.max_edge = std::max(shape.max_edge, length);
    shape.edge_sum += length;
  }
  const Vector3d u = corner[1] - corner[0], v = corner[2] - corner[0], w = corner[3] - corner[0];
  // Outward normals of the faces opposite to corners 0..3, with the length of twice the area.
  const std::array<Vector3d, 4> normal{(v - u).cross(w - u), w.cross(v), u.cross(w), v.cross(u)};
  const double determinant = u.dot(v.cross(w));
  shape.volume = determinant / 6;

  const Vector3d circumcentre =
      u.squaredNorm() * v.cross(w) + v.squaredNorm() * w.cross(u) + w.squaredNorm() * u.cross(v);
  const double size = std::abs(determinant);
  if (size > 0) {
    const double surface =
        normal[0].norm() + normal[1].norm() + normal[2].norm() + normal[3].norm();
    shape.radius_edge_ratio = circumcentre.norm() / (2 * size) / shape.min_edge;
    shape.aspect_ratio = shape.max_edge * surface / size / (2 * std::sqrt(6.0));
  }
  for (const auto& [i, j] : kTetEdges) {
    const double angle = std::atan2(normal[i].cross(normal[j]).norm(), -normal[i].dot(normal[j]));
    shape.min_dihedral = std::min(shape.min_dihedral, angle);
    shape.max_dihedral = std::max(shape.max_dihedral, angle);
  }
  return shape;
}

void Add(double value, Spread& spread) {
  spread.min = std::min(spread.min, value);
  spread.max = std::max(spread.max, value);
  spread.mean += value;
}

}  // namespace

TetQuality MeasureTets(const TetMesh& mesh, double radius_edge_bound, double volume_bound) {
  TetQuality quality;
  quality.nodes = mesh.NodeCount();
  quality.tets = mesh.TetCount();
  if (quality.tets == 0) return quality;

  const Spread start{kInfinity, 0, -kInfinity};
  quality.volume = quality.edge_length = quality.radius_edge_ratio = quality.aspect_ratio = start;
  quality.min_dihedral_angle = std::numbers::pi;
  quality.radius_edge_ratios.resize(quality.tets);
  quality.min_dihedral_angles.resize(quality.tets);
  for (Eigen::Index e = 0; e < quality.tets; ++e) {
    std::array<Vector3d, 4> corner;
    for (int k = 0; k < 4; ++k) corner[k] = mesh.nodes.col(mesh.tets(k, e));
    const Shape shape = Measure(corner);
    Add(shape.volume, quality.volume);
    Add(shape.radius_edge_ratio, quality.radius_edge_ratio);
    Add(shape.aspect_ratio, quality.aspect_ratio);
    quality.edge_length.min = std::min(quality.edge_length.min, shape.min_edge);
    quality.edge_length.max = std::max(quality.edge_length.max, shape.max_edge);
    quality.edge_length.mean += shape.edge_sum / 6;
    quality.min_dihedral_angle = std::min(quality.min_dihedral_angle, shape.min_dihedral);
    quality.max_dihedral_angle = std::max(quality.max_dihedral_angle, shape.max_dihedral);
    quality.radius_edge_ratios(e) = shape.radius_edge_ratio;
    quality.min_dihedral_angles(e) = shape.min_dihedral;
    // The slack allows for rounding where a bound is met exactly.
    constexpr double kSlack = 1 + 1e-9;
    quality.inverted += !(shape.volume > 0);
    quality.above_ratio +=
        radius_edge_bound > 0 && shape.radius_edge_ratio > radius_edge_bound * kSlack;
    quality.above_volume += volume_bound > 0 && shape.volume > volume_bound * kSlack;
  }
  quality.total_volume = quality.volume.mean + VolumeOfCurvature(mesh);
  for (Spread* spread :
       {&quality.volume, &quality.edge_length, &quality.radius_edge_ratio, &quality.aspect_ratio}) {
    spread->mean /= static_cast<double>(quality.tets);
  }
  return quality;
}

}  // namespace lacuna
