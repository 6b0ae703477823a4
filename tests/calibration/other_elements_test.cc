#include "calibration/other_elements.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "geometry/mesh_io.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

class OtherElementsTest : public testing::Test {
 protected:
  OtherElementsTest() {
    Eigen::Matrix3Xd moved = BarMarkerPlaces();
    moved.row(1).array() += 0.003;
    std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
    frames[kFrames / 3] = moved;
    WriteBarRecording(folder_.Path(), frames);
  }

  PredictionStudy StudyWith(const std::string& mesh) const {
    return ReadBarStudy(folder_.Path(), {{"max_volume: 1000 mm^3, order: 2", mesh}});
  }
  void ReplaceInRecording(const std::string& from, const std::string& to) const {
    ReplaceInFile(folder_ / "recording.yaml", from, to);
  }
  void GiveMesh(const TetMesh& mesh) const {
    WriteTetMesh(folder_ / "bar.msh", mesh);
    ReplaceInRecording("{from: mesh, file: box.off}", "{from: tet_mesh, file: bar.msh}");
  }

  TemporaryFolder folder_;
};

double RatioOf(const TetMesh& own, const TetMesh& other) {
  return TetVolumes(own).mean() / TetVolumes(other).mean();
}

void ExpectSameBody(const TetMesh& own, const TetMesh& other) {
  EXPECT_EQ(other.Order(), own.Order());
  EXPECT_NEAR(TetVolumes(other).sum(), TetVolumes(own).sum(), 1e-9 * TetVolumes(own).sum());
  EXPECT_LT((other.nodes.rowwise().minCoeff() - own.nodes.rowwise().minCoeff()).norm(), 1e-12);
  EXPECT_LT((other.nodes.rowwise().maxCoeff() - own.nodes.rowwise().maxCoeff()).norm(), 1e-12);
}

TEST_F(OtherElementsTest, HaveTheRatioThatTheyAreReportedWith) {
  const PredictionStudy study =
      StudyWith("max_volume: 1000 mm^3, preserve_surface: false, order: 2");
  const TetMesh own = MakeReferenceBody(study).mesh;
  for (const double wanted : {4.0, 12.0}) {
    const auto other = MeshWithOtherElements(study, own, wanted);
    ASSERT_TRUE(other.has_value());
    ExpectSameBody(own, other->mesh);
    EXPECT_NEAR(other->ratio, RatioOf(own, other->mesh), 1e-9 * other->ratio);
    EXPECT_GT(other->ratio, wanted / 2);
    EXPECT_LT(other->ratio, wanted * 2);
  }
}

// The twelve triangles of the box are preserved, so that no max_volume gives more than six
// tetrahedra.
TEST_F(OtherElementsTest, AreSmallerWhereThePreservedTrianglesAreTheLimit) {
  for (const char* mesh : {"max_volume: 150 mm^3, order: 2", "max_volume: 1000 mm^3, order: 2"}) {
    const PredictionStudy study = StudyWith(mesh);
    const TetMesh own = MakeReferenceBody(study).mesh;
    ASSERT_LT(own.TetCount(), 12);
    const auto other = MeshWithOtherElements(study, own, 12);
    ASSERT_TRUE(other.has_value());
    ExpectSameBody(own, other->mesh);
    EXPECT_NEAR(other->ratio, RatioOf(own, other->mesh), 1e-9 * other->ratio);
    EXPECT_GT(other->ratio, 4);
    EXPECT_LT(other->ratio, 24);
  }
}

TEST_F(OtherElementsTest, AreSmallerThanThoseOfAGivenMesh) {
  GiveMesh(BarMesh({8, 2, 2}, 1));
  const PredictionStudy study = StudyWith("max_volume: 150 mm^3, order: 2");
  const TetMesh own = MakeReferenceBody(study).mesh;
  const auto other = MeshWithOtherElements(study, own, 4);
  ASSERT_TRUE(other.has_value());
  ExpectSameBody(own, other->mesh);
  EXPECT_GT(other->ratio, 2);
  EXPECT_LT(other->ratio, 8);
  EXPECT_FALSE(MeshWithOtherElements(study, own, 0.25).has_value())
      << "the triangles of a given mesh cannot become larger";
}

TEST_F(OtherElementsTest, AreNotMadeWhereNodesAreListed) {
  GiveMesh(BarMesh({8, 2, 2}, 1));
  ReplaceInRecording("half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}",
                     "nodes: [0, 9, 18]");
  const PredictionStudy study = StudyWith("max_volume: 150 mm^3, order: 2");
  EXPECT_FALSE(MeshWithOtherElements(study, MakeReferenceBody(study).mesh, 4).has_value());
}

TEST_F(OtherElementsTest, AreNotMadeForASheet) {
  ReplaceInRecording("file: box.off}", "file: sheet.off, sheet: {thickness: 2 mm}}");
  std::ofstream(folder_ / "sheet.off") << "OFF\n4 2 0\n0 -0.01 0\n0.08 -0.01 0\n0.08 0.01 0\n"
                                          "0 0.01 0\n3 0 1 2\n3 0 2 3\n";
  const PredictionStudy study = StudyWith("max_volume: 150 mm^3, order: 2");
  EXPECT_FALSE(MeshWithOtherElements(study, MakeReferenceBody(study).mesh, 4).has_value());
}

}  // namespace
}  // namespace lacuna
