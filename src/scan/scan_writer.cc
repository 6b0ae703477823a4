#include "scan/scan_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/npy.h"
#include "core/parallel.h"
#include "scan/point_file.h"

namespace lacuna {
namespace {

std::string FrameName(const char* prefix, size_t i, const char* extension) {
  return fmt::format("{}{:03d}{}", prefix, i, extension);
}

std::string Row(const Eigen::Matrix4d& m) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = m;
  return fmt::format("[{}]", fmt::join(rows.data(), rows.data() + 16, ", "));
}

std::string Triple(const Eigen::Vector3d& v, const char* unit) {
  return fmt::format("[{0} {3}, {1} {3}, {2} {3}]", v.x(), v.y(), v.z(), unit);
}

std::string FormatTimes(const std::vector<double>& times) {
  std::vector<std::string> texts;
  for (const double time : times) texts.push_back(fmt::format("{} s", time));
  return fmt::format("  times: [{}]\n", fmt::join(texts, ", "));
}

void WritePointFrames(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces,
                      const std::vector<VirtualCamera>& cameras, const ScannerOptions& options) {
  for (size_t i = 0; i < surfaces.size(); ++i) {
    const ScanResult scan = Scan(surfaces[i], cameras, options, static_cast<int>(i));
    if (scan.cloud.Size() == 0) {
      throw InputError(fmt::format("frame {}: no virtual camera sees the object", i));
    }
    WritePointFile(folder / FrameName("points_", i, ".ply"), scan.cloud);
  }
}

std::string FormatPointFrames(size_t count, const std::vector<VirtualCamera>& cameras) {
  std::string yaml = fmt::format(
      "  kind: points\n  pattern: frames/points_%03d.ply\n  count: {}\n  sensors:\n", count);
  for (const VirtualCamera& camera : cameras) {
    yaml += fmt::format("    - position: {}\n",
                        Triple(camera.camera.world_from_camera.translation(), "m"));
  }
  return yaml;
}

void WriteDepthFrames(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces,
                      const std::vector<VirtualCamera>& cameras, const ScannerOptions& options) {
  constexpr double kMaxCount = 65535;
  if (options.quantum <= 0) {
    throw InputError("depth images need a quantum > 0: one count of their 16 bits");
  }
  for (size_t i = 0; i < surfaces.size(); ++i) {
    for (size_t c = 0; c < cameras.size(); ++c) {
      const DepthImage depth = Measure(Render(surfaces[i], cameras[c]), cameras[c], options,
                                       static_cast<int>(i), static_cast<int>(c));
      if (depth.maxCoeff() > kMaxCount * options.quantum) {
        throw InputError(
            fmt::format("a depth of {:g} m does not fit in 16 bits with a quantum of "
                        "{:g} m",
                        depth.maxCoeff(), options.quantum));
      }
      WriteDepthPng(folder / FrameName(fmt::format("camera{}_", c + 1).c_str(), i, ".png"), depth,
                    options.quantum);
    }
  }
}

std::string FormatDepthFrames(size_t count, const std::vector<VirtualCamera>& cameras,
                              double quantum) {
  std::string yaml = fmt::format("  kind: depth\n  depth_unit: {} m\n  cameras:\n", quantum);
  for (size_t c = 0; c < cameras.size(); ++c) {
    const Camera& camera = cameras[c].camera;
    const Intrinsics& k = camera.intrinsics;
    yaml += fmt::format(
        "    - name: {}\n      pattern: frames/camera{}_%03d.png\n      count: {}\n"
        "      intrinsics: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n      world_from_camera: {}\n",
        camera.name, c + 1, count, k.fx, k.fy, k.cx, k.cy, Row(camera.world_from_camera.matrix()));
  }
  return yaml;
}

void WriteSeries(const std::filesystem::path& file, const Eigen::VectorXd& times,
                 const Eigen::Matrix3Xd& values) {
  std::string csv = "time,x,y,z\n";
  for (Eigen::Index k = 0; k < times.size(); ++k)
    csv += fmt::format("{},{},{},{}\n", times[k], values(0, k), values(1, k), values(2, k));
  WriteFileAtomically(file, csv);
}

std::string WriteForce(const std::filesystem::path& folder, const MeasuredForce& force,
                       size_t number) {
  const std::string name = fmt::format("force{}.csv", number + 1);
  WriteSeries(folder / name, force.times, force.forces);
  const std::string region =
      force.region ? fmt::format(", region: {}", FormatRegion(*force.region)) : "";
  return fmt::format("{{name: \"{}\", file: {}, time: time, x: x, y: y, z: z, unit: N{}}}",
                     force.name, name, region);
}

// The path of a grip becomes a CSV of its own.
std::string WriteGrip(const std::filesystem::path& folder, const RecordedGrip& grip,
                      size_t number) {
  CHECK(grip.motion != GripMotion::kFollowsMarkers) << "a virtual scanner sees no markers";
  std::string item = FormatRegion(grip.region);
  if (grip.motion == GripMotion::kFollowsScan) return item;
  CHECK_EQ(grip.turns.cols(), 0) << "grips of a scene shift, and do not turn";
  const std::string name = fmt::format("grip{}.csv", number + 1);
  WriteSeries(folder / name, grip.times, grip.displacements);
  item.pop_back();
  return item + fmt::format(", path: {{file: {}, time: time, x: x, y: y, z: z}}}}", name);
}

void WriteTruth(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces) {
  WriteNpyIntegers(folder / "triangles.npy", surfaces[0].triangles.cast<int64_t>());
  for (size_t i = 0; i < surfaces.size(); ++i) {
    WriteNpy(folder / FrameName("vertices_", i, ".npy"), surfaces[i].vertices);
  }
}

}  // namespace

