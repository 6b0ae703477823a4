#include "paper/table1_scans.h"

#include <fmt/format.h>

#include "experiment/kept_recording.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/recorded_states.h"

namespace lacuna {
namespace {

std::filesystem::path RecordingOf(const Table1Study& table1, const std::filesystem::path& results,
                                  const std::filesystem::path& folder, Progress* progress) {
  const std::string key = RecordingKey(table1, 1);
  for (const auto& place : {results / "seed_1" / "recording", folder / "recording"})
    if (IsKeptRecording(place, key)) return place;
  KeepRecording(table1.scene, SimulateWholeScene(table1.scene, progress), folder / "recording",
                key);
  return folder / "recording";
}

void CheckFrames(const std::vector<int>& frames, const char* what, size_t count) {
  for (const int frame : frames) {
    if (frame < 1 || static_cast<size_t>(frame) >= count) {
      throw InputError(fmt::format("{}: the recording has frames 1 to {} after the first, not {}",
                                   what, count - 1, frame));
    }
  }
}

}  // namespace

Table1FigureSettings ReadTable1Figures(const Config& config) {
  Table1FigureSettings settings;
  config.Integer("schema_version", 1, 1);
  settings.table1 = config.Path("table1");
  settings.cloud_frame = config.Child("cloud").Integer("frame", 1, 1000000);
  const Config meshes = config.Child("meshes");
  settings.radius_edge_ratios =
      meshes.Quantities("radius_edge_ratios", kDimensionless, {1, 100, true, false});
  settings.max_volumes = meshes.Quantities("max_volumes", kVolume, kPositive);
  const Config own = config.Child("own_surface_meshes");
  settings.own_surface.radius_edge_ratios =
      own.Quantities("radius_edge_ratios", kDimensionless, {1, 100, true, false});
  settings.own_surface.max_volume = own.Quantity("max_volume", kVolume, kPositive);
  settings.own_surface.min_dihedral_angle =
      own.Quantity("min_dihedral_angle", kAngle, {0, 1.2, false, false});
  if (settings.own_surface.radius_edge_ratios.empty())
    own.Fail("radius_edge_ratios", "expected at least one");
  settings.bend_frames = config.Child("bend").Integers("frames", 1);
  settings.alignment_frames = config.Child("alignment").Integers("frames", 1);
  if (settings.radius_edge_ratios.empty() || settings.max_volumes.empty())
    config.Fail("meshes", "needs radius_edge_ratios and max_volumes");
  if (settings.bend_frames.empty()) config.Fail("bend", "needs frames");
  if (settings.alignment_frames.empty()) config.Fail("alignment", "needs frames");
  config.RefuseUnknownKeys();
  return settings;
}

Table1Scans PrepareScans(const Table1Study& table1, const Table1FigureSettings& settings,
                         const std::filesystem::path& results, const std::filesystem::path& folder,
                         Progress* progress) {
  const Recording recording = LoadRecording(RecordingOf(table1, results, folder, progress));
  Table1Scans scans{ReadReconstruction(table1.configurations.front().config, recording), {}, {}};
  const size_t count = scans.study.frames.size();
  CheckFrames({settings.cloud_frame}, "cloud", count);
  CheckFrames(settings.bend_frames, "bend", count);
  CheckFrames(settings.alignment_frames, "alignment", count);
  scans.states = LoadFrameStates(scans.study, progress);
  scans.tracked = TrackFrames(scans.study, scans.states, progress);
  return scans;
}

}  // namespace lacuna
