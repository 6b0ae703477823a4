// recording.yaml → Recording.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/quantity.h"
#include "geometry/mesh_io.h"
#include "geometry/tri_mesh.h"
#include "scan/frame_times.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

constexpr int kSchemaVersion = 1;

// Returns what all frames in the files say, also those that are not chosen.
FrameData ReadFrames(const Config& config, Recording* recording) {
  const Config frames = config.Child("frames");
  recording->frames = ReadFrameSource(frames, recording->data, &recording->warnings);
  return std::visit(
      [&](auto& source) {
        const FrameTimes times = ReadFrameTimes(frames, CountFrames(source), TimesInFiles(source),
                                                recording->data, &recording->warnings);
        const std::vector<std::filesystem::path> headers = FilesWithHeaders(source);
        KeepFrames(times.chosen, &source);
        recording->times = times.OfChosen();
        recording->times_file = times.file;
        recording->markers = NamedMarkers(source);
        return FrameData{times.in_files, headers};
      },
      recording->frames);
}

RecordedObject ReadObject(const Config& config, const Recording& recording,
                          const FrameData& frames) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  RecordedObject object;
  const double density = config.Quantity("density", kDensity, kPositive, kAbsent);
  if (std::isfinite(density)) object.density = density;
  const Eigen::Vector3d gravity =
      config.Vector("gravity", kAcceleration, Eigen::Vector3d::Constant(kAbsent));
  if (gravity.allFinite()) object.gravity = gravity;
  object.fixed = ReadSupports(config, recording.data);
  object.grips = ReadGrips(config, recording.data, frames, recording.markers.names);
  object.forces = ReadForces(config, recording.data, frames, recording.times.front());
  object.reactions =
      ReadReactions(config, recording.data, frames, HeldParts(object), HeldAxesOfParts(object));
  return object;
}

void WarnOfFrameSize(const Frame& first, Recording* recording) {
  if (first.cloud.Size() < 2) return;
  const double size = BoundingBoxDiagonal(first.cloud.points);
  if (size >= kSmallestObject && size <= kLargestObject) return;
  const std::string explanation = std::visit(
      [&](const auto& source) { return ExplainSize(source, size, recording->data.length_unit); },
      recording->frames);
  recording->warnings.push_back(fmt::format("frame 0 is {:.3g} m across{}", size, explanation));
}

// When the reference shape and the frames differ greatly in size, one of them has the wrong unit.
void WarnOfReferenceSize(const Frame& first, Recording* recording) {
  constexpr double kFactor = 50;
  const ReferenceShape& reference = recording->reference;
  if (reference.source == ReferenceSource::kFirstFrame || first.cloud.Size() < 2) return;
  const double size = recording->size;
  const double frame_size = BoundingBoxDiagonal(first.cloud.points);
  if (size < kFactor * frame_size && frame_size < kFactor * size) return;
  recording->warnings.push_back(
      fmt::format("the reference shape is {:.3g} m across, frame 0 {:.3g} m; check length_unit "
                  "and reference.length_unit",
                  size, frame_size));
}

void WarnOfJumps(Recording* recording) {
  const std::vector<RecordedGrip>& grips = recording->object.grips;
  if (std::none_of(grips.begin(), grips.end(),
                   [](const RecordedGrip& grip) { return grip.motion == GripMotion::kGiven; }))
    return;
  for (std::string& doubt :
       DoubtsOfJumps(recording->object, recording->size, recording->times.back()))
    recording->warnings.push_back(std::move(doubt));
}

// The first frame. Where it cannot be used, the error names the time of the first one that can.
Frame LoadFirstFrame(const Recording& recording) {
  try {
    return LoadFrame(recording, 0);
  } catch (const InputError& problem) {
    constexpr int kMostTries = 2000;
    for (int i = 1; i < std::min(recording.FrameCount(), kMostTries); ++i) {
      try {
        LoadFrame(recording, i);
      } catch (const InputError&) {
        continue;
      }
      throw InputError(fmt::format("{}; the first usable frame is {}: `from: {}` begins there",
                                   problem.what(), i, TimeText(recording.times[i])));
    }
    throw;
  }
}

void WarnOfDroppedPoints(const Frame& first, Recording* recording) {
  if (first.repeated_count == 0) return;
  recording->warnings.push_back(fmt::format(
      "frame 0: {} of {} points repeat exactly, as happens where a camera measured nothing; "
      "they are not used",
      first.repeated_count, first.row_count));
}

