// A run that is repeated with other settings or other files must not take over what depends on
// them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/npy.h"
#include "geometry/mesh_io.h"
#include "geometry/rounded_box.h"
#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "support/box_mesh.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Two scans of a bar that moves by 2 mm along z, with the true surfaces, and a mesh of tetrahedra
// with an unused node in front of all others.
void WriteScans(const TemporaryFolder& folder) {
  TriMesh box = RoundedBox({0.05, 0, 0}, {0.1, 0.03, 0.03}, 0, 0.01);
  std::filesystem::create_directories(folder / "truth");
  WriteNpyIntegers(folder / "truth/triangles.npy", box.triangles.cast<int64_t>());
  for (const char* frame : {"0", "1"}) {
    WriteTriMesh(folder / (std::string("f_0") + frame + ".ply"), box);
    WriteNpy(folder / (std::string("truth/vertices_00") + frame + ".npy"), box.vertices);
    box.vertices.row(2).array() += 0.002;
  }
  const TetMesh mesh = BoxMesh({0, -0.015, -0.015}, {0.1, 0.015, 0.015}, {4, 1, 1});
  std::ofstream tets(folder / "body.tet");
  tets << "v 1 1 1\n";
  for (const auto node : mesh.nodes.colwise())
    tets << "v " << node.x() << ' ' << node.y() << ' ' << node.z() << '\n';
  for (const auto tet : mesh.tets.colwise()) {
    tets << 't';
    for (int a = 0; a < 4; ++a) tets << ' ' << tet[a] + 1;
    tets << '\n';
  }
  tets.close();
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nname: bar\nlength_unit: m\ndensity: 1000 kg/m^3\n"
         "frames: {kind: mesh, files: f_*.ply, rate: 10 Hz}\n"
         "fixed: [{half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
         "reference: {from: tet_mesh, file: body.tet}\n";
}

RunRecord RunBar(const TemporaryFolder& folder, const std::string& region) {
  SilentProgress progress;
  return RunReconstruction(
      ReadReconstruction(Config::Parse(
          "schema_version: 1\nname: bar\nrecording: " + folder.Path().string() +
              "\noutput: " + (folder / "run").string() +
              "\nmesh: {max_volume: 1 cm^3}\nmaterial: {law: linear, young_modulus: 0.1 MPa, "
              "poisson_ratio: 0.3}\nmotion: {scheme: quasi_static}\nfit: {noise: 0.1 mm}\n"
              "forces: {model: none, region: {" +
              region + "}}\nvalidation: {true_surfaces: " + (folder / "truth").string() + "}\n",
          "bar.yaml")),
      &progress);
}

TEST(ResumedRun, ChecksTheNodesOfANewRegionAndReadsNewTrueSurfaces) {
  const TemporaryFolder folder;
  WriteScans(folder);
  const std::string end = "half_space: {point: [0.09 m, 0 m, 0 m], normal: [1, 0, 0]}";
  const RunRecord first = RunBar(folder, end);
  ASSERT_TRUE(first.IsUsable());
  // The model stays where it is.
  const double distance = first.measures.at("true_surface_distance_max_m");
  EXPECT_GT(distance, 1e-4);

  Eigen::MatrixXd vertices = ReadNpyMatrix(folder / "truth/vertices_001.npy");
  vertices.row(2).array() += 0.01;
  WriteNpy(folder / "truth/vertices_001.npy", vertices);
  EXPECT_GT(RunBar(folder, end).measures.at("true_surface_distance_max_m"), distance + 1e-3);

  EXPECT_THAT([&] { RunBar(folder, "nodes: [1, 2]"); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr("region \"forces\" lists nodes by their numbers, but nodes "
                                     "that no tetrahedron uses are left out")));
}

}  // namespace
}  // namespace lacuna
