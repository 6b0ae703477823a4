// Reads a pinhole camera (depth_image.h) from recording.yaml.
#ifndef LACUNA_SCAN_CAMERA_READER_H_
#define LACUNA_SCAN_CAMERA_READER_H_

#include "core/config.h"
#include "scan/depth_image.h"

namespace lacuna {

// Reads `name` (default "camera N", with N = `number` counted from 1), `intrinsics` in pixels, and
// one of `world_from_camera` and `camera_from_world`: 16 numbers of a 4 × 4 matrix, row by row,
// whose translation is in `length_unit` (m). Throws InputError (file, line, column and field) when
// a key is missing or the matrix is not a rigid motion.
Camera ReadCamera(const Config& config, double length_unit, size_t number);

}  // namespace lacuna

#endif  // LACUNA_SCAN_CAMERA_READER_H_
