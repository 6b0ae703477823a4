#include "scan/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>

#include "core/error.h"
#include "core/quantity.h"
#include "geometry/tri_mesh.h"
#include "scan/time_span.h"

namespace lacuna {
namespace {

void CheckRowCount(const Recording& recording, const Frame& frame) {
  if (frame.index > 0 && HasTrackedPoints(recording) && frame.row_count != recording.row_count) {
    throw InputError(
        fmt::format("holds {} points where frame 0 holds {}; tracked points are the "
                    "same in every frame",
                    frame.row_count, recording.row_count));
  }
}

// Refuses tracked points whose triangles join them otherwise than in frame 0, as where a program
// has numbered the vertices anew. Compared are the triangles between vertices that frame 0 has.
// Some may differ: a program may have cut a polygon along its other diagonal.
void CheckFaces(const Recording& recording, const Frame& frame) {
  if (frame.index == 0 || recording.faces.empty() || !HasTrackedPoints(recording)) return;
  std::vector<char> is_corner(static_cast<size_t>(frame.row_count), 0);
  for (const std::array<int, 3>& face : recording.faces)
    for (const int row : face) is_corner[static_cast<size_t>(row)] = 1;
  size_t compared = 0, others = 0;
  for (const std::array<int, 3>& face : FacesByRow(frame)) {
    const bool is_comparable = std::all_of(face.begin(), face.end(), [&](int row) {
      return is_corner[static_cast<size_t>(row)] != 0;
    });
    if (!is_comparable) continue;
    ++compared;
    others += !std::binary_search(recording.faces.begin(), recording.faces.end(), face);
  }
  if (2 * others <= compared) return;
  throw InputError(
      fmt::format("{} of {} triangles join other vertices than in frame 0, so that a vertex is not "
                  "the same material point in both; without `tracked` it need not be",
                  others, compared));
}

// "frame 3 of "bend": <file>: …", with the file unless the message begins with one already.
[[noreturn]] void Rethrow(const Recording& recording, const Frame& frame, const InputError& error) {
  std::string message = error.what();
  const bool is_named =
      std::any_of(frame.files.begin(), frame.files.end(),
                  [&](const std::string& name) { return message.rfind(name, 0) == 0; });
  if (!is_named) message = fmt::format("{}: {}", frame.files.front(), message);
  throw InputError(fmt::format("frame {} of \"{}\": {}", frame.index, recording.name, message));
}

// Why points of the frame are not used.
std::string DescribeDropped(const Frame& frame) {
  const Eigen::Index others =
      frame.dropped_count - frame.repeated_count - frame.cropped_count - frame.separate_count;
  std::vector<std::string> reasons;
  const auto add = [&reasons](Eigen::Index count, const char* reason) {
    if (count > 0) reasons.push_back(fmt::format("{} {}", count, reason));
  };
  add(frame.repeated_count, "repeat exactly");
  add(frame.cropped_count, "outside the crop");
  add(frame.separate_count, "not of the largest component");
  if (reasons.empty()) return "not finite or out of range";
  add(others, "not finite or out of range");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::string DescribeFrame(const Frame& frame) {
  const Eigen::AlignedBox3d box = BoundingBox(frame.cloud.points);
  const Eigen::Vector3d size = 1e3 * box.sizes();
  std::string text = fmt::format("{} points, {:.4g} mm × {:.4g} mm × {:.4g} mm", frame.cloud.Size(),
                                 size.x(), size.y(), size.z());
  if (frame.cloud.Size() > 0) text += ", " + DescribeCorners(box);
  if (frame.cloud.HasNormals()) text += ", with normals";
  if (frame.triangles.cols() > 0) text += fmt::format(", {} triangles", frame.triangles.cols());
  if (frame.dropped_count > 0) {
    text += fmt::format(", {} of {} dropped ({})", frame.dropped_count, frame.row_count,
                        DescribeDropped(frame));
  }
  return text;
}

std::vector<InfoLine> DescribeObject(const Recording& recording) {
  const RecordedObject& object = recording.object;
  std::vector<InfoLine> lines;
  lines.emplace_back("density",
                     object.density ? fmt::format("{:g} kg/m³", *object.density) : "not given");
  lines.emplace_back("gravity", object.gravity
                                    ? fmt::format("({:g}, {:g}, {:g}) m/s²", object.gravity->x(),
                                                  object.gravity->y(), object.gravity->z())
                                    : "not given");
  lines.emplace_back("reference", DescribeReference(recording.reference));
  for (const RecordedSupport& support : object.fixed)
    lines.emplace_back("fixed", DescribeSupport(support));
  for (const RecordedGrip& grip : object.grips) lines.emplace_back("gripped", DescribeGrip(grip));
  for (const MeasuredForce& force : object.forces) {
    lines.emplace_back("force", DescribeForce(force));
  }
  for (const MeasuredReaction& reaction : object.reactions) {
    lines.emplace_back("reaction", DescribeReaction(reaction));
  }
  return lines;
}

// What a given path or a measured force needs to be compared with the times of frames.
struct TimedSeries {
  const std::filesystem::path& file;
  const Eigen::VectorXd& times;  // s
  std::string field;             // of recording.yaml, which names the file
};

// A sentence if a series does not cover the frames; empty if it does.
std::string DescribeUncovered(const TimedSeries& series, const Recording& recording, int first,
                              int last) {
  const double begin = recording.times[first], end = recording.times[last];
  const double margin = TimeMargin(recording.times);
  const double series_begin = series.times[0], series_end = series.times[series.times.size() - 1];
  std::vector<std::string> gaps;
  if (!CoversTimes(series.times, begin, begin, margin) && begin < series_begin)
    gaps.push_back(
        fmt::format("begins {} after the first of them", DurationText(series_begin - begin)));
  if (!CoversTimes(series.times, end, end, margin) && end > series_end)
    gaps.push_back(fmt::format("ends {} before the last of them", DurationText(end - series_end)));
  if (gaps.empty()) return "";
  return fmt::format(
      "{} covers {} to {}, the frames {} to {}: it {}; extend this file, which {} names "
      "in {}, or use fewer frames",
      series.file.string(), TimeText(series_begin), TimeText(series_end), TimeText(begin),
      TimeText(end), fmt::join(gaps, ", and "), series.field, recording.file.string());
}

}  // namespace

std::string DescribeUncoveredPath(const Recording& recording, int first, int last) {
  const std::vector<RecordedGrip>& grips = recording.object.grips;
  std::string text;
  for (size_t k = 0; k < grips.size() && text.empty(); ++k)
    if (grips[k].motion == GripMotion::kGiven)
      text = DescribeUncovered({grips[k].file, grips[k].times, fmt::format("gripped[{}].path", k)},
                               recording, first, last);
  return text;
}

std::string DescribeUncoveredForce(const Recording& recording, int first, int last) {
  const std::vector<MeasuredForce>& forces = recording.object.forces;
  std::string text;
  for (size_t k = 0; k < forces.size() && text.empty(); ++k)
    if (!forces[k].file.empty())  // not a constant
      text = DescribeUncovered({forces[k].file, forces[k].times, fmt::format("forces[{}]", k)},
                               recording, first, last);
  return text;
}

void AddFileOf(const Region& region, Recording* recording) {
  const auto* listed = std::get_if<NodeRegion>(&region.shape);
  if (listed == nullptr || listed->file.file.empty()) return;
  const bool is_known =
      std::any_of(recording->files.begin(), recording->files.end(),
                  [&](const FileState& known) { return known.file == listed->file.file; });
  if (!is_known) recording->files.push_back(listed->file);
}

Frame LoadFrame(const Recording& recording, int i) {
  CHECK(i >= 0 && i < recording.FrameCount()) << "frame " << i;
  Frame frame;
  frame.index = i;
  frame.time = recording.times[i];
  frame.triangles.resize(3, 0);
  frame.sensors.positions.resize(3, 0);
  std::visit(
      [&](const auto& source) {
        for (const auto& file : FilesOfFrame(source, i)) frame.files.push_back(file.string());
        try {
          LoadPoints(source, &frame);
          CheckRowCount(recording, frame);
          CheckFaces(recording, frame);
        } catch (const InputError& error) {
          Rethrow(recording, frame, error);
        }
      },
      recording.frames);
  LOG_IF(INFO, frame.dropped_count > 0)
      << recording.name << ", frame " << i << ": " << frame.dropped_count << " of "
      << frame.row_count << " points dropped (" << DescribeDropped(frame) << ")";
  return frame;
}

std::vector<std::array<int, 3>> FacesByRow(const Frame& frame) {
  std::vector<std::array<int, 3>> faces;
  for (const auto triangle : frame.triangles.colwise()) {
    std::array<int, 3> face{};
    for (int k = 0; k < 3; ++k)
      face[static_cast<size_t>(k)] =
          frame.source_row.size() > 0 ? frame.source_row[triangle[k]] : triangle[k];
    std::sort(face.begin(), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

bool HasTrackedPoints(const Recording& recording) {
  return std::visit([](const auto& source) { return IsTracked(source); }, recording.frames);
}

bool IsScan(const Recording& recording) {
  return recording.markers.names.empty() && !HasTrackedPoints(recording);
}

std::string DescribeRecording(const Recording& recording) {
  std::string text = fmt::format("{}\n", recording.name);
  const auto add = [&](const std::string& label, const std::string& value) {
    text += fmt::format("  {:<12} {}\n", label, value);
  };
  std::visit(
      [&](const auto& source) {
        add("frames",
            fmt::format("{} {}, {} to {}", recording.FrameCount(), source.kTitle,
                        TimeText(recording.times.front()), TimeText(recording.times.back())));
        add("first frame", DescribeFrame(LoadFrame(recording, 0)));
        add("last frame", DescribeFrame(LoadFrame(recording, recording.FrameCount() - 1)));
        for (const auto& [label, value] : DescribeSource(source)) add(label, value);
      },
      recording.frames);
  for (const auto& [label, value] : DescribeObject(recording)) add(label, value);
  for (const std::string& warning : recording.warnings) add("warning", warning);
  return text;
}

}  // namespace lacuna
