#include "core/npy.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <regex>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lacuna {
namespace {

static_assert(std::endian::native == std::endian::little, "the .npy payload is copied unchanged");

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr size_t kAlignment = 64;  // of the payload, required by the format

struct RawArray {
  std::string type;  // NumPy's descr, e.g. "<f8"
  bool fortran_order = false;
  std::vector<int64_t> shape;
  int64_t count = 1;
  std::string payload;
};

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& message) {
  throw InputError({file.string()}, message);
}

std::string ReadBytes(std::ifstream& stream, size_t count) {
  std::string bytes(count, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<size_t>(stream.gcount()));
  return bytes;
}

// The size in bytes of one element; 0 for an unsupported type.
size_t ElementSize(const std::string& type) {
  for (const char* known : {"<f8", "<f4", "<i8", "<i4", "<i2", "<u4", "<u2", "|i1", "|u1"}) {
    if (type == known) return static_cast<size_t>(type[2] - '0');
  }
  return 0;
}

// Parses the header, a Python dictionary literal with exactly these three keys in any order.
void ParseHeader(const std::filesystem::path& file, const std::string& header, RawArray* array) {
  std::smatch match;
  static const std::regex type(R"re(['"]descr['"]\s*:\s*['"]([^'"]*)['"])re");
  static const std::regex order(R"re(['"]fortran_order['"]\s*:\s*(True|False))re");
  static const std::regex shape(R"re(['"]shape['"]\s*:\s*\(([0-9,\s]*)\))re");
  if (!std::regex_search(header, match, type))
    Fail(file, "the .npy header has no 'descr' with a simple type");
  array->type = match[1];
  if (!std::regex_search(header, match, order))
    Fail(file, "the .npy header has no 'fortran_order'");
  array->fortran_order = match[1] == "True";
  if (!std::regex_search(header, match, shape)) Fail(file, "the .npy header has no 'shape'");
  const std::string extents = match[1];
  static const std::regex digits("[0-9]+");
  for (std::sregex_iterator it(extents.begin(), extents.end(), digits), end; it != end; ++it) {
    const std::string text = it->str();
    if (text.size() > 15) Fail(file, "the .npy header has an impossible shape");
    const int64_t extent = std::stoll(text);
    array->shape.push_back(extent);
    if (extent > 0 && array->count > std::numeric_limits<int64_t>::max() / 16 / extent) {
      Fail(file, "the .npy header has an impossible shape");
    }
    array->count *= extent;
  }
}

RawArray ReadRaw(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (!stream || error) Fail(file, "cannot be read: no such file, or no permission");
  if (ReadBytes(stream, kMagic.size()) != kMagic) Fail(file, "is not an .npy file");
  const std::string version = ReadBytes(stream, 2);
  if (version.size() < 2) Fail(file, "ends within the .npy header");
  const size_t length_bytes = version[0] == 1 ? 2 : 4;
  if (version[0] < 1 || version[0] > 3) Fail(file, "has an unknown version of the .npy format");
  const std::string length = ReadBytes(stream, length_bytes);
  if (length.size() < length_bytes) Fail(file, "ends within the .npy header");
  uint32_t header_size = 0;
  std::memcpy(&header_size, length.data(), length_bytes);
  const size_t payload_begin = kMagic.size() + 2 + length_bytes + header_size;
  if (payload_begin > size) Fail(file, "ends within the .npy header");

  RawArray array;
  ParseHeader(file, ReadBytes(stream, header_size), &array);
  const size_t element = ElementSize(array.type);
  if (element == 0) {
    Fail(file, "contains numbers of type '" + array.type +
                   "'; expected little-endian floating-point numbers or integers");
  }
  const size_t expected = element * static_cast<size_t>(array.count);
  if (size - payload_begin != expected) {
    Fail(file, "contains " + std::to_string(size - payload_begin) +
                   " bytes of numbers; its shape requires " + std::to_string(expected));
  }
  array.payload = ReadBytes(stream, expected);
  if (array.payload.size() != expected) Fail(file, "cannot be read completely");
  return array;
}

template <typename Stored, typename Value>
void ConvertAs(const std::filesystem::path& file, const RawArray& array, std::vector<Value>* out) {
  for (int64_t i = 0; i < array.count; ++i) {
    Stored stored;
    std::memcpy(&stored, array.payload.data() + static_cast<size_t>(i) * sizeof(Stored),
                sizeof(Stored));
    if constexpr (std::is_same_v<Stored, int64_t> && std::is_same_v<Value, double>) {
      constexpr int64_t kExact = int64_t{1} << 53;
      if (stored > kExact || stored < -kExact) {
        Fail(file, "contains the integer " + std::to_string(stored) +
                       ", outside the range of exact integers in float64 (±2^53)");
      }
    }
    // NOLINTNEXTLINE(bugprone-signed-char-misuse): an int8 is a number here, not a character
    (*out)[static_cast<size_t>(i)] = static_cast<Value>(stored);
  }
}

// The numbers in the order of the file. `Value` is double or int64_t.
template <typename Value>
std::vector<Value> Convert(const std::filesystem::path& file, const RawArray& array) {
  std::vector<Value> values(static_cast<size_t>(array.count));
  if (array.type[1] == 'f' && std::is_integral_v<Value>) {
    Fail(file, "contains floating-point numbers where integers are expected");
  }
  if (array.type == "<f8") ConvertAs<double>(file, array, &values);
  if (array.type == "<f4") ConvertAs<float>(file, array, &values);
  if (array.type == "<i8") ConvertAs<int64_t>(file, array, &values);
  if (array.type == "<i4") ConvertAs<int32_t>(file, array, &values);
  if (array.type == "<i2") ConvertAs<int16_t>(file, array, &values);
  if (array.type == "<u4") ConvertAs<uint32_t>(file, array, &values);
  if (array.type == "<u2") ConvertAs<uint16_t>(file, array, &values);
  if (array.type == "|i1") ConvertAs<int8_t>(file, array, &values);
  if (array.type == "|u1") ConvertAs<uint8_t>(file, array, &values);
  return values;
}

// Converts from Fortran order (first index fastest) to C order (last index fastest).
template <typename Value>
std::vector<Value> LastIndexFastest(const std::vector<int64_t>& shape,
                                    const std::vector<Value>& fortran) {
  std::vector<Value> values(fortran.size());
  std::vector<int64_t> index(shape.size(), 0);
  for (const Value value : fortran) {
    int64_t position = 0;
    for (size_t k = 0; k < shape.size(); ++k) position = position * shape[k] + index[k];
    values[static_cast<size_t>(position)] = value;
    for (size_t k = 0; k < shape.size() && ++index[k] == shape[k]; ++k) index[k] = 0;
  }
  return values;
}

template <typename Value>
Eigen::Matrix<Value, Eigen::Dynamic, Eigen::Dynamic> ReadMatrix(const std::filesystem::path& file) {
  const RawArray array = ReadRaw(file);
  if (array.shape.empty() || array.shape.size() > 2) {
    Fail(file, "has " + std::to_string(array.shape.size()) + " dimensions; expected 1 or 2");
  }
  const std::vector<Value> values = Convert<Value>(file, array);
  const Eigen::Index rows = array.shape[0];
  const Eigen::Index columns = array.shape.size() == 2 ? array.shape[1] : 1;
  using Matrix = Eigen::Matrix<Value, Eigen::Dynamic, Eigen::Dynamic>;
  using RowMajor = Eigen::Matrix<Value, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (values.empty()) return Matrix(rows, columns);  // without a loop over the columns
  if (array.fortran_order) return Eigen::Map<const Matrix>(values.data(), rows, columns);
  return Eigen::Map<const RowMajor>(values.data(), rows, columns);
}

template <typename Matrix>
void Write(const std::filesystem::path& file, const char* type, const Matrix& matrix) {
  std::string header = "{'descr': '" + std::string(type) + "', 'fortran_order': True, 'shape': (" +
                       std::to_string(matrix.rows()) + ", " + std::to_string(matrix.cols()) +
                       "), }";
  const size_t preamble = kMagic.size() + 4;
  header.append(kAlignment - 1 - (preamble + header.size()) % kAlignment, ' ');
  header.push_back('\n');
  const uint16_t length = static_cast<uint16_t>(header.size());
  std::string start(kMagic);
  start += {1, 0, static_cast<char>(length & 0xff), static_cast<char>(length >> 8)};
  AtomicFile output(file);
  output.Write(start + header);
  output.Write({reinterpret_cast<const char*>(matrix.data()),
                static_cast<size_t>(matrix.size()) * sizeof(typename Matrix::Scalar)});
  output.Commit();
}

}  // namespace

NpyArray ReadNpy(const std::filesystem::path& file) {
  const RawArray raw = ReadRaw(file);
  std::vector<double> values = Convert<double>(file, raw);
  if (raw.fortran_order) values = LastIndexFastest(raw.shape, values);
  return {raw.shape, std::move(values)};
}

Eigen::MatrixXd ReadNpyMatrix(const std::filesystem::path& file) {
  return ReadMatrix<double>(file);
}

MatrixXi64 ReadNpyIntegers(const std::filesystem::path& file) { return ReadMatrix<int64_t>(file); }

void WriteNpy(const std::filesystem::path& file, const Eigen::MatrixXd& matrix) {
  Write(file, "<f8", matrix);
}

void WriteNpyIntegers(const std::filesystem::path& file, const MatrixXi64& matrix) {
  Write(file, "<i8", matrix);
}

}  // namespace lacuna
