#include "scan/recording_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/first_few.h"
#include "core/interrupt.h"
#include "geometry/tri_mesh.h"
#include "scan/components.h"
#include "scan/delimited_table.h"

namespace lacuna {
namespace {

constexpr double kLarge = 0.1;  // of the points; less is debris

bool AreEqual(const Frame& a, const Frame& b) {
  return a.cloud.Size() == b.cloud.Size() && a.cloud.points == b.cloud.points &&
         a.source_row.size() == b.source_row.size() && a.source_row == b.source_row;
}

void AddRepeats(const std::vector<int>& repeats, int frame_count,
                std::vector<std::string>* findings) {
  if (repeats.empty()) return;
  findings->push_back(
      fmt::format("{} of {} frames repeat{} the one before exactly (frame{} {}): a camera that "
                  "delivered a frame "
                  "twice, or data without noise at rest",
                  repeats.size(), frame_count, repeats.size() == 1 ? "s" : "",
                  repeats.size() == 1 ? "" : "s", FirstFew(repeats)));
}

// Frames much smaller or larger than the first one. Those with far fewer points are left out: they
// show a part of the object.
class SizeSurvey {
 public:
  void Add(const Frame& frame) {
    const double size = BoundingBoxDiagonal(frame.cloud.points);
    if (frame.index == 0) {
      points_ = frame.cloud.Size();
      first_size_ = size;
    }
    if (2 * frame.cloud.Size() < points_ || size == 0 || first_size_ == 0) return;
    if (size < kFactor * first_size_ && first_size_ < kFactor * size) return;
    if (frames_.empty()) size_ = size;
    frames_.push_back(frame.index);
  }
  void AddTo(std::vector<std::string>* findings) const {
    if (frames_.empty()) return;
    findings->push_back(fmt::format(
        "frame{} {}: {:.3g} m across where frame 0 is {:.3g} m: another unit of length, "
        "or points far from the object",
        frames_.size() > 1 ? "s" : "", FirstFew(frames_), size_, first_size_));
  }

 private:
  static constexpr double kFactor = 50;  // no object shrinks or grows so much
  Eigen::Index points_ = 0;
  double first_size_ = 0, size_ = 0;  // m
  std::vector<int> frames_;
};

// Components of the frames' scans and surfaces.
class ComponentSurvey {
 public:
  void Add(const Frame& frame) {
    const bool is_surface = frame.triangles.cols() > 0;
    const Eigen::VectorXi component =
        is_surface ? ComponentsOfSurface({frame.cloud.points, frame.triangles})
                   : ComponentsOfCloud(frame.cloud.points);
    // Fewer points of a cloud are left to the outlier filter.
    const size_t fewest =
        is_surface ? 3 : std::max<size_t>(4, static_cast<size_t>(frame.cloud.Size()) / 500);
    std::string text = DescribeSmallComponents(frame.cloud.points, component, fewest);
    if (text.empty()) return;
    if (frames_.empty()) {
      first_ = std::move(text);
      is_large_ = (component.array() > 0).count() > kLarge * static_cast<double>(component.size());
    }
    frames_.push_back(frame.index);
  }
  void AddTo(std::vector<std::string>* findings) const {
    if (frames_.empty()) return;
    findings->push_back(fmt::format(
        "frame {}{}: beside the largest component there {}; {}", frames_.front(),
        frames_.size() > 1 ? fmt::format(" (and {} others)", frames_.size() - 1) : "",
        first_.starts_with("1 ") ? "is " + first_ : "are " + first_,
        is_large_
            ? "if they are views of one object, the cameras' poses or intrinsics are wrong; if "
              "not, `crop` or `keep_largest: true` under `frames` leaves them out"
            : "nothing holds them in a model; `keep_largest: true` under `frames` leaves them "
              "out"));
  }

 private:
  std::vector<int> frames_;
  std::string first_;      // what the first of them shows
  bool is_large_ = false;  // whether that is more than debris
};

void AddDoubtfulTables(const Recording& recording, std::vector<std::string>* findings) {
  for (const std::filesystem::path& file : FilesOf(recording.object)) {
    if (file.extension() == ".npy") continue;
    const std::vector<std::string> notes = ReadDelimitedTable(file).notes;
    findings->insert(findings->end(), notes.begin(), notes.end());
  }
}

// A clamp or a force in another unit or coordinate system than the reference shape.
void AddRegionsBesideTheShape(const Recording& recording, std::vector<std::string>* findings) {
  const ReferenceShape& reference = recording.reference;
  if (reference.source == ReferenceSource::kFirstFrame) return;
  const Eigen::AlignedBox3d box = ReferenceBox(reference);
  const Eigen::Vector3d thickness = Eigen::Vector3d::Constant(reference.sheet_thickness);
  const Eigen::AlignedBox3d thick(box.min() - thickness, box.max() + thickness);
  for (const Region* region : RegionsIn(recording.object))
    if (!Meets(*region, thick))
      findings->push_back(
          fmt::format("region \"{}\" ({}) holds nothing of the reference shape, which extends {}",
                      region->name, DescribeRegion(*region), DescribeCorners(box)));
}

}  // namespace

std::vector<std::string> ExamineFrames(const Recording& recording, int64_t most_points,
                                       const std::function<void(const Frame&)>& also) {
  std::vector<std::string> findings;
  const bool shows_surface =
      std::visit([](const auto& source) { return ShowsSurface(source); }, recording.frames);
  ComponentSurvey components;
  SizeSurvey sizes;
  std::vector<int> repeats, with_repeated_points;
  Frame before;
  int64_t rows = 0;
  int i = 0;
  for (; i < recording.FrameCount() && rows < most_points; ++i) {
    ThrowIfInterrupted();
    Frame frame = LoadFrame(recording, i);
    rows += frame.row_count;
    if (i > 0 && AreEqual(frame, before)) repeats.push_back(i);
    if (i > 0 && frame.repeated_count > 0) with_repeated_points.push_back(i);
    sizes.Add(frame);
    if (shows_surface) components.Add(frame);
    if (also) also(frame);
    before = std::move(frame);
  }
  AddRepeats(repeats, i, &findings);
  sizes.AddTo(&findings);
  components.AddTo(&findings);
  if (!with_repeated_points.empty()) {
    findings.push_back(
        fmt::format("points that repeat exactly were left out of {} later frames ({})",
                    with_repeated_points.size(), FirstFew(with_repeated_points)));
  }
  AddDoubtfulTables(recording, &findings);
  AddRegionsBesideTheShape(recording, &findings);
  if (i < recording.FrameCount())
    findings.push_back(
        fmt::format("only the first {} of {} frames were examined", i, recording.FrameCount()));
  return findings;
}

}  // namespace lacuna
