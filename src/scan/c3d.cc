// Reads C3D files. They consist of blocks of 512 bytes: block 1 is the header; the parameters and
// the data follow. Layout and meaning are those of The C3D File Format User Guide
// (https://www.c3d.org).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/text_file.h"
#include "scan/marker_files.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr size_t kBlock = 512;
constexpr uint8_t kKey = 0x50;

enum class Processor { kIntel = 84, kDec = 85, kMips = 86 };

// Bounds-checked access to the content of the file, in the number format of its processor.
class Bytes {
 public:
  Bytes(const std::filesystem::path& file, std::string content)
      : file_(file), content_(std::move(content)) {}

  void SetProcessor(Processor processor) { processor_ = processor; }
  size_t Size() const { return content_.size(); }

  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError({file_.string()}, message);
  }
  uint8_t Byte(size_t at) const {
    Check(at, 1);
    return static_cast<uint8_t>(content_[at]);
  }
  uint16_t Word(size_t at) const {
    const uint16_t a = Byte(at), b = Byte(at + 1);
    return processor_ == Processor::kMips ? a << 8 | b : b << 8 | a;
  }
  int16_t Integer(size_t at) const { return static_cast<int16_t>(Word(at)); }
  // On DEC the VAX F format: words are swapped, and the bias of the exponent is 2 larger than
  // IEEE's.
  float Real(size_t at) const {
    const uint32_t first = Word(at), second = Word(at + 2);
    const uint32_t bits =
        processor_ == Processor::kIntel ? second << 16 | first : first << 16 | second;
    const float value = std::bit_cast<float>(bits);
    return processor_ == Processor::kDec ? value / 4 : value;
  }
  std::string Text(size_t at, size_t length) const {
    Check(at, length);
    return content_.substr(at, length);
  }

 private:
  void Check(size_t at, size_t length) const {
    if (at > content_.size() || length > content_.size() - at) {
      Fail(fmt::format("is truncated: it ends at byte {}", content_.size()));
    }
  }

  std::filesystem::path file_;
  std::string content_;
  Processor processor_ = Processor::kIntel;
};

struct Parameter {
  int type = 0;  // bytes per entry; −1: characters
  std::vector<size_t> extents;
  size_t data = 0;  // position of its entries in the file
};

// All parameters by name, e.g. "POINT:LABELS". A group has a negative number, and its parameters
// have the same number with a positive sign.
std::map<std::string, Parameter> ReadParameters(const Bytes& bytes, size_t begin) {
  struct Entry {
    int group;
    std::string name;
    size_t body;
  };
  std::vector<Entry> entries;
  std::map<int, std::string> groups;
  const size_t end = begin + kBlock * std::max<size_t>(bytes.Byte(begin + 2), 1);
  for (size_t at = begin + 4; at < end;) {
    const int name_length = std::abs(static_cast<int8_t>(bytes.Byte(at)));
    if (name_length == 0) break;
    const int group = static_cast<int8_t>(bytes.Byte(at + 1));
    const std::string name = bytes.Text(at + 2, name_length);
    const size_t next = at + 2 + name_length;
    if (group < 0) groups[-group] = name;
    if (group > 0) entries.push_back({group, name, next + 2});
    const uint16_t step = bytes.Word(next);
    if (step == 0) break;
    at = next + step;
  }
  std::map<std::string, Parameter> parameters;
  for (const Entry& entry : entries) {
    Parameter parameter;
    parameter.type = static_cast<int8_t>(bytes.Byte(entry.body));
    const int dimensions = bytes.Byte(entry.body + 1);
    for (int i = 0; i < dimensions; ++i) {
      parameter.extents.push_back(bytes.Byte(entry.body + 2 + i));
    }
    parameter.data = entry.body + 2 + dimensions;
    parameters[groups[entry.group] + ":" + entry.name] = parameter;
  }
  return parameters;
}

