#include "trials/trial_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/atomic_file.h"
#include "core/random_bits.h"
#include "core/text_file.h"
#include "geometry/embedding.h"
#include "scan/marker_frames.h"
#include "scan/scan_writer.h"
#include "trials/clamp_motion.h"
#include "trials/trial_load_cell.h"

namespace lacuna {
namespace {

constexpr int kMarkers = 8;

void AddNoise(const TrialCase& trial, int recording, std::vector<Eigen::Matrix3Xd>* frames) {
  const double memory = trial.noise_correlation_time > 0
                            ? std::exp(-kTrialSpacing / trial.noise_correlation_time)
                            : 0;
  Eigen::Matrix3Xd noise = Eigen::Matrix3Xd::Zero(3, frames->front().cols());
  for (size_t f = 0; f < frames->size(); ++f) {
    for (Eigen::Index k = 0; k < noise.size(); ++k) {
      const double fresh = trial.noise * Gauss(trial, 20 + recording, f, k);
      double& value = noise.reshaped()[k];
      value = f == 0 ? fresh : memory * value + std::sqrt(1 - memory * memory) * fresh;
    }
    (*frames)[f] += noise;
  }
}

// In a hard control with a bad frame, moves one frame by a random rigid motion, like a failed
// registration.
void SpoilFrame(const TrialCase& trial, int recording, std::vector<Eigen::Matrix3Xd>* frames) {
  const NuisanceTrial wrong = trial.Disturbance();
  if (wrong.frame_shift == 0 && wrong.frame_rotation == 0) return;
  const size_t bad = 20 + RandomBits({trial.seed, 60}) % (frames->size() - 25);
  Eigen::Vector3d shift, rotation;
  for (int axis = 0; axis < 3; ++axis) {
    shift[axis] = wrong.frame_shift * Gauss(trial, 61, axis, recording);
    rotation[axis] = wrong.frame_rotation * Gauss(trial, 62, axis, recording);
  }
  for (auto place : (*frames)[bad].colwise())
    place += shift + rotation.cross(Eigen::Vector3d(place));
}

// Writes the shape of the body in the model.
void WriteBox(const TrialCase& trial, const std::filesystem::path& file) {
  std::string box = "OFF\n8 12 0\n";
  for (int corner = 0; corner < 8; ++corner)
    box += fmt::format("{} {} {}\n", corner & 1 ? trial.size[0] : 0.0,
                       (corner & 2 ? 0.5 : -0.5) * trial.size[1],
                       (corner & 4 ? 0.5 : -0.5) * trial.size[2]);
  for (const char* face : {"0 2 1", "1 2 3", "4 5 6", "5 7 6", "0 1 4", "1 5 4", "2 6 3", "3 6 7",
                           "0 4 2", "2 4 6", "1 3 5", "3 7 5"})
    box += fmt::format("3 {}\n", face);
  WriteFileAtomically(file, box);
}

void WriteClampPath(int recording, const std::filesystem::path& file) {
  std::string path = "t,x,y,z,rx,ry,rz\n";
  for (int k = 0; k <= 10 * kTrialFrames; ++k) {
    const double time = 0.1 * kTrialSpacing * k;
    const ClampMotion motion = ClampMotionAt(recording, time);
    path += fmt::format("{}", time);
    for (const double coordinate : motion.shift) path += fmt::format(",{:.9f}", coordinate);
    for (const double angle : motion.rotation) path += fmt::format(",{:.9f}", angle);
    path += "\n";
  }
  WriteFileAtomically(file, path);
}

// The part of recording.yaml that describes the shape and the clamp, with its load cell, whose
// readings are written.
std::string ShapeAndClamp(const TrialCase& trial, int recording, const TrueMotion& motion,
                          const std::filesystem::path& folder) {
  std::string cell;
  if (trial.load_cell)
    cell = ", " +
           WriteReaction(folder, CellReading(trial, recording, StampedTimes(), motion.forces), 1);
  return fmt::format(
      "gripped:\n  - {{name: clamp, half_space: {{point: [{} m, 0 m, 0 m], normal: [-1, 0, 0]}}, "
      "path: {{file: clamp.csv, time: t, x: x, y: y, z: z, turn: {{x: rx, y: ry, z: rz, about: [0, "
      "0, 0]}}}}{}}}\n"
      "reference: {{from: mesh, file: box.off}}\n",
      kTrialFace, cell);
}

void WriteMarkers(const TrialCase& trial, int recording, const TrueMotion& motion,
                  const std::filesystem::path& folder) {
  std::vector<Eigen::Matrix3Xd> frames =
      SeenMarkers(trial, recording, motion, MarkerPlaces(trial.true_size));
  SpoilFrame(trial, recording, &frames);
  Markers markers{{}, MarkerPlaces(trial.size), frames};
  for (int m = 0; m < kMarkers; ++m) {
    markers.names.push_back(fmt::format("m{}", m));
    markers.places.col(m) += PlaceError(trial, m);
  }
  const std::string yaml = fmt::format(
      "schema_version: 1\nname: recording {}\nlength_unit: m\ndensity: {} kg/m^3\nframes:\n{}",
      recording + 1, kTrialDensity, WriteMarkerFrames(folder, StampedTimes(), markers));
  WriteFileAtomically(folder / "recording.yaml",
                      yaml + ShapeAndClamp(trial, recording, motion, folder));
}

void WriteScans(const TrialCase& trial, int recording, const TrueMotion& motion,
                const std::filesystem::path& folder) {
  std::vector<Eigen::Matrix3Xd> frames = motion.positions;
  SpoilFrame(trial, recording, &frames);
  std::vector<TriMesh> surfaces;
  for (const Eigen::Matrix3Xd& nodes : frames)
    surfaces.push_back(BoundaryAt(motion.body->boundary, nodes));
  CameraRing ring;
  ring.center = {0.5 * trial.size[0], 0, 0};
  ring.up = Eigen::Vector3d::UnitX();  // so that both ends are visible
  ring.radius = 0.3;
  ring.elevation = 0.6;
  ring.width = 120;
  ring.height = 90;
  ring.field_of_view = 0.6;
  ScannerOptions scanner;
  scanner.noise = trial.noise;
  scanner.seed = RandomBits({trial.seed, 70, static_cast<uint64_t>(recording)});
  RecordedObject object;
  object.density = kTrialDensity;
  WriteScan(folder, fmt::format("recording {}", recording + 1), object,
            {surfaces, StampedTimes(), PlaceCameras(ring), scanner}, WritePointFrames);
  std::filesystem::remove_all(folder / "truth");
  const std::filesystem::path description = folder / "recording.yaml";
  WriteFileAtomically(description,
                      ReadWholeFile(description) + ShapeAndClamp(trial, recording, motion, folder));
}

}  // namespace

std::vector<double> StampedTimes() {
  std::vector<double> times;
  for (int f = 0; f < kTrialFrames; ++f) times.push_back(kTrialSpacing * f);
  return times;
}

Eigen::Matrix3Xd MarkerPlaces(const Eigen::Vector3d& size) {
  Eigen::Matrix3Xd places(3, kMarkers);
  for (int m = 0; m < kMarkers; ++m) {
    const double angle = 0.5 * std::numbers::pi * (m % 4);
    places.col(m) << size[0] * (0.15 + 0.85 * m / (kMarkers - 1)), 0.5 * size[1] * std::cos(angle),
        0.5 * size[2] * std::sin(angle);
  }
  return places;
}

Eigen::Vector3d PlaceError(const TrialCase& trial, Eigen::Index marker) {
  const uint64_t m = static_cast<uint64_t>(marker);
  return kTrialPlaceError *
         Eigen::Vector3d(Gauss(trial, 30, m, 0), Gauss(trial, 30, m, 1), Gauss(trial, 30, m, 2));
}

std::vector<Eigen::Matrix3Xd> SeenMarkers(const TrialCase& trial, int recording,
                                          const TrueMotion& motion,
                                          const Eigen::Matrix3Xd& places) {
  const TetMesh& mesh = motion.body->mesh;
  const Embedding at = Embed(mesh, places);
  std::vector<Eigen::Matrix3Xd> frames;
  for (const Eigen::Matrix3Xd& position : motion.positions)
    frames.push_back(PointsAt(at, mesh, position));
  AddNoise(trial, recording, &frames);
  return frames;
}

void WriteRecording(const TrialCase& trial, int recording, const TrueMotion& motion,
                    const std::filesystem::path& folder) {
  MakeFolder(folder);
  WriteBox(trial, folder / "box.off");
  WriteClampPath(recording, folder / "clamp.csv");
  if (trial.is_scanned)
    WriteScans(trial, recording, motion, folder);
  else
    WriteMarkers(trial, recording, motion, folder);
}

}  // namespace lacuna
