#include "record/packed_array.h"

#include <glog/logging.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base64.h"
#include "core/error.h"
#include "core/gzip.h"

namespace lacuna {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "packed arrays are little-endian");

constexpr int16_t kNotObserved = -32768;
constexpr int kHalfSteps = 32767;  // the code of the largest value; the smallest has its negative

template <typename Number>
std::string BytesOf(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

template <typename Number>
std::vector<Number> NumbersOf(const std::string& bytes, size_t count) {
  if (bytes.size() != count * sizeof(Number))
    throw InputError("the size of a packed array does not match its shape");
  std::vector<Number> numbers(count);
  if (count > 0) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// The shape of `frames`, with the number of frames first.
json ShapeOf(const Eigen::MatrixXd& frames, const std::vector<int>& of_frame) {
  Eigen::Index entries = 1;
  json shape = {frames.cols()};
  for (const int size : of_frame) {
    entries *= size;
    shape.push_back(size);
  }
  CHECK_EQ(frames.rows(), entries);
  return shape;
}

json Packed(const json& shape, const char* type, const std::string& bytes) {
  return {{"shape", shape}, {"type", type}, {"base64", EncodeBase64(Gzip(bytes))}};
}

// The range of the values that are not NaN; 0 to 0 where there is none.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  explicit Range(const Eigen::MatrixXd& values) {
    for (const double value : values.reshaped()) {
      CHECK(!std::isinf(value)) << "an infinite value cannot be packed";
      low = std::fmin(low, value);
      high = std::fmax(high, value);
    }
    if (low > high) low = high = 0;
  }
  int16_t CodeOf(double value) const {
    if (std::isnan(value)) return kNotObserved;
    if (high == low) return -kHalfSteps;
    const double share = (value - low) / (high - low);
    return static_cast<int16_t>(std::lround(2 * kHalfSteps * share) - kHalfSteps);
  }
};

double ValueOf(int16_t code, double low, double high) {
  if (code == kNotObserved) return std::numeric_limits<double>::quiet_NaN();
  return low + (high - low) * (code + kHalfSteps) / (2.0 * kHalfSteps);
}

std::vector<double> UnpackFrames(const json& packed, const std::string& bytes, size_t frames,
                                 size_t entries) {
  std::vector<uint16_t> codes = NumbersOf<uint16_t>(bytes, frames * entries);
  const bool has_differences = packed.at("delta");
  for (size_t k = entries; k < codes.size() && has_differences; ++k)
    codes[k] = static_cast<uint16_t>(codes[k] + codes[k - entries]);
  std::vector<double> values;
  for (const uint16_t code : codes)
    values.push_back(ValueOf(static_cast<int16_t>(code), packed.at("low"), packed.at("high")));
  return values;
}

std::vector<double> UnpackValues(const json& packed, size_t frames, size_t entries) {
  const std::string bytes = Gunzip(DecodeBase64(packed.at("base64").get<std::string>()));
  const std::string type = packed.at("type");
  if (type == "int16") return UnpackFrames(packed, bytes, frames, entries);
  if (type == "float32") {
    const std::vector<float> values = NumbersOf<float>(bytes, frames * entries);
    return {values.begin(), values.end()};
  }
  if (type == "uint32") {
    const std::vector<uint32_t> values = NumbersOf<uint32_t>(bytes, frames * entries);
    return {values.begin(), values.end()};
  }
  throw InputError("a packed array has the unknown type " + type);
}

}  // namespace

json PackFrames(const Eigen::MatrixXd& frames, const std::vector<int>& of_frame) {
  const json shape = ShapeOf(frames, of_frame);
  const Range range(frames);
  std::vector<uint16_t> codes;
  codes.reserve(static_cast<size_t>(frames.size()));
  for (Eigen::Index f = 0; f < frames.cols(); ++f) {
    for (Eigen::Index k = 0; k < frames.rows(); ++k) {
      const int before = f > 0 ? range.CodeOf(frames(k, f - 1)) : 0;
      codes.push_back(static_cast<uint16_t>(range.CodeOf(frames(k, f)) - before));
    }
  }
  json packed = Packed(shape, "int16", BytesOf(codes));
  packed["low"] = range.low;
  packed["high"] = range.high;
  packed["delta"] = true;
  return packed;
}

json PackFloats(const Eigen::MatrixXd& frames, const std::vector<int>& of_frame) {
  const json shape = ShapeOf(frames, of_frame);
  const Range checked(frames);
  const std::vector<float> values(frames.data(), frames.data() + frames.size());
  return Packed(shape, "float32", BytesOf(values));
}

json PackTriangles(const Eigen::Matrix3Xi& triangles) {
  CHECK(triangles.size() == 0 || triangles.minCoeff() >= 0);
  const std::vector<uint32_t> vertices(triangles.data(), triangles.data() + triangles.size());
  return Packed({triangles.cols(), 3}, "uint32", BytesOf(vertices));
}

UnpackedArray Unpack(const json& packed) {
  try {
    UnpackedArray array;
    array.shape = packed.at("shape").get<std::vector<int>>();
    size_t entries = 1;
    for (size_t k = 1; k < array.shape.size(); ++k) entries *= static_cast<size_t>(array.shape[k]);
    const size_t frames = static_cast<size_t>(array.shape.at(0));
    const std::vector<double> values = UnpackValues(packed, frames, entries);
    array.values = Eigen::Map<const Eigen::MatrixXd>(
        values.data(), static_cast<Eigen::Index>(entries), static_cast<Eigen::Index>(frames));
    return array;
  } catch (const json::exception& problem) {
    throw InputError(std::string("is not a packed array: ") + problem.what());
  } catch (const std::out_of_range&) {
    throw InputError("is not a packed array: its shape is empty");
  }
}

}  // namespace lacuna