std::string TrimRight(std::string text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

// The first texts of the parameter, at most `most`: its extents may announce any number.
std::vector<std::string> Texts(const Bytes& bytes, const Parameter& parameter, size_t most) {
  if (parameter.type != -1 || parameter.extents.empty() || parameter.extents[0] == 0) return {};
  size_t count = 1;
  for (size_t i = 1; i < parameter.extents.size(); ++i)
    count = std::min(count * parameter.extents[i], most);
  std::vector<std::string> texts;
  for (size_t i = 0; i < std::min(count, most); ++i) {
    const size_t length = parameter.extents[0];
    texts.push_back(InUtf8(TrimRight(bytes.Text(parameter.data + i * length, length))));
  }
  return texts;
}

struct PointFormat {
  Eigen::Index marker_count = 0;
  Eigen::Index frame_count = 0;
  double scale = 0;       // negative: the data are floating-point numbers
  double rate = 0;        // Hz; 0: neither the header nor POINT:RATE gives one
  double other_rate = 0;  // Hz, of POINT:RATE where it contradicts `rate`; 0: it does not
  size_t data = 0;
  size_t analog_per_frame = 0;
};

// The number of frames by the fields that Vicon writes: two 16-bit words each, the lower one first.
// 0 where they are absent.
Eigen::Index FramesOfTrial(const Bytes& bytes, const std::map<std::string, Parameter>& parameters) {
  const auto field = [&](const char* name) -> int64_t {
    const auto found = parameters.find(name);
    if (found == parameters.end() || found->second.type != 2) return 0;
    if (found->second.extents != std::vector<size_t>{2}) return 0;
    return bytes.Word(found->second.data) + 65536 * int64_t{bytes.Word(found->second.data + 2)};
  };
  const int64_t start = field("TRIAL:ACTUAL_START_FIELD"), end = field("TRIAL:ACTUAL_END_FIELD");
  return start >= 1 && end >= start ? end - start + 1 : 0;
}

// The number of frames in a parameter of real numbers.
Eigen::Index FramesInReal(const Bytes& bytes, const Parameter& parameter) {
  constexpr float kMost = 2147483648.0f;
  const float value = bytes.Real(parameter.data);
  if (!(value >= 0 && value <= kMost))
    bytes.Fail(fmt::format("gives {} as its number of frames", value));
  return static_cast<Eigen::Index>(value);
}

size_t FrameSize(const PointFormat& format) {
  const size_t entry = format.scale < 0 ? 4 : 2;
  return (4 * format.marker_count + format.analog_per_frame) * entry;
}

// The number of whole frames that the file has room for.
Eigen::Index FramesHeld(const Bytes& bytes, const PointFormat& format) {
  if (bytes.Size() < format.data) return 0;
  return static_cast<Eigen::Index>((bytes.Size() - format.data) / FrameSize(format));
}

// `parameter`: POINT:RATE, null where it is absent.
void ReadRate(const Bytes& bytes, const Parameter* parameter, PointFormat* format) {
  const auto as_rate = [](double rate) { return rate > 0 && std::isfinite(rate) ? rate : 0; };
  const double in_header = as_rate(bytes.Real(20));
  const double in_parameter =
      parameter != nullptr && parameter->type == 4 ? as_rate(bytes.Real(parameter->data)) : 0;
  format->rate = in_header > 0 ? in_header : in_parameter;
  const Eigen::Index intervals = std::max<Eigen::Index>(format->frame_count, 2) - 1;
  if (in_parameter > 0 && RatesDiffer(in_parameter, format->rate, static_cast<size_t>(intervals)))
    format->other_rate = in_parameter;
}

PointFormat ReadFormat(const Bytes& bytes, const std::map<std::string, Parameter>& parameters) {
  PointFormat format;
  const int first = bytes.Word(6), last = bytes.Word(8);
  format.marker_count = bytes.Word(2);
  format.frame_count = last - first + 1;
  format.scale = bytes.Real(12);
  format.data = bytes.Word(16);
  format.analog_per_frame = bytes.Word(4);
  // The 16-bit frame numbers of the header do not suffice for long recordings; parameters do.
  const auto find = [&](const char* name) {
    const auto found = parameters.find(name);
    return found == parameters.end() ? nullptr : &found->second;
  };
  if (const Parameter* frames = find("POINT:FRAMES"); frames && last == 65535) {
    format.frame_count =
        frames->type == 4 ? FramesInReal(bytes, *frames) : bytes.Word(frames->data);
  }
  if (const Parameter* frames = find("POINT:LONG_FRAMES"); frames && frames->type == 4) {
    format.frame_count = FramesInReal(bytes, *frames);
  }
  const bool is_at_limit = last == 65535;
  const Parameter* used = find("POINT:USED");
  if (used && bytes.Word(used->data) != format.marker_count) {
    bytes.Fail(fmt::format("announces {} points in its header and {} in POINT:USED",
                           format.marker_count, bytes.Word(used->data)));
  }
  if (format.marker_count == 0) bytes.Fail("holds no 3-D points");
  if (format.data < 2) bytes.Fail("does not state where its data begin");
  if (!std::isfinite(format.scale) || format.scale == 0) bytes.Fail("has no point scale factor");
  ReadRate(bytes, find("POINT:RATE"), &format);
  format.data = (format.data - 1) * kBlock;
  // Programs that cut a recording may leave the fields of the trial as they were, so they count
  // only where the header is at its limit or the file is as long as they say.
  if (const Eigen::Index of_trial = FramesOfTrial(bytes, parameters);
      is_at_limit || of_trial <= FramesHeld(bytes, format)) {
    format.frame_count = std::max(format.frame_count, of_trial);
  }
  if (format.frame_count < 1) bytes.Fail("holds no frame");
  return format;
}

Eigen::Vector3d ReadPoint(const Bytes& bytes, const PointFormat& format, size_t at) {
  Eigen::Vector3d point;
  double residual = 0;
  if (format.scale < 0) {
    for (int axis = 0; axis < 3; ++axis) point[axis] = bytes.Real(at + 4 * axis);
    residual = bytes.Real(at + 12);
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = format.scale * bytes.Integer(at + 2 * axis);
    }
    residual = bytes.Integer(at + 6);
  }
  if (residual < 0 || !point.allFinite()) {
    point.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return point;
}

std::vector<std::string> ReadNames(const Bytes& bytes,
                                   const std::map<std::string, Parameter>& parameters,
                                   size_t count) {
  std::vector<std::string> names;
  for (int part = 1; names.size() < count; ++part) {
    const auto found =
        parameters.find(part == 1 ? "POINT:LABELS" : fmt::format("POINT:LABELS{}", part));
    if (found == parameters.end()) break;
    const std::vector<std::string> texts = Texts(bytes, found->second, count - names.size());
    names.insert(names.end(), texts.begin(), texts.end());
  }
  for (size_t i = names.size(); i < count; ++i) names.push_back(fmt::format("point {}", i + 1));
  names.resize(count);
  return names;
}

}  // namespace

