// Files of tetrahedral meshes in all formats, sound and damaged; tet_mesh_io_test.cc has the
// hostile ones.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "geometry/mesh_files.h"
#include "geometry/mesh_io.h"
#include "geometry/surface_check.h"
#include "support/box_mesh.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string TetFailure(const std::filesystem::path& file) { return FailureOf(ReadTetMesh, file); }

class TetOrder : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Both, TetOrder, ::testing::Values(1, 2));

TEST_P(TetOrder, RoundTripsThroughGmsh) {
  const TemporaryFolder folder;
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.1, 0.2, 0.3}, {2, 2, 3}, GetParam());
  ASSERT_EQ(mesh.Order(), GetParam());
  WriteTetMesh(folder / "a.msh", mesh);
  const TetMeshFile read = ReadTetMesh(folder / "a.msh");
  EXPECT_EQ(read.mesh.nodes, mesh.nodes);
  EXPECT_EQ(read.mesh.tets, mesh.tets);
  EXPECT_THAT(read.notes, IsEmpty());
}

// Two tetrahedra on either side of a face, in each text format.
constexpr char kMsh[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n"
    "$Elements\n3\n1 2 2 0 1 10 20 30\n2 4 2 0 1 10 20 30 40\n3 4 2 0 1 20 30 40 50\n"
    "$EndElements\n";
constexpr char kTet[] = "t 0 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nt 1 2 3 4\n";
constexpr char kTxt[] = "5 2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n0 1 2 3\n1 2 3 4\n";
constexpr char kMedit[] =
    "MeshVersionFormatted 2\nDimension\n3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
    "1 1 1 0\nTriangles\n1\n1 2 3 7\nTetrahedra\n2\n1 2 3 4 0\n2 3 4 5 0\nEnd\n";
constexpr char kNode[] = "# nodes\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n";
constexpr char kEle[] = "2 4 0\n1 1 2 3 4\n2 2 3 4 5 # the other\n";

class TetFormat : public ::testing::TestWithParam<TextFile> {};
INSTANTIATE_TEST_SUITE_P(All, TetFormat,
                         ::testing::Values(TextFile{"a.msh", kMsh}, TextFile{"a.tet", kTet},
                                           TextFile{"a.txt", kTxt}, TextFile{"a.mesh", kMedit},
                                           TextFile{"a.ele", kEle}));

TEST_P(TetFormat, GivesTheSameTwoTetrahedra) {
  const TemporaryFolder folder;
  Write(folder / "a.node", kNode);
  const TetMeshFile read = ReadTetMesh(Write(folder / GetParam().name, GetParam().content));
  EXPECT_EQ(read.mesh.NodeCount(), 5);
  ASSERT_EQ(read.mesh.TetCount(), 2);
  EXPECT_DOUBLE_EQ(TetVolumes(read.mesh)(0), 1.0 / 6);
  EXPECT_DOUBLE_EQ(TetVolumes(read.mesh)(1), 1.0 / 3);
  EXPECT_EQ(read.mesh.tets.col(0), Eigen::Vector4i(0, 1, 2, 3));
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST_P(TetFormat, RefusesEveryTruncation) {
  const TemporaryFolder folder;
  Write(folder / "a.node", kNode);
  const auto& [name, content] = GetParam();
  const std::string whole(content);
  // A comment at the end of the .ele file may be missing. The .tet format has no end mark, but a
  // line cut in the middle is noticed.
  const std::string needed = whole.substr(0, whole.find(" # the other"));
  for (size_t cut = 0; cut + 1 < needed.size(); ++cut) {
    if (std::string(name) == "a.tet" &&
        (needed[cut] == '\n' || (cut > 0 && needed[cut - 1] == '\n')))
      continue;
    if (std::string(name) == "a.mesh" && cut + 1 >= needed.find_last_of('E') + 3) continue;
    const auto file = Write(folder / name, needed.substr(0, cut));
    EXPECT_THAT(TetFailure(file), HasSubstr(file.string())) << needed.substr(0, cut);
  }
}

TEST_P(TetFormat, NamesTheLineOfABadIndex) {
  const TemporaryFolder folder;
  Write(folder / "a.node", kNode);
  const auto& [name, content] = GetParam();
  std::string text(content);
  // The last node of the last tetrahedron becomes 99.
  const std::string last = std::string(name) == "a.msh"              ? "40 50"
                           : text.find("3 4 5") != std::string::npos ? "4 5"
                                                                     : "3 4\n";
  const size_t place = text.rfind(last);
  const auto line = 1 + std::count(text.begin(), text.begin() + place, '\n');
  text.replace(place, last.size(),
               last.substr(0, last.find(' ')) + " 99" + (last.back() == '\n' ? "\n" : ""));
  const auto file = Write(folder / name, text);
  EXPECT_THAT(TetFailure(file),
              HasSubstr(fmt::format("{}:{}: there is no node 99", file.string(), line)));
}

TEST_P(TetFormat, NamesTheLineOfANumberThatIsNotFinite) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  if (std::string(name) == "a.ele") GTEST_SKIP() << "coordinates stand in the .node file";
  std::string text(content);
  text.replace(text.find("1 1 1"), 5, "1 nan 1");
  const auto file = Write(folder / name, text);
  const auto line = 1 + std::count(text.begin(), text.begin() + text.find("nan"), '\n');
  EXPECT_THAT(TetFailure(file), AllOf(HasSubstr(fmt::format("{}:{}:", file.string(), line)),
                                      HasSubstr("not finite")));
}

TEST(TetFiles, AreTwoOfTetGenAndOneOfOthers) {
  EXPECT_THAT(FilesOfTetMesh("a/b.ele"), ElementsAre("a/b.node", "a/b.ele"));
  EXPECT_THAT(FilesOfTetMesh("a/b.node"), ElementsAre("a/b.node", "a/b.ele"));
  EXPECT_THAT(FilesOfTetMesh("a/b.msh"), ElementsAre("a/b.msh"));
}

TEST(ReadTetMesh, ReordersNegativeTetrahedraWithANote) {
  const TemporaryFolder folder;
  for (const int order : {1, 2}) {
    const TetMesh box = BoxMesh({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, order);
    TetMesh mirrored = box;
    mirrored.nodes.row(0) *= -1;
    WriteTetMesh(folder / "a.msh", mirrored);
    const TetMeshFile read = ReadTetMesh(folder / "a.msh");
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("reoriented 48 of 48")));
    EXPECT_GT(TetVolumes(read.mesh).minCoeff(), 0);
    // Edge nodes are still the midpoints of their edges: the boundary stays closed and flat.
    const SurfaceReport report = CheckSurface(ExtractBoundary(read.mesh).surface);
    EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
    EXPECT_NEAR(report.area, 6, 1e-12);
  }
}

