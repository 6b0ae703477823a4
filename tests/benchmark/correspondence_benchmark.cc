// Registers each frame of tracked points onto the next and tells how far the points come to lie
// from their true places.
//
//   correspondence_benchmark FRAMES [--hold-out-every K] [options of the registration]
//   correspondence_benchmark FRAMES [--hold-out-every K] --write FOLDER
//   correspondence_benchmark FRAMES [--hold-out-every K] --judge FOLDER
//
// FRAMES holds points_00.csv, points_01.csv … (tracked_frames.h). The second form writes the pairs
// for another program, as y_<n>.txt and x_<n>.txt in mm; the third judges its displaced points,
// peer_<n>_y.txt, in the same way.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "registration/coherent_point_drift.h"
#include "registration/tracked_frames.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetre = 1e-3;

void WritePoints(const fs::path& path, const Eigen::Matrix3Xd& points) {
  std::ofstream file(path);
  for (const auto point : points.colwise()) {
    file << fmt::format("{:.9f}\t{:.9f}\t{:.9f}\n", point[0] / kMillimetre, point[1] / kMillimetre,
                        point[2] / kMillimetre);
  }
}

Eigen::Matrix3Xd ReadResult(const fs::path& path, Eigen::Index count) {
  std::ifstream file(path);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(file >> points(0, i) >> points(1, i) >> points(2, i)))
      throw InputError({path.string()}, fmt::format("expected {} lines of three numbers", count));
  }
  return kMillimetre * points;
}

std::vector<Eigen::Matrix3Xd> ReadFrames(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Eigen::Matrix3Xd> frames;
  for (const fs::path& file : files) frames.push_back(ReadTrackedFrame(file));
  return frames;
}

// Figures over the pairs, in the unit of what is added.
struct Figure {
  double sum = 0.0;
  double largest = 0.0;
  int count = 0;

  void Add(double value) {
    sum += value;
    largest = std::max(largest, value);
    ++count;
  }
  double Mean() const { return sum / std::max(1, count); }
};

int Main(int argc, char** argv) {
  CLI::App app("Error of the correspondence of tracked points");
  std::string frames_folder, write_folder, judge_folder;
  int hold_out_every = 5, threads = ThreadCount();
  bool in_place = false;
  CpdOptions options;
  options.tangential_weight = 1.0;
  options.rigidity = 0.0;
  options.fine_variance = 0.0;
  options.sigma_floor = 0.1;
  options.points_per_function = 1;
  options.max_rank = 2000;
  app.add_option("FRAMES", frames_folder, "folder of points_<n>.csv")->required();
  app.add_option("--hold-out-every", hold_out_every, "points kept from both frames; 0: none");
  app.add_option("--threads", threads);
  app.add_option("--beta", options.beta);
  app.add_option("--lambda", options.lambda);
  app.add_option("--rank-tolerance", options.rank_tolerance);
  app.add_option("--sigma-floor", options.sigma_floor);
  app.add_option("--initial-sigma", options.initial_sigma, "m; 0: from the distances");
  app.add_flag("--in-place", in_place, "start in place, not from the target's mean and size");
  app.add_option("--write", write_folder, "write the pairs here, register nothing");
  app.add_option("--judge", judge_folder, "judge the results in this folder, register nothing");
  CLI11_PARSE(app, argc, argv);
  SetThreadCount(threads);
  options.match_extents = !in_place;
  if (!write_folder.empty()) fs::create_directories(write_folder);

  const std::vector<Eigen::Matrix3Xd> frames = ReadFrames(frames_folder);
  Figure rms, held_out, seconds;
  int mistaken = 0, failed = 0, rank = 0;
  for (size_t n = 0; n + 1 < frames.size(); ++n) {
    const TrackedPair pair = MakeTrackedPair(frames[n], frames[n + 1], hold_out_every);
    if (!write_folder.empty()) {
      WritePoints(fs::path(write_folder) / fmt::format("y_{:02}.txt", n), pair.source.points);
      WritePoints(fs::path(write_folder) / fmt::format("x_{:02}.txt", n), pair.target.points);
      continue;
    }
    Eigen::Matrix3Xd displaced;
    if (!judge_folder.empty()) {
      displaced = ReadResult(fs::path(judge_folder) / fmt::format("peer_{:02}_y.txt", n),
                             pair.source.Size());
    } else {
      const std::clock_t start = std::clock();
      const CpdResult result = RegisterNonrigid(pair.source, pair.target, options);
      seconds.Add(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
      if (!result.IsUsable()) {
        ++failed;
        fmt::print("pair {}: {}\n", n, result.message);
        continue;
      }
      rank = std::max(rank, result.rank);
      displaced = result.displaced;
      const Eigen::Matrix3Xd miss =
          pair.held_out + result.field.Evaluate(pair.held_out) - pair.held_out_target;
      if (miss.cols() > 0) held_out.Add(std::sqrt(miss.colwise().squaredNorm().mean()));
    }
    const CorrespondenceError error = ErrorOf(pair, displaced);
    rms.Add(error.rms);
    mistaken += error.mistaken;
  }
  if (!write_folder.empty()) return 0;
  fmt::print("{} pairs, {} failed: rms mean {:.5f} max {:.5f} mm, {} points mistaken", rms.count,
             failed, rms.Mean() / kMillimetre, rms.largest / kMillimetre, mistaken);
  if (held_out.count > 0) {
    fmt::print("; held out: mean {:.5f} max {:.5f} mm", held_out.Mean() / kMillimetre,
               held_out.largest / kMillimetre);
  }
  if (seconds.count > 0) fmt::print("; rank {}, cpu {:.4f} s per pair", rank, seconds.Mean());
  fmt::print("\n");
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  try {
    return lacuna::Main(argc, argv);
  } catch (const lacuna::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
