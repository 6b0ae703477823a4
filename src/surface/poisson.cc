#include "surface/poisson.h"

#include <glog/logging.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <mutex>
#include <vector>

namespace lacuna {
namespace {

// Redirects standard output to standard error during the lifetime of an object. PCL prints messages
// on standard output, which is reserved for the results of the program.
class StandardOutputToError {
 public:
  StandardOutputToError() {
    std::fflush(stdout);
    saved_ = dup(STDOUT_FILENO);
    if (saved_ >= 0) dup2(STDERR_FILENO, STDOUT_FILENO);
  }
  ~StandardOutputToError() {
    if (saved_ < 0) return;
    std::fflush(stdout);
    dup2(saved_, STDOUT_FILENO);
    close(saved_);
  }
  StandardOutputToError(const StandardOutputToError&) = delete;
  StandardOutputToError& operator=(const StandardOutputToError&) = delete;

 private:
  int saved_ = -1;
};

}  // namespace

TriMesh PoissonIsoSurface(const PointCloud& oriented, const PoissonOptions& options) {
  CHECK(oriented.HasNormals());
  const Eigen::AlignedBox3d box = BoundingBox(oriented.points);
  const Eigen::Vector3d centre = box.center();
  const double unit = box.sizes().maxCoeff();
  CHECK_GT(unit, 0);

  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  cloud->reserve(oriented.Size());
  for (Eigen::Index i = 0; i < oriented.Size(); ++i) {
    pcl::PointNormal point;
    point.getVector3fMap() = ((oriented.points.col(i) - centre) / unit).cast<float>();
    point.getNormalVector3fMap() = oriented.normals.col(i).cast<float>();
    cloud->push_back(point);
  }

  // PCL's octree allocates its nodes from one global allocator, so reconstructions must not
  // overlap.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setInputCloud(cloud);
  poisson.setDepth(options.depth);
  poisson.setScale(static_cast<float>(kPoissonCubeScale));
  poisson.setSamplesPerNode(static_cast<float>(options.samples_per_node));
  poisson.setPointWeight(static_cast<float>(options.point_weight));
  poisson.setThreads(1);
  pcl::PointCloud<pcl::PointNormal> vertices;
  std::vector<pcl::Vertices> polygons;
  try {
    const StandardOutputToError redirect;
    poisson.reconstruct(vertices, polygons);
  } catch (const std::exception& failure) {
    LOG(WARNING) << "Poisson reconstruction failed: " << failure.what();
    return {};
  }

  TriMesh mesh{Eigen::Matrix3Xd(3, vertices.size()), Eigen::Matrix3Xi(3, polygons.size())};
  for (size_t v = 0; v < vertices.size(); ++v) {
    mesh.vertices.col(v) = centre + unit * vertices[v].getVector3fMap().cast<double>();
  }
  for (size_t t = 0; t < polygons.size(); ++t) {
    CHECK_EQ(polygons[t].vertices.size(), 3u);
    for (int corner = 0; corner < 3; ++corner) {
      mesh.triangles(corner, t) = static_cast<int>(polygons[t].vertices[corner]);
    }
  }
  return mesh;
}

}  // namespace lacuna
