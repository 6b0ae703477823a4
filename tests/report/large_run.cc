// Writes the folder of a run of `lacuna fit` whose motion is that of a long tube that swings,
// thinned as the program thins the motions that it shows:
//   large_run FOLDER VERTICES FRAMES
//   lacuna report FOLDER
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/hash.h"
#include "geometry/thinned_surface.h"
#include "record/motion_record.h"
#include "record/thinning_notes.h"
#include "support/small_ledger.h"
#include "support/small_run.h"

namespace lacuna {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLength = 0.3, kRadius = 0.02;  // m
constexpr double kTimeStep = 1e-3;               // s, for the speed

// A tube along x of nearly `vertices` vertices, without ends.
TriMesh Tube(int vertices) {
  const int around = static_cast<int>(std::sqrt(vertices / 2.4));
  const int along = vertices / around;
  TriMesh tube;
  tube.vertices.resize(3, along * around);
  tube.triangles.resize(3, 2 * (along - 1) * around);
  int next = 0;
  for (int i = 0; i < along; ++i)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * k / around;
      tube.vertices.col(i * around + k) = Eigen::Vector3d(
          kLength * i / (along - 1), kRadius * std::cos(angle), kRadius * std::sin(angle));
      if (i + 1 == along) continue;
      const int a = i * around + k, b = i * around + (k + 1) % around;
      tube.triangles.col(next++) = Eigen::Vector3i(a, b, a + around);
      tube.triangles.col(next++) = Eigen::Vector3i(b, b + around, a + around);
    }
  return tube;
}

// The deflection of a clamped bar in its first two modes, about.
Eigen::Matrix3Xd Displacement(const Eigen::Matrix3Xd& places, double time) {
  Eigen::Matrix3Xd moved = Eigen::Matrix3Xd::Zero(3, places.cols());
  for (Eigen::Index v = 0; v < places.cols(); ++v) {
    const double share = places(0, v) / kLength;
    moved(1, v) = 0.02 * std::sin(11 * time) * share * share * (share - 0.7);
    moved(2, v) = 0.05 * std::cos(7 * time) * share * share * (3 - share) / 2;
  }
  return moved;
}

MotionRecord SwingOf(const TriMesh& tube, int frames) {
  const ThinnedSurface shown = ThinSurface(tube, kMostShownVertices);
  const Eigen::Matrix3Xd places = tube.vertices(Eigen::all, shown.kept);
  const std::vector<int> chosen = EvenlySpread(frames, kMostShownFrames);
  const auto count = static_cast<Eigen::Index>(chosen.size());
  MotionRecord motion;
  motion.recording = "a";
  motion.up = Eigen::Vector3d::UnitZ();
  motion.triangles = shown.triangles;
  motion.times.resize(count);
  motion.positions.resize(places.size(), count);
  // The fields of a fit: two smooth ones, and one that is as rough as a strain of linear elements.
  const Eigen::MatrixXd empty(places.cols(), count);
  motion.fields = {{"displacement", "displacement", "m", empty},
                   {"speed", "speed", "m/s", empty},
                   {"strain", "largest principal strain", "", empty}};
  std::mt19937 random(1);
  Eigen::VectorXd roughness(places.cols());
  for (double& factor : roughness)
    factor = std::uniform_real_distribution<double>(0.8, 1.2)(random);
  for (Eigen::Index f = 0; f < count; ++f) {
    motion.times[f] = 0.01 * chosen[static_cast<size_t>(f)];
    const Eigen::Matrix3Xd moved = Displacement(places, motion.times[f]);
    motion.positions.col(f) = Eigen::Matrix3Xd(places + moved).reshaped();
    const Eigen::Matrix3Xd later = Displacement(places, motion.times[f] + kTimeStep);
    motion.fields[0].values.col(f) = moved.colwise().norm().transpose();
    motion.fields[1].values.col(f) = (later - moved).colwise().norm().transpose() / kTimeStep;
    motion.fields[2].values.col(f) = roughness.array() *
                                     (1 - places.row(0).transpose().array() / kLength) *
                                     std::abs(std::cos(7 * motion.times[f])) * 0.05;
  }
  motion.notes = NotesOnThinning(places.cols(), tube.vertices.cols(), count, frames);
  return motion;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  using namespace lacuna;
  if (argc != 4) {
    fmt::print(stderr, "usage: large_run FOLDER VERTICES FRAMES\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  WriteSmallFit(folder, {.name = folder.filename().string()}, SmallLedger().models[0].record);
  MotionRecord motion = SwingOf(Tube(std::stoi(argv[2])), std::stoi(argv[3]));
  motion.fit = HashFile(folder / "calibration/calibration.json");
  WriteMotionFile(motion, MotionFile(folder, 0));
  return 0;
}
