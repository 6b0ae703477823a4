#include "fuzz/readers.h"

#include <glog/logging.h>

#include <algorithm>
#include <stdexcept>

#include "core/config.h"
#include "core/error.h"
#include "core/npy.h"
#include "geometry/gmsh_io.h"
#include "geometry/mesh_io.h"
#include "scan/depth_image.h"
#include "scan/displacement_table.h"
#include "scan/marker_files.h"
#include "scan/point_file.h"
#include "scan/stepped_table.h"
#include "scan/table_header.h"

namespace lacuna {
namespace {

using Path = std::filesystem::path;

void ReadPoints(const Path& file) {
  std::vector<std::string> notes;
  CorrelationTable correlation;
  const PointCloud cloud = ReadPointFile(file, {}, &notes, &correlation);
  if (correlation.sigma.size() > 0) {
    CHECK_EQ(correlation.sigma.size(), cloud.Size());
  }
}

// Tables of image correlation, with all steps in one file, too.
void ReadCorrelation(const Path& file) {
  ReadHeaderValues(file);
  ReadPoints(file);
  const DelimitedTable table = ReadDelimitedTable(file);
  if (!FindColumn(table, "step")) return;
  const SteppedTable steps = DivideIntoSteps(table, "step", FindColumn(table, "t") ? "t" : "");
  for (size_t step = 0; step < std::min<size_t>(steps.rows.size(), 8); ++step)
    PointsOfTable(TableOfStep(steps, step), {});
}

void ReadMarkers(const Path& file) {
  const MarkerTracks tracks = ReadMarkerTracks(file, {});
  for (const Eigen::Matrix3Xd& positions : tracks.positions)
    CHECK_EQ(positions.cols(), static_cast<Eigen::Index>(tracks.names.size()));
}

}  // namespace

const std::vector<FuzzedReader>& FuzzedReaders() {
  static const std::vector<FuzzedReader> readers = {
      {"correlation", ".csv", ReadCorrelation},
      {"points_ply", ".ply", ReadPoints},
      {"points_pcd", ".pcd", ReadPoints},
      {"markers_csv", ".csv", ReadMarkers},  // and the tables of Qualisys, Motive and DeepLabCut
      {"markers_trc", ".trc", ReadMarkers},
      {"markers_c3d", ".c3d", ReadMarkers},
      {"mesh_ply", ".ply", [](const Path& file) { ReadTriMesh(file); }},
      {"mesh_obj", ".obj", [](const Path& file) { ReadTriMesh(file); }},
      {"mesh_stl", ".stl", [](const Path& file) { ReadTriMesh(file); }},
      {"mesh_off", ".off", [](const Path& file) { ReadTriMesh(file); }},
      {"gmsh", ".msh", [](const Path& file) { ReadGmsh(file); }},
      {"npy", ".npy", [](const Path& file) { ReadNpyMatrix(file); }},
      {"depth_png", ".png", [](const Path& file) { ReadDepthPng(file, 1e-3); }},
      {"yaml", ".yaml", [](const Path& file) { Config::Load(file).RefuseUnknownKeys(); }},
  };
  return readers;
}

const FuzzedReader& FuzzedReaderNamed(const std::string& name) {
  for (const FuzzedReader& reader : FuzzedReaders())
    if (reader.name == name) return reader;
  throw std::out_of_range("there is no reader " + name);
}

std::string ReadWith(const FuzzedReader& reader, const std::filesystem::path& file) {
  try {
    reader.read(file);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

}  // namespace lacuna