TEST(ReadTetMesh, DropsUnusedNodesAndReportsWhichRemain) {
  const TemporaryFolder folder;
  const TetMeshFile read = ReadTetMesh(
      Write(folder / "a.tet", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 8 8 8\nv 0 1 0\nv 0 0 1\nt 1 2 4 5\n"));
  EXPECT_EQ(read.mesh.NodeCount(), 4);
  EXPECT_EQ(read.node_in_file, Eigen::Vector4i(1, 2, 4, 5));
  EXPECT_DOUBLE_EQ(TetVolumes(read.mesh)(0), 1.0 / 6);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("dropped 2 nodes")));
}

// Gmsh 2.2 writes an element once for each physical group of its volume.
TEST(ReadTetMesh, DropsTetrahedraThatAreListedAgainWithANote) {
  const TemporaryFolder folder;
  std::string text(kMsh);
  const auto replace = [&text](const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
  };
  replace("$Elements\n3\n", "$Elements\n5\n");
  replace("$EndElements", "4 4 2 9 1 10 20 30 40\n5 4 2 9 1 20 30 40 50\n$EndElements");
  const TetMeshFile read = ReadTetMesh(Write(folder / "a.msh", text));
  EXPECT_EQ(read.mesh.TetCount(), 2);
  EXPECT_EQ(read.mesh.tets.col(0), Eigen::Vector4i(0, 1, 2, 3));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("dropped 2 tetrahedra that repeat")));
}

TEST(ReadTetMesh, RefusesTetrahedraThatFormNoMesh) {
  const TemporaryFolder folder;
  const std::string nodes = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.2 0.2 3\nv 1 1 0\nv 0 0 -1\n";
  const auto failure = [&](const std::string& tets) {
    return TetFailure(Write(folder / "a.tet", nodes + tets));
  };
  EXPECT_THAT(failure(""), HasSubstr("has no tetrahedra"));
  EXPECT_THAT(failure("t 0 1 2 2\n"), HasSubstr("a.tet:8: a tetrahedron refers to one node twice"));
  EXPECT_THAT(failure("t 0 1 2 5\n"), HasSubstr("a.tet:8: tetrahedron 1 has no volume"));
  EXPECT_THAT(failure("t 0 1 2 3\nt 0 1 2 4\n"), HasSubstr("tetrahedra 1 and 2 overlap"));
  EXPECT_THAT(failure("t 0 1 2 3\nt 0 1 2 6\nt 0 1 2 4\n"), HasSubstr("share a face with a third"));
}

TEST(ReadTetMesh, RefusesOtherVersionsOfGmsh) {
  const TemporaryFolder folder;
  EXPECT_THAT(TetFailure(Write(folder / "a.msh", "$MeshFormat\n4.0 0 8\n$EndMeshFormat\n")),
              AllOf(HasSubstr("a.msh:2: Gmsh version 4 "), HasSubstr("msh2")));
  EXPECT_THAT(TetFailure(Write(folder / "a.msh", "$MeshFormat\n2.2 1 8\n\1\n$EndMeshFormat\n")),
              HasSubstr("binary"));
}

TEST(ReadTetMesh, ErrorNamesAFileThatIsAbsentOrOfUnknownFormat) {
  const TemporaryFolder folder;
  EXPECT_THAT(TetFailure(folder / "none.msh"), HasSubstr("none.msh: cannot be read"));
  EXPECT_THAT(TetFailure(folder / "a.vtu"), HasSubstr("expected .msh"));
  EXPECT_THAT(TetFailure(Write(folder / "lonely.ele", kEle)), HasSubstr("lonely.node"));
}

class PublishedMesh : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, PublishedMesh,
                         ::testing::Values("liver_sequence/mesh-default/liver.msh",
                                           "liver_sequence/mesh-remeshed/liver.msh",
                                           "silicone_lidar/cad/cantilever_f1494_v749.tet"));

TEST_P(PublishedMesh, IsReadAndHasAClosedBoundary) {
  const std::filesystem::path file = SharedData() / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "skipped, data absent";
  const TetMeshFile read = ReadTetMesh(file);
  const SurfaceReport report = CheckSurface(ExtractBoundary(read.mesh).surface);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_NEAR(report.volume, TetVolumes(read.mesh).sum(), 1e-12 * report.volume);
}

}  // namespace
}  // namespace lacuna