void WriteScan(const std::filesystem::path& folder, const ScannedObject& object,
               const std::vector<TriMesh>& surfaces, const std::vector<double>& times,
               const std::vector<VirtualCamera>& cameras, const ScannerOptions& options,
               ScanOutput output) {
  CHECK(!surfaces.empty() && !cameras.empty());
  CHECK_EQ(surfaces.size(), times.size());
  for (const TriMesh& surface : surfaces) CHECK(surface.triangles == surfaces[0].triangles);
  MakeFolder(folder / "frames");
  MakeFolder(folder / "truth");

  std::string yaml = fmt::format("schema_version: 1\nname: \"{}\"\nlength_unit: m\n", object.name);
  if (object.density) yaml += fmt::format("density: {} kg/m^3\n", *object.density);
  if (object.gravity) yaml += fmt::format("gravity: {}\n", Triple(*object.gravity, "m/s^2"));
  yaml += "frames:\n";
  if (output == ScanOutput::kPoints) {
    WritePointFrames(folder / "frames", surfaces, cameras, options);
    yaml += FormatPointFrames(surfaces.size(), cameras);
  } else {
    WriteDepthFrames(folder / "frames", surfaces, cameras, options);
    yaml += FormatDepthFrames(surfaces.size(), cameras, options.quantum);
  }
  yaml += FormatTimes(times);
  if (!object.fixed.empty()) yaml += "fixed:\n";
  for (const Region& region : object.fixed) yaml += "  - " + FormatRegion(region) + "\n";
  if (!object.grips.empty()) yaml += "gripped:\n";
  for (size_t i = 0; i < object.grips.size(); ++i) {
    yaml += "  - " + WriteGrip(folder, object.grips[i], i) + "\n";
  }
  if (!object.forces.empty()) yaml += "forces:\n";
  for (size_t i = 0; i < object.forces.size(); ++i) {
    yaml += "  - " + WriteForce(folder, object.forces[i], i) + "\n";
  }
  WriteTruth(folder / "truth", surfaces);
  WriteFileAtomically(folder / "recording.yaml", yaml);
}

TriMesh ReadTrueSurface(const std::filesystem::path& folder, int i) {
  TriMesh surface;
  surface.triangles = ReadNpyIntegers(folder / "truth" / "triangles.npy").cast<int>();
  surface.vertices = ReadNpyMatrix(folder / "truth" / FrameName("vertices_", i, ".npy"));
  return surface;
}

}  // namespace lacuna
