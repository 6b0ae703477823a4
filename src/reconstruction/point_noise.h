// The noise of the recorded points of a reconstruction, where the experiment does not give it.
#ifndef LACUNA_RECONSTRUCTION_POINT_NOISE_H_
#define LACUNA_RECONSTRUCTION_POINT_NOISE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// Second differences in time, from which the noise of tracked points is estimated, need so many.
inline constexpr size_t kFewestNoiseFrames = 3;

struct PointNoise {
  double deviation = 0;  // m, σ
  std::string warning;   // why it may be too large; empty: it is not
};

// If the points are identified (FrameState::tracked), σ of one coordinate is estimated from their
// tracks (analysis/track_scatter.h): their scatter while they rest, or else the white part of their
// motion, which is an upper bound. Otherwise σ of a scanned point is that of the first state's
// points about planes through their neighbours (EstimateNoise), together with their distance (rms)
// from `scanned_shape`, the reference shape if it was reconstructed from these points (otherwise
// empty): no forces bring it closer to later scans. All are at least 1e-5 of the object's size,
// because noise-free data would require an exact fit, which no mesh allows. Throws InputError,
// which names fit.noise, where the states are too few or hold too few points.
PointNoise EstimatePointNoise(const std::vector<FrameState>& states, bool are_identified,
                              const TriMesh& scanned_shape = {});

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_POINT_NOISE_H_
