#include "scan/depth_image.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr int kMaxCount = 65535;

// libpng reports errors through a callback that must not return. This one throws an exception
// through the C frames of libpng, which hold no resource but the read structure that our caller
// owns.
struct PngProblem {
  std::string message;
};
[[noreturn]] void ThrowProblem(png_structp, png_const_charp message) { throw PngProblem{message}; }
void IgnoreWarning(png_structp, png_const_charp) {}

struct Source {
  std::string content;
  size_t at = 0;
};
void ReadBytes(png_structp png, png_bytep target, size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (count > source->content.size() - source->at) png_error(png, "it ends too early");
  std::memcpy(target, source->content.data() + source->at, count);
  source->at += count;
}
void AppendBytes(png_structp png, png_bytep bytes, size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(bytes), count);
}
void Flush(png_structp) {}

class PngReader {
 public:
  PngReader()
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, ThrowProblem, IgnoreWarning)),
        info(png_create_info_struct(png)) {}
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  png_structp png;
  png_infop info;
};

class PngWriter {
 public:
  PngWriter()
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, ThrowProblem, IgnoreWarning)),
        info(png_create_info_struct(png)) {}
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  png_structp png;
  png_infop info;
};

}  // namespace

DepthImage ReadDepthPng(const std::filesystem::path& file, double count_length) {
  Source source{ReadFilledFile(file)};
  PngReader reader;
  try {
    png_set_read_fn(reader.png, &source, ReadBytes);
    png_read_info(reader.png, reader.info);
    if (png_get_bit_depth(reader.png, reader.info) != 16 ||
        png_get_color_type(reader.png, reader.info) != PNG_COLOR_TYPE_GRAY) {
      throw PngProblem{"a depth image has one channel of 16 bits"};
    }
    const int passes = png_set_interlace_handling(reader.png);
    const Eigen::Index width = png_get_image_width(reader.png, reader.info);
    const Eigen::Index height = png_get_image_height(reader.png, reader.info);
    std::vector<png_byte> bytes(static_cast<size_t>(width) * height * 2);
    for (int pass = 0; pass < passes; ++pass) {
      for (Eigen::Index v = 0; v < height; ++v) {
        png_read_row(reader.png, bytes.data() + v * width * 2, nullptr);
      }
    }
    png_read_end(reader.png, nullptr);
    DepthImage depth(height, width);
    for (Eigen::Index i = 0; i < width * height; ++i) {
      const int count = bytes[2 * i] << 8 | bytes[2 * i + 1];
      depth.data()[i] = count == kMaxCount ? 0 : count_length * count;
    }
    return depth;
  } catch (const PngProblem& problem) {
    throw InputError({file.string()},
                     fmt::format("is not a whole 16-bit PNG: {}", problem.message));
  }
}

Eigen::Vector2i DepthPngSize(const std::filesystem::path& file) {
  Source source{ReadFilledFile(file)};
  PngReader reader;
  try {
    png_set_read_fn(reader.png, &source, ReadBytes);
    png_read_info(reader.png, reader.info);
    return {static_cast<int>(png_get_image_width(reader.png, reader.info)),
            static_cast<int>(png_get_image_height(reader.png, reader.info))};
  } catch (const PngProblem& problem) {
    throw InputError({file.string()},
                     fmt::format("is not a whole 16-bit PNG: {}", problem.message));
  }
}

void WriteDepthPng(const std::filesystem::path& file, const DepthImage& depth,
                   double count_length) {
  std::string content;
  PngWriter writer;
  try {
    png_set_write_fn(writer.png, &content, AppendBytes, Flush);
    png_set_IHDR(writer.png, writer.info, depth.cols(), depth.rows(), 16, PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(writer.png, writer.info);
    std::vector<png_byte> row(depth.cols() * 2);
    for (Eigen::Index v = 0; v < depth.rows(); ++v) {
      for (Eigen::Index u = 0; u < depth.cols(); ++u) {
        const long count = std::lround(depth(v, u) / count_length);
        CHECK(count >= 0 && count <= kMaxCount) << "depth " << depth(v, u) << " m";
        row[2 * u] = static_cast<png_byte>(count >> 8);
        row[2 * u + 1] = static_cast<png_byte>(count & 0xff);
      }
      png_write_row(writer.png, row.data());
    }
    png_write_end(writer.png, writer.info);
  } catch (const PngProblem& problem) {
    LOG(FATAL) << file << ": " << problem.message;
  }
  WriteFileAtomically(file, content);
}

PointCloud BackProject(const DepthImage& depth, const Camera& camera, double min_depth,
                       double max_depth) {
  const Intrinsics& k = camera.intrinsics;
  PointCloud cloud;
  cloud.points.resize(3, depth.size());
  cloud.normals.resize(3, 0);
  Eigen::Index count = 0;
  for (Eigen::Index v = 0; v < depth.rows(); ++v) {
    for (Eigen::Index u = 0; u < depth.cols(); ++u) {
      const double z = depth(v, u);
      if (!(z > 0 && z >= min_depth && z <= max_depth)) continue;
      const Eigen::Vector3d in_camera((u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z);
      cloud.points.col(count++) = camera.world_from_camera * in_camera;
    }
  }
  cloud.points.conservativeResize(3, count);
  return cloud;
}

}  // namespace lacuna