MarkerTracks ReadC3d(const std::filesystem::path& file, FileTimes use) {
  Bytes bytes(file, ReadFilledFile(file));
  if (bytes.Size() < kBlock || bytes.Byte(1) != kKey || bytes.Byte(0) < 2) {
    bytes.Fail("is not a C3D file");
  }
  const size_t parameter_section = (bytes.Byte(0) - size_t{1}) * kBlock;
  const int processor = bytes.Byte(parameter_section + 3);
  if (processor < 84 || processor > 86) {
    bytes.Fail(
        fmt::format("was written by an unknown processor ({}); known are 84 Intel, 85 DEC "
                    "and 86 SGI/MIPS",
                    processor));
  }
  bytes.SetProcessor(static_cast<Processor>(processor));
  const std::map<std::string, Parameter> parameters = ReadParameters(bytes, parameter_section);
  const PointFormat format = ReadFormat(bytes, parameters);

  const size_t point_size = format.scale < 0 ? 16 : 8;
  const size_t frame_size = FrameSize(format);
  const Eigen::Index held = FramesHeld(bytes, format);
  if (held < format.frame_count) {
    bytes.Fail(fmt::format("is truncated: it announces {} frames and ends within frame {}",
                           format.frame_count, held));
  }
  MarkerTracks tracks;
  // The last block is filled up, by one block at most in the files of known programs.
  const size_t filled = bytes.Size() - format.data - frame_size * format.frame_count;
  if (filled > kBlock + frame_size) {
    const std::string announced = bytes.Word(8) == 65535
                                      ? "ends at frame 65535, the largest of 16 bits"
                                      : fmt::format("announces {} frames", format.frame_count);
    tracks.warnings.push_back(fmt::format(
        "{}: the header {}, but the file has room for {} frames; {} are read, because neither "
        "TRIAL:ACTUAL_END_FIELD nor POINT:LONG_FRAMES gives more",
        file.string(), announced, held, format.frame_count));
  }
  tracks.names = ReadNames(bytes, parameters, format.marker_count);
  NumberRepeatedNames(file, &tracks);
  if (const auto units = parameters.find("POINT:UNITS"); units != parameters.end()) {
    const std::vector<std::string> texts = Texts(bytes, units->second, 1);
    if (!texts.empty()) tracks.length_unit = texts[0];
  }
  if (format.rate == 0 && use == FileTimes::kUsed)
    bytes.Fail("has no frame rate; give `rate: … Hz` under `frames` in recording.yaml");
  if (format.other_rate > 0 && use == FileTimes::kUsed)
    tracks.warnings.push_back(fmt::format(
        "{}: its header states {:g} Hz and POINT:RATE {:g} Hz; the former is used; `rate` in "
        "recording.yaml overrides it",
        file.string(), format.rate, format.other_rate));
  if (format.rate > 0)
    tracks.times =
        Eigen::VectorXd::LinSpaced(format.frame_count, 0, format.frame_count - 1.0) / format.rate;
  for (Eigen::Index frame = 0; frame < format.frame_count; ++frame) {
    Eigen::Matrix3Xd positions(3, format.marker_count);
    for (Eigen::Index marker = 0; marker < format.marker_count; ++marker) {
      positions.col(marker) =
          ReadPoint(bytes, format, format.data + frame * frame_size + marker * point_size);
    }
    tracks.positions.push_back(std::move(positions));
  }
  return tracks;
}

}  // namespace lacuna
