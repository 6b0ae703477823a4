#include "fuzz/readers.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "core/config.h"
#include "core/error.h"
#include "core/npy.h"
#include "core/text_file.h"
#include "exchange/inp_reader.h"
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

void ReadTets(const Path& file) {
  const TetMesh mesh = ReadTetMesh(file).mesh;
  CHECK_GE(mesh.tets.minCoeff(), 0);
  CHECK_LT(mesh.tets.maxCoeff(), mesh.NodeCount());
  CHECK_GT(TetVolumes(mesh).minCoeff(), 0);
}

// A folder that is gone when the object is.
struct Folder {
  Path path = std::filesystem::temp_directory_path() / fmt::format("lacuna_tetgen_{}", getpid());
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

// The two files of TetGen stand in one, divided by a line "elements".
void ReadTetGenFiles(const Path& file) {
  constexpr std::string_view kDivider = "elements\n";
  const std::string content = ReadWholeFile(file);
  const size_t nodes = std::min(content.find(kDivider), content.size());
  const size_t elements = std::min(nodes + kDivider.size(), content.size());
  const Folder folder;
  std::ofstream(folder.path / "mesh.node", std::ios::binary) << content.substr(0, nodes);
  std::ofstream(folder.path / "mesh.ele", std::ios::binary) << content.substr(elements);
  NamingWhere(file.string(), [&] { ReadTets(folder.path / "mesh.ele"); });
}

void ReadModel(const Path& file) {
  const ImportedModel model = ReadInp(file);
  const auto check = [](const std::vector<NamedNodes>& sets, Eigen::Index count) {
    for (const NamedNodes& set : sets) {
      CHECK(!set.nodes.empty() && std::is_sorted(set.nodes.begin(), set.nodes.end()));
      CHECK_GE(set.nodes.front(), 0);
      CHECK_LT(set.nodes.back(), count);
    }
  };
  check(model.node_sets, model.mesh.NodeCount());
  check(model.element_sets, model.mesh.TetCount());
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
      {"gmsh", ".msh", ReadTets},
      {"tet_lines", ".tet", ReadTets},
      {"tet_counted", ".txt", ReadTets},
      {"tetgen", ".tetgen", ReadTetGenFiles},
      {"medit", ".mesh", ReadTets},
      {"inp", ".inp", ReadModel},
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
