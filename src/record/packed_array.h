// Arrays of numbers as compact JSON objects, for motions that a report draws:
//   {"shape": [F, V, 3], "type": "int16", "low": .., "high": .., "delta": true, "base64": ".."}
// src/report/page/README.md describes the format, which the page decodes.
#ifndef LACUNA_RECORD_PACKED_ARRAY_H_
#define LACUNA_RECORD_PACKED_ARRAY_H_

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace lacuna {

// A series of frames as 16-bit numbers, to draw from: column f is frame f, and its rows are the
// entries of an array of the shape `of_frame` in row-major order (a 3 × V matrix of points,
// reshaped to one column, has the shape {V, 3}). Each value is rounded to one of 65535 even steps
// between the smallest and the largest one, so that it changes by at most half a step. Frames after
// the first are kept as differences from the one before. NaN stays NaN. Infinite values, and rows
// that do not match the shape, are programming errors (CHECK).
nlohmann::json PackFrames(const Eigen::MatrixXd& frames, const std::vector<int>& of_frame);

// The series of PackFrames() as single-precision numbers, without differences.
nlohmann::json PackFloats(const Eigen::MatrixXd& frames, const std::vector<int>& of_frame);

// The vertices of triangles, of the shape {T, 3}. A negative number is a programming error (CHECK).
nlohmann::json PackTriangles(const Eigen::Matrix3Xi& triangles);

// A packed array, unpacked: one column for each entry along its first axis, in row-major order.
struct UnpackedArray {
  std::vector<int> shape;
  Eigen::MatrixXd values;
};
// Throws InputError where `packed` is not what one of the functions above has made.
UnpackedArray Unpack(const nlohmann::json& packed);

}  // namespace lacuna

#endif  // LACUNA_RECORD_PACKED_ARRAY_H_
