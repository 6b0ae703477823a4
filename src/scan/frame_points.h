// Turns the rows of a frame's file into the points of a Frame. Shared by the kinds of frames.
#ifndef LACUNA_SCAN_FRAME_POINTS_H_
#define LACUNA_SCAN_FRAME_POINTS_H_

#include <Eigen/Core>
#include <string>

#include "geometry/point_cloud.h"
#include "scan/frame.h"

namespace lacuna {

// Copies the usable rows of `raw` (m, world frame) into frame->cloud and numbers them in
// frame->source_row. A row is usable when its coordinates are finite and below 1e9 m in magnitude
// (beyond that a value is a placeholder) and, where there are normals, its normal is finite. Of
// `triangles` (3 × m, rows of `raw`), those whose three corners are usable are kept and renumbered.
// Sets row_count and dropped_count. Throws InputError when a triangle has a corner that is no row.
void KeepUsablePoints(const PointCloud& raw, const Eigen::Matrix3Xi& triangles, Frame* frame);

// The normals (3 × n) rotated and scaled to unit length. Returns 3 × 0 when one of them is zero,
// because a cloud has either all of its normals or none: the filter then estimates them.
Eigen::Matrix3Xd UnitNormals(const Eigen::Matrix3Xd& normals, const Eigen::Matrix3d& rotation);

// Throws InputError when the frame has fewer than `fewest` usable points. `condition` completes the
// message for a frame that has none of them, e.g. "is finite".
void RequirePoints(const Frame& frame, Eigen::Index fewest, const std::string& condition);

// Fewer points do not span a shape.
inline constexpr Eigen::Index kFewestScannedPoints = 4;

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_POINTS_H_
