#include "scan/virtual_scanner.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random_bits.h"

namespace lacuna {
namespace {

enum class Draw : uint64_t { kNoise = 1, kFlying, kFlyingDepth, kDropout, kShuffle };

uint64_t PixelBits(const ScannerOptions& options, int frame, int camera, Eigen::Index pixel,
                   Draw draw) {
  return RandomBits({options.seed, static_cast<uint64_t>(frame), static_cast<uint64_t>(camera),
                     static_cast<uint64_t>(pixel), static_cast<uint64_t>(draw)});
}

// The direction of a pixel's ray in the camera frame, with z = 1.
Eigen::Vector3d Ray(const Intrinsics& k, double u, double v) {
  return {(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1};
}

// Intersects the rays of all pixels in the bounding box of the triangle's image with the triangle.
void DrawTriangle(const std::array<Eigen::Vector3d, 3>& corners, const VirtualCamera& camera,
                  RenderedView* view) {
  const Intrinsics& k = camera.camera.intrinsics;
  const Eigen::Vector3d& a = corners[0];
  const Eigen::Vector3d normal = (corners[1] - a).cross(corners[2] - a);
  const double length = normal.norm();
  if (length == 0) return;
  double u_min = std::numeric_limits<double>::infinity(), u_max = -u_min;
  double v_min = u_min, v_max = -u_min;
  for (const Eigen::Vector3d& corner : corners) {
    const double u = k.fx * corner.x() / corner.z() + k.cx;
    const double v = k.fy * corner.y() / corner.z() + k.cy;
    u_min = std::min(u_min, u), u_max = std::max(u_max, u);
    v_min = std::min(v_min, v), v_max = std::max(v_max, v);
  }
  const int u_first = static_cast<int>(std::max(0.0, std::ceil(u_min)));
  const int v_first = static_cast<int>(std::max(0.0, std::ceil(v_min)));
  const int u_last = static_cast<int>(std::min<double>(camera.width - 1, std::floor(u_max)));
  const int v_last = static_cast<int>(std::min<double>(camera.height - 1, std::floor(v_max)));
  // A ray hits the triangle when it passes all three edges on the same side, i.e. when its triple
  // products with the corners of each edge have the same sign. Borders belong to both triangles, so
  // that no pixel falls between them.
  const std::array<Eigen::Vector3d, 3> edges = {
      corners[0].cross(corners[1]), corners[1].cross(corners[2]), corners[2].cross(corners[0])};
  for (int v = v_first; v <= v_last; ++v) {
    for (int u = u_first; u <= u_last; ++u) {
      const Eigen::Vector3d ray = Ray(k, u, v);
      const double s0 = edges[0].dot(ray), s1 = edges[1].dot(ray), s2 = edges[2].dot(ray);
      const bool inside = (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
      const double along = normal.dot(ray);
      if (!inside || along == 0) continue;
      const double depth = normal.dot(a) / along;
      double& nearest = view->depth(v, u);
      if (nearest > 0 && nearest <= depth) continue;
      nearest = depth;
      view->incidence(v, u) = std::abs(along) / (length * ray.norm());
    }
  }
}

// The far depth at an edge, up to which a flying pixel may lie: the largest of the four neighbours,
// infinite if one of them measures nothing. Negative away from edges.
double FarDepth(const DepthImage& depth, Eigen::Index v, Eigen::Index u, double edge_jump) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  double far = -1;
  for (const auto& [dv, du] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const Eigen::Index y = v + dv, x = u + du;
    if (y < 0 || x < 0 || y >= depth.rows() || x >= depth.cols()) continue;
    const double other = depth(y, x) > 0 ? depth(y, x) : kNothing;
    if (other > depth(v, u) + edge_jump) far = std::max(far, other);
  }
  return far;
}

}  // namespace

std::vector<VirtualCamera> PlaceCameras(const CameraRing& ring) {
  CHECK(ring.count >= 1 && ring.width > 1 && ring.height > 1);
  const Eigen::Vector3d up = ring.up.normalized();
  const Eigen::Vector3d first = up.unitOrthogonal();
  const Eigen::Vector3d second = up.cross(first);
  std::vector<VirtualCamera> cameras;
  for (int i = 0; i < ring.count; ++i) {
    const double around = 2 * std::numbers::pi * i / ring.count;
    const double elevation = i % 2 == 0 ? ring.elevation : -ring.elevation;
    const Eigen::Vector3d out =
        std::cos(elevation) * (std::cos(around) * first + std::sin(around) * second) +
        std::sin(elevation) * up;
    VirtualCamera camera;
    camera.width = ring.width;
    camera.height = ring.height;
    const double focal = 0.5 * ring.width / std::tan(0.5 * ring.field_of_view);
    camera.camera.intrinsics = {focal, focal, 0.5 * (ring.width - 1), 0.5 * (ring.height - 1)};
    camera.camera.name = fmt::format("camera {}", i + 1);
    // x to the right, y down, z forward.
    const Eigen::Vector3d forward = -out;
    const Eigen::Vector3d right = forward.cross(up).normalized();
    Eigen::Matrix3d axes;
    axes << right, forward.cross(right), forward;
    camera.camera.world_from_camera.linear() = axes;
    camera.camera.world_from_camera.translation() = ring.center + ring.radius * out;
    cameras.push_back(camera);
  }
  return cameras;
}

RenderedView Render(const TriMesh& mesh, const VirtualCamera& camera) {
  RenderedView view;
  view.depth = DepthImage::Zero(camera.height, camera.width);
  view.incidence = DepthImage::Zero(camera.height, camera.width);
  const Eigen::Matrix3Xd points = camera.camera.world_from_camera.inverse() * mesh.vertices;
  constexpr double kNear = 1e-3;  // m
  if (points.cols() > 0 && points.row(2).minCoeff() < kNear) {
    throw InputError(fmt::format("the object reaches up to {} or behind it; move the camera back",
                                 camera.camera.name));
  }
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    DrawTriangle({points.col(corners[0]), points.col(corners[1]), points.col(corners[2])}, camera,
                 &view);
  }
  return view;
}

DepthImage Measure(const RenderedView& view, const VirtualCamera& camera,
                   const ScannerOptions& options, int frame_index, int camera_index) {
  const auto bits = [&](Eigen::Index pixel, Draw draw) {
    return PixelBits(options, frame_index, camera_index, pixel, draw);
  };
  const double min_cosine = std::cos(options.max_incidence);
  DepthImage measured = DepthImage::Zero(camera.height, camera.width);
  for (Eigen::Index v = 0; v < camera.height; ++v) {
    for (Eigen::Index u = 0; u < camera.width; ++u) {
      const Eigen::Index pixel = v * camera.width + u;
      double depth = view.depth(v, u);
      if (depth == 0 || view.incidence(v, u) < min_cosine) continue;
      if (Uniform(bits(pixel, Draw::kDropout)) < options.dropout) continue;
      const double far = FarDepth(view.depth, v, u, options.edge_jump);
      if (far > 0 && Uniform(bits(pixel, Draw::kFlying)) < options.flying_fraction) {
        depth +=
            Uniform(bits(pixel, Draw::kFlyingDepth)) * std::min(far - depth, options.flying_reach);
      }
      const double per_depth = Ray(camera.camera.intrinsics, u, v).norm();
      const double range = depth * per_depth;
      const double deviation =
          options.noise * std::pow(range / options.reference_range, options.noise_growth);
      depth += deviation * Normal(bits(pixel, Draw::kNoise)) / per_depth;
      if (options.quantum > 0) depth = options.quantum * std::round(depth / options.quantum);
      measured(v, u) = std::max(depth, 0.0);
    }
  }
  return measured;
}

ScanResult Scan(const TriMesh& mesh, const std::vector<VirtualCamera>& cameras,
                const ScannerOptions& options, int frame_index) {
  const int count = static_cast<int>(cameras.size());
  std::vector<PointCloud> views(count);
  ParallelFor(count, 1, [&](int64_t c) {
    const DepthImage depth =
        Measure(Render(mesh, cameras[c]), cameras[c], options, frame_index, static_cast<int>(c));
    views[c] = BackProject(depth, cameras[c].camera, 0, std::numeric_limits<double>::infinity());
  });
  ScanResult result;
  result.sensors.positions.resize(3, count);
  std::vector<std::pair<uint64_t, std::pair<int, int>>> order;  // random key, camera and point
  for (int c = 0; c < count; ++c) {
    result.sensors.positions.col(c) = cameras[c].camera.world_from_camera.translation();
    for (int i = 0; i < views[c].Size(); ++i) {
      order.push_back({PixelBits(options, frame_index, c, i, Draw::kShuffle), {c, i}});
    }
  }
  std::sort(order.begin(), order.end());
  result.cloud.points.resize(3, order.size());
  result.cloud.normals.resize(3, 0);
  result.sensors.seen_by.resize(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const auto [camera, point] = order[i].second;
    result.cloud.points.col(i) = views[camera].points.col(point);
    result.sensors.seen_by[i] = camera;
  }
  return result;
}

}  // namespace lacuna