void UseFirstFrame(Recording* recording) {
  Frame first = LoadFirstFrame(*recording);
  const bool is_refined = std::visit(
      [&](auto& source) { return RefineByFirstFrame(first, &source, &recording->warnings); },
      recording->frames);
  if (is_refined) first = LoadFrame(*recording, 0);
  recording->row_count = first.row_count;
  recording->size = recording->reference.source == ReferenceSource::kFirstFrame
                        ? BoundingBoxDiagonal(first.cloud.points)
                        : ReferenceBox(recording->reference).diagonal().norm();
  if (HasTrackedPoints(*recording)) recording->faces = FacesByRow(first);
  const auto add = [recording](const std::vector<std::string>& doubts) {
    recording->warnings.insert(recording->warnings.end(), doubts.begin(), doubts.end());
  };
  add(first.notes);
  WarnOfDroppedPoints(first, recording);
  add(std::visit([&](const auto& source) { return DoubtsOfFirstFrame(first, source); },
                 recording->frames));
  WarnOfFrameSize(first, recording);
  WarnOfReferenceSize(first, recording);
  WarnOfJumps(recording);
}

// Reads all but the frames; for some kinds of frames these, too.
Recording ReadDescribed(const std::filesystem::path& path) {
  const bool is_folder = std::filesystem::is_directory(path);
  const Config config = Config::Load(is_folder ? path / "recording.yaml" : path);
  config.Integer("schema_version", kSchemaVersion, kSchemaVersion);
  Recording recording;
  recording.file = config.File();
  const std::filesystem::path own_folder = recording.file.parent_path();
  const std::filesystem::path whole =
      std::filesystem::absolute(recording.file).lexically_normal().parent_path();
  recording.name = config.Text("name", whole.filename().string());
  recording.data.folder = config.Path("data_folder", ".");
  if (!std::filesystem::is_directory(recording.data.folder)) {
    config.Fail("data_folder",
                fmt::format("there is no folder {}", recording.data.folder.string()));
  }
  recording.data.length_unit = ReadLengthUnit(config, "");
  const FrameData frames = ReadFrames(config, &recording);
  if (const auto instrument = config.OptionalChild("instrument")) {
    recording.instrument.subset = instrument->Quantity("subset", kLength, kPositive);
    recording.instrument.is_volume =
        instrument->Choice<bool>("shape", {{"surface", false}, {"volume", true}}, "surface");
    if (!HasTrackedPoints(recording) && recording.markers.names.empty())
      config.Fail("instrument",
                  "describes the averaging of tracked points or markers, which the frames do "
                  "not have");
  }
  recording.object = ReadObject(config, recording, frames);
  for (const std::string& doubt :
       DoubtsOfObject(recording.object, frames.times.front(), frames.times.back())) {
    recording.warnings.push_back(doubt);
  }
  const bool shows_surface =
      std::visit([](const auto& source) { return ShowsSurface(source); }, recording.frames);
  recording.reference = ReadReference(config, recording.data, own_folder, shows_surface);
  config.RefuseUnknownKeys();
  recording.resolved = config.Resolved().dump();
  return recording;
}

// All files that the recording consists of, each once.
std::vector<std::filesystem::path> FilesOf(const Recording& recording) {
  std::vector<std::filesystem::path> files = {recording.file, recording.times_file};
  const auto add = [&](const std::vector<std::filesystem::path>& more) {
    files.insert(files.end(), more.begin(), more.end());
  };
  const ReferenceShape& reference = recording.reference;
  if (reference.source == ReferenceSource::kTetMesh)
    add(FilesOfTetMesh(reference.file));
  else
    files.push_back(reference.file);
  add(FilesOf(recording.object));
  std::visit([&](const auto& source) { add(AllFiles(source)); }, recording.frames);
  std::set<std::filesystem::path> seen = {""};
  std::erase_if(files, [&](const auto& file) { return !seen.insert(file).second; });
  return files;
}

}  // namespace

Recording LoadRecording(const std::filesystem::path& path) {
  // Which files there are is known only once they have been read, so all are read a second time
  // after their states were noted. The frames, which may take long, come after that.
  const std::vector<std::filesystem::path> files = FilesOf(ReadDescribed(path));
  std::vector<FileState> states;
  for (const std::filesystem::path& file : files) states.push_back(StateOf(file));
  Recording recording = ReadDescribed(path);
  if (FilesOf(recording) != files)
    throw InputError({recording.file.string()},
                     "has changed while this command was reading it; run the command again");
  recording.files = std::move(states);
  UseFirstFrame(&recording);
  return recording;
}

Recording LoadRecording(const Config& config, const std::string& key) {
  const std::filesystem::path path = config.Path(key);
  if (!std::filesystem::exists(path))
    config.Fail(key, fmt::format("there is no file or folder {}", path.string()));
  if (std::filesystem::is_directory(path) && !std::filesystem::exists(path / "recording.yaml"))
    config.Fail(key, fmt::format("the folder {} contains no recording.yaml", path.string()));
  return LoadRecording(path);
}

}  // namespace lacuna
