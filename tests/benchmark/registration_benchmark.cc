// Registers y.txt onto each x_*.txt of the given folders and writes the displaced points, for
// comparison with the true positions and with other programs.
//
//   registration_benchmark [--threads N] [--repeat N] [--out FOLDER] [--baseline | --avx2] DIR...
//
// Points are lines of three numbers. Writes OUT/<dir>_<case>.txt and prints a line per case: the
// medians over the repeats of wall and processor seconds, reading of the files included.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "registration/coherent_point_drift.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

PointCloud ReadPoints(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError({path.string()}, "cannot be read");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::vector<double> numbers;
  for (const char *at = text.data(), *end = at + text.size(); at != end;) {
    if (std::string_view(" \t\r\n,").find(*at) != std::string_view::npos) {
      ++at;
      continue;
    }
    double number;
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc())
      throw InputError({path.string()}, "holds something else than numbers");
    numbers.push_back(number);
    at = rest;
  }
  PointCloud cloud;
  cloud.points = Eigen::Map<Eigen::Matrix3Xd>(numbers.data(), 3, numbers.size() / 3);
  return cloud;
}

void WritePoints(const fs::path& path, const Eigen::Matrix3Xd& points) {
  std::ofstream file(path);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    file << fmt::format("{:.6f}\t{:.6f}\t{:.6f}\n", points(0, i), points(1, i), points(2, i));
  }
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void RunCase(const fs::path& folder, const std::string& name, const fs::path& out, int repeat,
             const CpdOptions& options) {
  std::vector<double> wall, processor;
  CpdResult result;
  for (int i = 0; i < repeat; ++i) {
    const auto wall_start = std::chrono::steady_clock::now();
    const std::clock_t processor_start = std::clock();
    const PointCloud source = ReadPoints(folder / "y.txt");
    const PointCloud target = ReadPoints(folder / (name + ".txt"));
    result = RegisterNonrigid(source, target, options);
    wall.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count());
    processor.push_back(static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC);
  }
  const std::string label = folder.filename().string() + "_" + name;
  fmt::print("{:28} wall {:.4f} s  cpu {:.4f} s  iterations {:3}  rank {}  {}\n", label,
             Median(wall), Median(processor), result.iterations, result.rank, result.message);
  if (!out.empty()) WritePoints(out / (label + ".txt"), result.displaced);
}

int Main(int argc, char** argv) {
  CLI::App app("Time and result of non-rigid registration");
  std::vector<std::string> folders;
  std::string out;
  int threads = ThreadCount(), repeat = 3;
  bool baseline = false, avx2 = false;
  app.add_option("DIR", folders, "folders with y.txt and x_*.txt")->required();
  app.add_option("--out", out, "folder for the displaced points");
  app.add_option("--threads", threads);
  app.add_option("--repeat", repeat)->check(CLI::PositiveNumber);
  app.add_flag("--baseline", baseline, "only instructions that every x86-64 processor has");
  app.add_flag("--avx2", avx2, "no instructions beyond AVX2");
  CLI11_PARSE(app, argc, argv);
  SetThreadCount(threads);
  CpdOptions options;
  if (baseline) options.kernels = &KernelsFor(InstructionSet::kBaseline);
  if (avx2) options.kernels = &KernelsFor(InstructionSet::kAvx2);
  if (!out.empty()) fs::create_directories(out);
  for (const std::string& folder : folders) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().stem().string();
      if (name.starts_with("x_") && entry.path().extension() == ".txt") names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    for (const std::string& name : names) RunCase(folder, name, out, repeat, options);
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("largest resident memory {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
  return 0;
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
