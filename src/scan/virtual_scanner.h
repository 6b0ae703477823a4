// Virtual depth cameras, which measure a triangle mesh with the imperfections of real cameras.
//
// The ray through the centre of each pixel meets the nearest triangle at an exact depth. The
// scanner turns this depth into a measurement: it adds range noise and flying pixels where the
// depth jumps, rounds to a quantum, and measures nothing at grazing incidence or, at random,
// elsewhere. All random numbers are functions of the seed, the frame, the camera and the pixel, so
// that results depend neither on the number of threads nor on the order of the calls. All functions
// are re-entrant.
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

// Cameras evenly spaced around a point that they all look at.
struct CameraRing {
  int count = 4;                                     // 2 to 6
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m, the point they look at
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();     // the ring's axis
  double radius = 0.5;                               // m
  double elevation = 0.4;                            // rad; every other camera is below the plane
  int width = 320, height = 240;                     // larger: more points
  double field_of_view = 0.7;                        // rad, horizontal angle
};

// Places the cameras alternately above and below the plane of the ring, so that the ends of an
// object elongated along `up` are seen as well.
std::vector<VirtualCamera> PlaceCameras(const CameraRing& ring);

// The standard deviation of a measured range r is noise · (r / reference_range)^noise_growth.
struct ScannerOptions {
  double noise = 2e-4;           // m, standard deviation at reference_range
  double noise_growth = 0;       // about 2 for stereo cameras
  double reference_range = 0.5;  // m
  double quantum = 1e-4;         // m; depths are rounded to its multiples; 0: they are not rounded
  double flying_fraction = 0.3;  // fraction of pixels at depth edges with a depth in between
  double flying_reach = 0.01;    // m; how far flying pixels lie behind the near surface at most
  double edge_jump = 0.005;      // m; a larger step of depth between neighbours is an edge
  double max_incidence = 1.4;    // rad between ray and normal; beyond it nothing is measured
  double dropout = 0.01;         // fraction of the pixels that measure nothing, at random
  uint64_t seed = 1;
};

// The image of an ideal camera; 0 where a ray meets no triangle.
struct RenderedView {
  DepthImage depth;      // m, see depth_image.h
  DepthImage incidence;  // |cos| of the angle between ray and triangle normal
};

// Renders both sides of the surface. Throws InputError when the mesh reaches behind the camera,
// because it would then fill the image.
RenderedView Render(const TriMesh& mesh, const VirtualCamera& camera);

// The measured depths, m, of a view; 0 where nothing is measured. The indices select the random
// numbers.
DepthImage Measure(const RenderedView& view, const VirtualCamera& camera,
                   const ScannerOptions& options, int frame_index, int camera_index);

// The measurements of all cameras as points of the world frame, in random order.
struct ScanResult {
  PointCloud cloud;  // points without normals
  Sensors sensors;   // the cameras, and the camera of each point
};
ScanResult Scan(const TriMesh& mesh, const std::vector<VirtualCamera>& cameras,
                const ScannerOptions& options, int frame_index);

// A moving surface and the cameras that film it: what a virtual recording is made from.
struct VirtualScan {
  std::vector<TriMesh> surfaces;  // one per frame; all have the triangles of the first
  std::vector<double> times;      // s, ascending, one per frame
  std::vector<VirtualCamera> cameras;
  ScannerOptions options;
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_VIRTUAL_SCANNER_H_
