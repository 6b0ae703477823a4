#include "geometry/surface_patches.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "geometry/farthest_first.h"

namespace lacuna {
namespace {

constexpr int kSamplesPerPatch = 40;
constexpr int kIterations = 4;
constexpr uint64_t kSeed = 1;

double SquaredDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& normal_of_a,
                       const Eigen::Vector3d& b, const Eigen::Vector3d& normal_of_b, double width) {
  return (a - b).squaredNorm() + width * width * (normal_of_a - normal_of_b).squaredNorm();
}

void SpreadCentres(const PointCloud& samples, int count, SurfacePatches* patches) {
  const auto distance = [&](int a, int b) {
    return SquaredDistance(samples.points.col(a), samples.normals.col(a), samples.points.col(b),
                           samples.normals.col(b), patches->width);
  };
  const std::vector<int> centres =
      FarthestFirst(static_cast<int>(samples.Size()), 0, count, distance);
  patches->place = samples.points(Eigen::all, centres);
  patches->normal = samples.normals(Eigen::all, centres);
}

// Moves each centre to the mean of the samples that belong to it.
void CentreOnSamples(const PointCloud& samples, SurfacePatches* patches) {
  std::vector<int> patch(static_cast<size_t>(samples.Size()));
  ParallelFor(samples.Size(), 256, [&](int64_t j) {
    patch[static_cast<size_t>(j)] = patches->PatchOf(samples.points.col(j), samples.normals.col(j));
  });
  Eigen::Matrix3Xd place = Eigen::Matrix3Xd::Zero(3, patches->Count());
  Eigen::Matrix3Xd normal = place;
  Eigen::VectorXd count = Eigen::VectorXd::Zero(patches->Count());
  for (Eigen::Index j = 0; j < samples.Size(); ++j) {
    const int c = patch[static_cast<size_t>(j)];
    place.col(c) += samples.points.col(j);
    normal.col(c) += samples.normals.col(j);
    count[c] += 1;
  }
  for (int c = 0; c < patches->Count(); ++c) {
    if (count[c] == 0 || normal.col(c).norm() == 0) continue;
    patches->place.col(c) = place.col(c) / count[c];
    patches->normal.col(c) = normal.col(c).normalized();
  }
}

}  // namespace

int SurfacePatches::PatchOf(const Eigen::Vector3d& point, const Eigen::Vector3d& at_normal) const {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int c = 0; c < Count(); ++c) {
    const double distance = SquaredDistance(point, at_normal, place.col(c), normal.col(c), width);
    if (distance >= least) continue;
    least = distance;
    best = c;
  }
  return best;
}

SurfacePatches DivideSurface(const TriMesh& surface, int count) {
  CHECK_GT(count, 0);
  const PointCloud samples =
      EvaluateSamples(surface, SampleSurface(surface, kSamplesPerPatch * count, kSeed));
  SurfacePatches patches;
  patches.width = std::sqrt(TriangleAreas(surface).sum() / (std::numbers::pi * count));
  SpreadCentres(samples, count, &patches);
  for (int k = 0; k < kIterations; ++k) CentreOnSamples(samples, &patches);
  return patches;
}

}  // namespace lacuna
