#include "registration/warped_body.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace lacuna {
namespace {

Eigen::Vector3d BodyPoint(const Eigen::Vector3d& direction) {
  const double radius = 1.0 + 0.2 * std::sin(3.0 * direction.x() + 2.0 * direction.y()) +
                        0.15 * std::cos(4.0 * direction.y() - 3.0 * direction.x() + direction.z());
  return radius * direction.cwiseProduct(Eigen::Vector3d(0.09, 0.05, 0.03));
}

// The area vector of the body per unit area of the sphere.
Eigen::Vector3d AreaVector(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d a = direction.unitOrthogonal(), b = direction.cross(a);
  constexpr double kStep = 1e-5;
  const auto slope = [&](const Eigen::Vector3d& t) {
    return Eigen::Vector3d((BodyPoint((direction + kStep * t).normalized()) -
                            BodyPoint((direction - kStep * t).normalized())) /
                           (2.0 * kStep));
  };
  return slope(a).cross(slope(b));
}

}  // namespace

PointCloud SampleBody(int count, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  constexpr double kLargestArea = 0.016;  // m² per unit area of the sphere, above the true maximum
  PointCloud cloud;
  cloud.points.resize(3, count);
  cloud.normals.resize(3, count);
  for (int i = 0; i < count;) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Vector3d area = AreaVector(direction);
    if (uniform(random) * kLargestArea > area.norm()) continue;
    cloud.points.col(i) = BodyPoint(direction);
    cloud.normals.col(i) = area.normalized();
    ++i;
  }
  return cloud;
}

Eigen::Matrix3Xd Warp(const Eigen::Matrix3Xd& points) {
  const double radius = 0.2 / (25.0 * std::numbers::pi / 180.0);
  Eigen::Matrix3Xd warped(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d p = points.col(i);
    const double angle = p.x() / radius, r = radius - p.z();
    warped.col(i) << r * std::sin(angle), p.y() - 0.5 * p.x() * p.z(), radius - r * std::cos(angle);
  }
  return warped;
}

PointCloud ScanOfWarpedBody(int count, uint64_t seed, const ScanFaults& faults) {
  const PointCloud body = SampleBody(count, seed);
  const Eigen::Matrix3Xd warped = Warp(body.points);
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const int outliers = static_cast<int>(faults.outliers * count);
  PointCloud scan;
  scan.points.resize(3, count + outliers);
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if (body.points(0, i) > faults.missing_beyond_x) continue;
    const Eigen::Vector3d error(normal(random), normal(random), normal(random));
    scan.points.col(kept++) = warped.col(i) + faults.noise * error;
  }
  for (int i = 0; i < outliers; ++i) {
    const Eigen::Vector3d place(uniform(random), uniform(random), uniform(random));
    scan.points.col(kept++) = place.cwiseProduct(Eigen::Vector3d(0.12, 0.08, 0.06));
  }
  scan.points.conservativeResize(3, kept);
  return scan;
}

double Rms(const Eigen::Matrix3Xd& vectors) {
  return std::sqrt(vectors.squaredNorm() / static_cast<double>(vectors.cols()));
}

}  // namespace lacuna
