#include "core/gzip.h"

#include <glog/logging.h>
#include <zlib.h>

#include <array>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr int kGzipFormat = 16;  // added to the size of the window: gzip's header, not zlib's
constexpr int kMostMemory = 9;   // of 9; results in the best compression

// zlib does not change its input, but takes it without const.
Bytef* InputOf(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
}

}  // namespace

std::string Gzip(std::string_view bytes) {
  z_stream stream{};
  CHECK_EQ(deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzipFormat,
                        kMostMemory, Z_DEFAULT_STRATEGY),
           Z_OK);
  std::string compressed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = InputOf(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  CHECK_EQ(stream.avail_in, bytes.size()) << "too many bytes for one call";
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  CHECK_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  return compressed;
}

std::string Gunzip(std::string_view compressed) {
  z_stream stream{};
  CHECK_EQ(inflateInit2(&stream, MAX_WBITS + kGzipFormat), Z_OK);
  stream.next_in = InputOf(compressed);
  stream.avail_in = static_cast<uInt>(compressed.size());
  CHECK_EQ(stream.avail_in, compressed.size()) << "too many bytes for one call";
  std::string bytes;
  std::array<char, 1 << 16> piece;
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    status = inflate(&stream, Z_NO_FLUSH);
    bytes.append(piece.data(), piece.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END || stream.avail_in > 0)
    throw InputError("is not gzip, or is damaged or incomplete");
  return bytes;
}

}  // namespace lacuna
