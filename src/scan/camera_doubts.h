// Doubts about the cameras of depth images: intrinsics that do not belong to the images, and poses
// that put the views of one object apart.
#ifndef LACUNA_SCAN_CAMERA_DOUBTS_H_
#define LACUNA_SCAN_CAMERA_DOUBTS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "scan/depth_image.h"

namespace lacuna {

// A sentence about intrinsics that images of `width` × `height` pixels can hardly have: a principal
// point more than a fifth of the image, and two pixels, from its middle, a field of view below 1°
// or above 140°, or focal lengths that differ by more than a fifth. Names the scale of the image to
// which they would belong where the principal point suggests one. Empty if there is no doubt.
std::string DoubtOfIntrinsics(const Intrinsics& intrinsics, int width, int height);

// A sentence about views (3 × n, m, world frame, one per camera) that lie apart: the bounding box
// of one of them, enlarged by its own size on each side, touches none of the others. `are_inverse`
// says that the poses were given as camera_from_world. Suggests the other key if the views lie
// closer together with it. Empty if there is no doubt.
std::string DoubtOfPoses(const std::vector<Eigen::Matrix3Xd>& views,
                         const std::vector<Camera>& cameras, bool are_inverse);

}  // namespace lacuna

#endif  // LACUNA_SCAN_CAMERA_DOUBTS_H_
