#include "scan/scan_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/npy.h"
#include "core/quoted_text.h"
#include "scan/recording_writer.h"

namespace lacuna {
namespace {

std::string FormatTimes(const std::vector<double>& times) {
  std::vector<std::string> texts;
  for (const double time : times) texts.push_back(fmt::format("{} s", time));
  return fmt::format("  times: [{}]\n", fmt::join(texts, ", "));
}

std::filesystem::path TrueTriangles(const std::filesystem::path& folder) {
  return folder / "truth" / "triangles.npy";
}

std::filesystem::path TrueVertices(const std::filesystem::path& folder, size_t i) {
  return folder / "truth" / fmt::format("vertices_{:03d}.npy", i);
}

void WriteTruth(const std::filesystem::path& folder, const std::vector<TriMesh>& surfaces) {
  WriteNpyIntegers(TrueTriangles(folder), surfaces[0].triangles.cast<int64_t>());
  for (size_t i = 0; i < surfaces.size(); ++i) {
    WriteNpy(TrueVertices(folder, i), surfaces[i].vertices);
  }
}

}  // namespace

void WriteScan(const std::filesystem::path& folder, const std::string& name,
               const RecordedObject& object, const VirtualScan& scan, FrameWriter write_frames) {
  const std::vector<TriMesh>& surfaces = scan.surfaces;
  CHECK(!surfaces.empty() && !scan.cameras.empty());
  CHECK_EQ(surfaces.size(), scan.times.size());
  for (const TriMesh& surface : surfaces) CHECK(surface.triangles == surfaces[0].triangles);
  MakeFolder(folder / "frames");
  MakeFolder(folder / "truth");

  std::string yaml = fmt::format("# {}\nschema_version: 1\nname: {}\nlength_unit: m\n", kSimulated,
                                 QuotedText(name));
  yaml += WriteDensityAndGravity(object);
  yaml += "frames:\n" + write_frames(folder, scan) + FormatTimes(scan.times);
  yaml += WriteConstraints(folder, object);
  WriteTruth(folder, surfaces);
  WriteFileAtomically(folder / "recording.yaml", yaml);
}

TriMesh ReadTrueSurface(const std::filesystem::path& folder, int i) {
  const MatrixXi64 triangles = ReadNpyIntegers(TrueTriangles(folder));
  const Eigen::MatrixXd vertices = ReadNpyMatrix(TrueVertices(folder, i));
  if (vertices.rows() != 3 || vertices.cols() == 0)
    throw InputError({TrueVertices(folder, i).string()},
                     fmt::format("is an array of {} × {}; expected 3 × vertices", vertices.rows(),
                                 vertices.cols()));
  if (triangles.rows() != 3 || triangles.cols() == 0 || triangles.minCoeff() < 0 ||
      triangles.maxCoeff() >= vertices.cols())
    throw InputError({TrueTriangles(folder).string()},
                     fmt::format("expected an array of 3 × triangles with numbers of the {} "
                                 "vertices of frame {}, from 0",
                                 vertices.cols(), i));
  return {vertices, triangles.cast<int>()};
}

std::vector<std::filesystem::path> FilesOfTrueSurfaces(const std::filesystem::path& folder,
                                                       const std::vector<int>& frames) {
  std::vector<std::filesystem::path> files{TrueTriangles(folder)};
  for (const int frame : frames) files.push_back(TrueVertices(folder, frame));
  return files;
}

}  // namespace lacuna
