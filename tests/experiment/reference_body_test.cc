#include "experiment/reference_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/rounded_box.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// Two frames of one closed mesh, which moves along z, in a folder with its recording.yaml.
void WriteMeshFrames(const std::filesystem::path& folder, bool tracked) {
  TriMesh box = RoundedBox({0.05, 0, 0}, {0.1, 0.03, 0.03}, 0, 0.01);
  WriteTriMesh(folder / "f_00.ply", box);
  box.vertices.row(2).array() += 0.002;
  WriteTriMesh(folder / "f_01.ply", box);
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nname: bar\nlength_unit: m\ndensity: 1000 kg/m^3\n"
      << "frames: {kind: mesh, files: f_*.ply, rate: 10 Hz, tracked: "
      << (tracked ? "true" : "false") << "}\n";
}

ReferenceBody MakeBody(const Recording& recording) {
  const std::string name = "bar";
  MeshSettings mesh;
  mesh.tets.max_volume = 1e-6;
  return MakeReferenceBody({name, recording, mesh});
}

// A mesh sequence with one topology needs no other reference shape: its first frame is closed.
TEST(ReferenceBody, OfATrackedMeshHasTheTrianglesOfItsFirstFrame) {
  const TemporaryFolder folder;
  WriteMeshFrames(folder.Path(), /*tracked=*/true);
  const ReferenceBody body = MakeBody(LoadRecording(folder.Path()));
  EXPECT_NEAR(body.quality.volume, 0.1 * 0.03 * 0.03, 1e-9);
  EXPECT_NEAR(body.mesh.nodes.row(2).maxCoeff(), 0.015, 1e-9);
}

TEST(ReferenceBody, WithoutASurfaceSaysWhatIsNeeded) {
  const TemporaryFolder folder;
  WriteMeshFrames(folder.Path(), /*tracked=*/false);
  const Recording recording = LoadRecording(folder.Path());
  EXPECT_THAT([&] { MakeBody(recording); },
              ThrowsMessage<InputError>(HasSubstr("the reference shape has no surface")));
}

}  // namespace
}  // namespace lacuna
