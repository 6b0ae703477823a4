// Hostile files of tetrahedral meshes; tet_mesh_formats_test.cc has the sound ones.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// What is wrong with a file of this content.
std::string Failure(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
  try {
    ReadTetMesh(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without complaint";
}

// What a count leaves out would be missing from the mesh without a word.
TEST(TetMeshFormats, RefuseLinesBehindThoseThatAreCounted) {
  const TemporaryFolder folder;
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n";
  EXPECT_THAT(Failure(folder / "a.txt", "5 1\n" + points + "0 1 2 3\n1 2 3 4\n"),
              HasSubstr("a.txt:8: a line follows, but the number of tetrahedra is 1"));
  // As sections, the fifth vertices would be named 1 and 0 and hide the lines that follow, or none.
  const std::string vertices = "Dimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
  for (const std::string name : {"1", "0"}) {
    EXPECT_THAT(
        Failure(folder / "a.mesh", vertices + name + " 0 2 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n"),
        HasSubstr("a.mesh:7: got \"" + name + "\"; expected a keyword such as Vertices"));
  }
  const std::string numbered = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
  Failure(folder / "a.node", "4 3 0 0\n" + numbered);
  EXPECT_THAT(Failure(folder / "a.ele", "1 4 0\n1 1 2 3 4\n2 1 2 3 4\n"),
              HasSubstr("a.ele:3: a line follows, but the number of tetrahedra is 1"));
  EXPECT_EQ(Failure(folder / "a.ele", "1 4 0\n1 1 2 3 4\n# the end\n"), "read without complaint");
  EXPECT_THAT(Failure(folder / "a.node", "3 3 0 0\n" + numbered),
              HasSubstr("a.node:5: a line follows, but the number of nodes is 3"));
}

TEST(TetMeshFormats, RefuseHostileCountsAndNumbers) {
  const TemporaryFolder folder;
  const std::string nodes = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const auto failure = [&](const char* name, const std::string& text) {
    return Failure(folder / name, text);
  };
  EXPECT_THAT(failure("a.txt", "9223372036854775807 1\n0 0 0\n"),
              HasSubstr("a.txt:2: the file ends where node 2 of"));
  EXPECT_THAT(failure("a.txt", "-1 1\n"), HasSubstr("a.txt:1: got -1; expected the number of"));
  EXPECT_THAT(failure("a.txt", "0 1\n0 1 2 3\n"),
              HasSubstr("a.txt:2: there is no node 0: none has been read"));
  for (const char* number : {"-1", "4", "9223372036854775807", "-9223372036854775808"})
    EXPECT_THAT(failure("a.tet", nodes + "t 0 1 2 " + number + "\n"),
                HasSubstr(fmt::format("a.tet:5: there is no node {}:", number)));
  EXPECT_THAT(failure("a.tet", nodes + "t 0 1 2 9223372036854775808\n"), HasSubstr("a.tet:5: got"));
  EXPECT_THAT(failure("a.tet", nodes + "t 0 1 2 3 0 1 2 3 0 1\n"),
              HasSubstr("a.tet:5: a tetrahedron has more than 4 nodes"));
  // Differences of these coordinates are infinite; the volume would not be a number.
  EXPECT_THAT(failure("a.tet",
                      "v -1e308 0 0\nv 1e308 -1e308 0\nv 0 1e308 -1e308\nv 1e308 -1e308 1e308\n"
                      "t 0 1 2 3\n"),
              HasSubstr("a.tet:5: tetrahedron 1 has a coordinate beyond 1e+100"));
}

// Their part of the body would be missing.
TEST(TetMeshFormats, RefuseVolumesOtherThanTetrahedra) {
  const TemporaryFolder folder;
  const std::string nodes =
      "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 1\n6 0 1 1\n$EndNodes\n";
  const auto msh = [&](const std::string& type) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + nodes + "$Elements\n2\n1 4 0 1 2 3 4\n2 " +
           type + "\n$EndElements\n";
  };
  EXPECT_THAT(Failure(folder / "a.msh", msh("6 0 1 2 3 4 5 6")),
              HasSubstr("a.msh:16: has 1 volume elements that are not read, the first of them a "
                        "prism (type 6 of Gmsh)"));
  EXPECT_EQ(Failure(folder / "a.msh", msh("3 0 1 2 5 4")), "read without complaint");
  const std::string msh41 =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n"
      "1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n2 2 1 2\n3 1 4 1\n1 1 2 3 4\n3 1 7 1\n"
      "2 1 2 3 4 5\n$EndElements\n";
  EXPECT_THAT(Failure(folder / "b.msh", msh41), HasSubstr("a pyramid (type 7 of Gmsh)"));
  const auto medit = [](const std::string& section) {
    return "Dimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n"
           "1 2 3 4 0\n" +
           section + "End\n";
  };
  EXPECT_THAT(Failure(folder / "a.mesh", medit("Hexahedra 1\n1 2 3 4 1 2 3 4 0\n")),
              HasSubstr("in the section Hexahedra"));
  EXPECT_EQ(Failure(folder / "a.mesh", medit("Hexahedra 0\nEdges 1\n1 2 0\n")),
            "read without complaint");
}

// Gmsh has the last two midside nodes in the opposite order of VTK and Abaqus.
TEST(TetMeshFormats, RefuseMidsideNodesInTheOrderOfAnotherFormat) {
  const TemporaryFolder folder;
  const auto msh = [](const std::string& last) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 2 0 0\n3 0 2 0\n"
           "4 0 0 2\n5 1 0 0\n6 1 1 0\n7 0 1 0.2\n8 0 0 1\n9 0 1 1\n10 1 0 1\n$EndNodes\n"
           "$Elements\n1\n1 11 0 1 2 3 4 5 6 7 8 " +
           last + "\n$EndElements\n";
  };
  EXPECT_EQ(Failure(folder / "a.msh", msh("9 10")), "read without complaint");
  EXPECT_THAT(Failure(folder / "a.msh", msh("10 9")),
              HasSubstr("a.msh:19: the midside nodes of tetrahedron 1 are not in the order of this "
                        "format: the one of corners 2 and 4 lies between corners 3 and 4"));
}

// Numbers that hash tables of the standard library put into one bucket must be found all the same.
// Without the hash this takes minutes.
TEST(TetMeshFormats, FindNodesWhoseNumbersHaveACommonFactor) {
  // The number of buckets of the standard library for so many nodes.
  constexpr long long kStride = 85229;
  const TemporaryFolder folder;
  std::string text = "80000 3 0 0\n";
  for (int n = 1; n <= 80000; ++n)
    text +=
        fmt::format("{} {} {} {}\n", n * kStride, n % 2, n % 3 == 0 ? 1 : 0, n % 5 == 0 ? 1 : 0);
  std::ofstream(folder / "a.node") << text;
  std::ofstream(folder / "a.ele") << fmt::format("1 4 0\n1 {} {} {} {}\n", kStride, 2 * kStride,
                                                 3 * kStride, 10 * kStride);
  EXPECT_EQ(ReadTetMesh(folder / "a.ele").mesh.NodeCount(), 4);
}

}  // namespace
}  // namespace lacuna
