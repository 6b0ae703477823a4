// Turns the rows of a frame's file into the points of a Frame. Shared by the kinds of frames.
#ifndef LACUNA_SCAN_FRAME_POINTS_H_
#define LACUNA_SCAN_FRAME_POINTS_H_

#include <Eigen/Core>
#include <string>

#include "geometry/point_cloud.h"
#include "scan/file_frames.h"
#include "scan/frame.h"

namespace lacuna {

// Sets the columns of `points` (3 × n, in the coordinates of the file) to NaN that repeat exactly,
// and returns their number. Cameras write one point, most of them (0, 0, 0), wherever they measured
// nothing: a point that occurs 16 times and in a hundredth of the columns, and (0, 0, 0) if it
// occurs twice, are forgotten altogether. Of another point that occurs several times the first
// column stays. In tracked points only the former are forgotten.
Eigen::Index ForgetRepeatedPoints(bool tracked, Eigen::Matrix3Xd* points);

// Sets the columns of `points` (3 × n, m, world frame) to NaN that lie outside source.crop and,
// with source.keep_largest, those that do not belong to the largest component (components.h), of
// the surface where there are `triangles`. Counts them in `frame`.
void ForgetOtherObjects(const FileFrames& source, const Eigen::Matrix3Xi& triangles,
                        Eigen::Matrix3Xd* points, Frame* frame);

// Copies the usable rows of `raw` (m, world frame) into frame->cloud and numbers them in
// frame->source_row. A row is usable when its coordinates are finite and below 1e9 m in magnitude
// (beyond that a value is a placeholder). A normal that is not finite, as programs write it where
// they could estimate none, becomes zero. Of `triangles` (3 × m, rows of `raw`), those whose three
// corners are usable are kept and renumbered. Sets row_count and dropped_count. Throws InputError
// when a triangle has a corner that is no row.
void KeepUsablePoints(const PointCloud& raw, const Eigen::Matrix3Xi& triangles, Frame* frame);

// The normals (3 × n) rotated and scaled to unit length. Returns 3 × 0 when one of them is zero,
// because a cloud has either all of its normals or none: the filter then estimates them.
Eigen::Matrix3Xd UnitNormals(const Eigen::Matrix3Xd& normals, const Eigen::Matrix3d& rotation);

// Throws InputError when the frame has fewer than `fewest` usable points. `condition` completes the
// message for a frame that has none of them, e.g. "is finite"; the counts of the frame are added.
void RequirePoints(const Frame& frame, Eigen::Index fewest, const std::string& condition);

// Fewer points do not span a shape.
inline constexpr Eigen::Index kFewestScannedPoints = 4;

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_POINTS_H_
