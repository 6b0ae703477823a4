// Depth cameras that see a triangle mesh as real ones see an object: noise, gaps and all.
//
// A ray through each pixel's centre meets the nearest triangle. Of that depth the scanner makes a
// measurement: range noise, flying pixels where the depth jumps, quantisation, and no value at all
// at grazing incidence or by chance. Everything is a function of the seed, the frame, the camera
// and the pixel, so that results depend neither on threads nor on order.
#ifndef LACUNA_SCAN_VIRTUAL_SCANNER_H_
#define LACUNA_SCAN_VIRTUAL_SCANNER_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/tri_mesh.h"
#include "scan/depth_image.h"
#include "scan/frame.h"

namespace lacuna {

struct VirtualCamera {
  Camera camera;
  int width = 0, height = 0;  // pixels
};

struct CameraRing {
  int count = 4;                                     // 2 to 6
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // what they look at, m
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     // the ring's axis
  double radius = 0.5;                               // m
  double elevation = 0.4;                            // rad; every other one looks from below
  int width = 320, height = 240;                     // larger: more points
  double field_of_view = 0.7;                        // horizontal, rad
};

// Cameras evenly around `center`, alternately above and below the plane of the ring, so that the
// ends of an elongated object along `up` are seen as well.
std::vector<VirtualCamera> PlaceCameras(const CameraRing& ring);

struct ScannerOptions {
  double noise = 2e-4;      // standard deviation of the range at reference_range, m
  double noise_growth = 0;  // exponent p of σ = noise·(range / reference_range)^p; ~2: stereo
  double reference_range = 0.5;  // m
  double quantum = 1e-4;         // depths are whole multiples of it, m; 0: not quantised
  double flying_fraction = 0.3;  // of the pixels at depth edges that measure between near and far
  double flying_reach = 0.01;    // m; they lie up to so far behind the near surface
  double edge_jump = 0.005;      // m; a larger step of depth between neighbours is an edge
  double max_incidence = 1.4;    // rad between ray and normal; beyond: nothing is measured
  double dropout = 0.01;         // fraction of the pixels without a value, by chance
  uint64_t seed = 1;
};

// The exact depth (depth_image.h) of each pixel and the cosine of incidence; 0 where no triangle
// is met. Surfaces are seen from both sides. Throws InputError when the mesh reaches behind the
// camera, whose image it would fill.
struct RenderedView {
  DepthImage depth;      // m
  DepthImage incidence;  // |cos| of the angle between ray and triangle normal
};
RenderedView Render(const TriMesh& mesh, const VirtualCamera& camera);

// What camera number `camera_index` measures of frame `frame_index`.
DepthImage Measure(const RenderedView& view, const VirtualCamera& camera,
                   const ScannerOptions& options, int frame_index, int camera_index);

// The measurements of all cameras as points of the world frame, shuffled; `seen_by` is told.
struct ScanResult {
  PointCloud cloud;
  Sensors sensors;
};
ScanResult Scan(const TriMesh& mesh, const std::vector<VirtualCamera>& cameras,
                const ScannerOptions& options, int frame_index);

}  // namespace lacuna

#endif  // LACUNA_SCAN_VIRTUAL_SCANNER_H_
