// Files of triangle meshes: sound ones, their variants, and what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <string>
#include <tuple>

#include "geometry/mesh_files.h"
#include "geometry/mesh_io.h"
#include "geometry/surface_check.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string TriFailure(const std::filesystem::path& file) { return FailureOf(ReadTriMesh, file); }

// The same square with one corner lifted, in each text format.
constexpr char kOff[] = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n3 0 2 3\n";
constexpr char kObj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
constexpr char kPly[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n3 0 2 3\n";
constexpr char kStl[] =
    "solid s\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0.5\n"
    "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 1 0.5\n"
    "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";

std::string Capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

class TriFormat : public ::testing::TestWithParam<TextFile> {};
INSTANTIATE_TEST_SUITE_P(All, TriFormat,
                         ::testing::Values(TextFile{"a.off", kOff}, TextFile{"a.obj", kObj},
                                           TextFile{"a.ply", kPly}, TextFile{"a.STL", kStl}));

TEST_P(TriFormat, GivesTheSameSquare) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  const TriMesh mesh = ReadTriMesh(Write(folder / name, content)).mesh;
  const SurfaceReport report = CheckSurface(mesh);
  EXPECT_EQ(report.vertices, 4);  // STL: merged
  EXPECT_EQ(report.triangles, 2);
  EXPECT_EQ(report.components, 1);
  EXPECT_TRUE(report.IsOriented());
  EXPECT_EQ(Eigen::Vector3d(BoundingBox(mesh.vertices).max()), Eigen::Vector3d(1, 1, 0.5));
}

TEST_P(TriFormat, RefusesATruncatedFile) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  const std::string whole(content);
  // Cut within the last face; an OBJ file may end after any number, so cut within a number.
  const size_t cut = whole.find_last_not_of('\n') + 1 - (whole.starts_with("solid") ? 40 : 2);
  const auto file = Write(folder / name, whole.substr(0, cut));
  EXPECT_THAT(TriFailure(file), HasSubstr(file.string() + ":"));
}

TEST_P(TriFormat, RefusesNumbersThatAreNotFinite) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  for (const char* bad : {"nan", "inf", "1e999"}) {
    std::string text(content);
    text.replace(text.find("0.5"), 3, bad);
    const auto file = Write(folder / name, text);
    EXPECT_THAT(TriFailure(file), HasSubstr(file.string() + ":")) << bad;
  }
}

TEST_P(TriFormat, RefusesCoordinatesWhoseProductsOverflow) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  std::string text(content);
  // PLY: as a float, it would be infinite.
  if (const size_t at = text.find("float z"); at != std::string::npos)
    text.replace(at, 5, "double");
  for (size_t at = text.find("0.5"); at != std::string::npos; at = text.find("0.5"))
    text.replace(at, 3, "1e200");
  EXPECT_THAT(TriFailure(Write(folder / name, text)), HasSubstr("has a coordinate beyond 1e+100"));
}

TEST(ReadTriMesh, RefusesIndicesOutOfRange) {
  const TemporaryFolder folder;
  for (const auto& [name, content, bad, worse] :
       {std::tuple("a.off", kOff, "3 0 2 3", "3 0 2 4"),
        std::tuple("a.obj", kObj, "f 1 3 4", "f 1 3 5"),
        std::tuple("b.obj", kObj, "f 1 3 4", "f 1 3 0"),
        std::tuple("c.obj", kObj, "f 1 3 4", "f 1 3 -9"),
        std::tuple("a.ply", kPly, "3 0 2 3", "3 0 2 4"),
        std::tuple("b.ply", kPly, "3 0 2 3", "3 0 2 -1")}) {
    std::string text(content);
    text.replace(text.find(bad), std::string(bad).size(), worse);
    const auto file = Write(folder / name, text);
    EXPECT_THAT(TriFailure(file), HasSubstr(file.string() + ":")) << worse;
  }
}

TEST(ReadTriMesh, ErrorNamesAFileThatIsAbsentEmptyOrOfUnknownFormat) {
  const TemporaryFolder folder;
  EXPECT_THAT(TriFailure(folder / "none.ply"), HasSubstr("none.ply: cannot be read"));
  EXPECT_THAT(TriFailure(Write(folder / "a.xyz", "0 0 0")),
              AllOf(HasSubstr("a.xyz"), HasSubstr("expected .ply, .obj, .stl or .off")));
  for (const char* name : {"e.ply", "e.obj", "e.stl", "e.off"}) {
    EXPECT_THAT(TriFailure(Write(folder / name, "")), HasSubstr(name));
  }
  EXPECT_THAT(TriFailure(Write(folder / "points.obj", "v 0 0 0\nv 1 0 0\n")),
              HasSubstr("2 vertices and 0 faces"));
}

TEST(ReadTriMesh, CutsPolygonsIntoTrianglesWithANote) {
  const TemporaryFolder folder;
  const auto file =
      Write(folder / "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 4/4\n");
  const TriMeshFile result = ReadTriMesh(file);
  EXPECT_EQ(result.mesh.triangles.cols(), 2);
  EXPECT_DOUBLE_EQ(TriangleAreas(result.mesh).sum(), 1);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("1 polygons")));
}

// The end of the letter L, from every corner: a fan around most of them would leave the polygon.
TEST(ReadTriMesh, CutsConcavePolygonsIntoTrianglesThatDoNotOverlap) {
  const TemporaryFolder folder;
  std::string vertices;
  for (const char* z : {"0", "1"})
    for (const char* place : {"0 0", "2 0", "2 1", "1 1", "1 2", "0 2"})
      vertices += fmt::format("v {} {}\n", place, z);
  for (int first = 0; first < 6; ++first) {
    std::string faces, bottom = "f", top = "f";
    for (int k = 0; k < 6; ++k) {
      top += fmt::format(" {}", 7 + (first + k) % 6);
      bottom += fmt::format(" {}", 1 + (first + 6 - k) % 6);
      faces += fmt::format("f {} {} {} {}\n", 1 + k, 1 + (k + 1) % 6, 7 + (k + 1) % 6, 7 + k);
    }
    const TriMesh mesh =
        ReadTriMesh(Write(folder / "l.obj", vertices + faces + top + "\n" + bottom + "\n")).mesh;
    const SurfaceReport report = CheckSurface(mesh);
    EXPECT_TRUE(report.BoundsVolume()) << first << ": " << DescribeFaults(report);
    EXPECT_NEAR(report.volume, 3, 1e-12) << first;
    EXPECT_NEAR(report.area, 2 * 3 + 8, 1e-12) << first;
  }
}

TEST(ReadTriMesh, RefusesAPlyFileWithoutACoordinate) {
  const TemporaryFolder folder;
  for (const char* name : {"x", "y", "z"}) {
    std::string text(kPly);
    const std::string line = fmt::format("property float {}\n", name);
    text.replace(text.find(line), line.size(), fmt::format("property float {}\n", Capitals(name)));
    EXPECT_THAT(TriFailure(Write(folder / "a.ply", text)),
                HasSubstr(fmt::format("a.ply: its vertices have no property \"{}\"", name)));
  }
}

TEST(WriteTriMesh, RoundTripsBitByBit) {
  const TemporaryFolder folder;
  const TriMesh mesh = OrganicSurface(3);
  WriteTriMesh(folder / "a.ply", mesh);
  const TriMeshFile read = ReadTriMesh(folder / "a.ply");
  EXPECT_EQ(read.mesh.vertices, mesh.vertices);
  EXPECT_EQ(read.mesh.triangles, mesh.triangles);
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST(WriteTriMesh, WritesAFileWhoseTruncatedCopyIsRefused) {
  const TemporaryFolder folder;
  WriteTriMesh(folder / "a.ply", Icosphere(1, 2));
  const std::string whole = FileContent(folder / "a.ply");
  for (const double part : {0.1, 0.5, 0.9, 0.999}) {
    const auto file =
        Write(folder / "b.ply", whole.substr(0, static_cast<size_t>(part * whole.size())));
    EXPECT_THAT(TriFailure(file), HasSubstr(file.string() + ":")) << part;
  }
}

// A file's vertices and triangles: "4 2", or what is wrong with it.
std::string Counts(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  const auto file = Write(folder / name, content);
  try {
    const TriMesh mesh = ReadTriMesh(file).mesh;
    return fmt::format("{} {}", mesh.vertices.cols(), mesh.triangles.cols());
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ReadTriMesh, ReadsObjAsItIsWritten) {
  const std::string v = "v\t0\t0\t0\nv  1 0 0 \nv 1 1 0.5 0.2 0.3 0.4\r\nv 0 1 0\n";
  for (const char* faces :
       {"f\t1\t2\t3\nf\t1\t3\t4\n", "f 1/1 2/2 3/3\nf 1//1 3//2 4//1\n",
        "f  1/1/1  2/2/1  3/3/1 \nf 1/1/1 3/3/1 4/4/1", "f -4 -3 -2\nf -4/1 -2//1 -1/2/3\n",
        "g a\ns off\nusemtl m\nf 1 2 \\\n3\nf 1 3 4 # the other\n"}) {
    EXPECT_EQ(Counts("a.obj", v + faces), "4 2") << faces;
  }
  EXPECT_EQ(Counts("a.obj", "\xef\xbb\xbf" + v + "f 1 2 3\n"), "3 1");
  EXPECT_THAT(Counts("a.obj", v + "f 1 2 x\n"), HasSubstr("a.obj:5: got \"x\"; expected a corner"));
  EXPECT_THAT(Counts("a.obj", v + "f 1 2 9\n"),
              HasSubstr("a.obj:5: there is no vertex 9: they count from 1 to 4"));
}

TEST(ReadTriMesh, MendsTheSurfaceWithNotes) {
  const TemporaryFolder folder;
  const std::string corners = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  // A tetrahedron seen from inside, with one face twice.
  const TriMeshFile read =
      ReadTriMesh(Write(folder / "a.obj", corners + "v 0 0 1\nf 2 3 4\nf 2 5 3\nf 2 4 6\n"
                                                    "f 3 5 4\nf 4 3 2\n"));
  EXPECT_TRUE(CheckSurface(read.mesh).BoundsVolume());
  EXPECT_TRUE(read.is_mended);
  EXPECT_EQ(read.vertex_in_file, Eigen::Vector4i(1, 2, 3, 4));
  EXPECT_EQ(read.vertices_in_file, 6);
  EXPECT_THAT(read.notes,
              ElementsAre(HasSubstr("merged 1 of 6"), HasSubstr("repeat an earlier one"),
                          HasSubstr("no triangle uses"), HasSubstr("inside out")));
  EXPECT_FALSE(ReadTriMesh(Write(folder / "a.stl", kStl)).is_mended);
  EXPECT_THAT(Counts("b.obj", corners + "f 2 2 3\n"),
              HasSubstr("none of its 1 faces has three different corners"));
}

std::string BinaryStl(const std::string& header, uint32_t announced, int written) {
  std::string bytes = header + std::string(80 - header.size(), ' ');
  bytes.append(reinterpret_cast<const char*>(&announced), 4);
  for (int t = 0; t < written; ++t) {
    const float numbers[12] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, static_cast<float>(t)};
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(ReadTriMesh, ReadsStlInAnyCaseAndBinaryStlThatBeginsWithSolid) {
  EXPECT_EQ(Counts("a.stl", Capitals(kStl)), "4 2");
  EXPECT_EQ(Counts("a.stl",
                   "  solid\n facet normal 0 0 1 outer loop\n vertex 0 0 0 vertex 1 0 0\n"
                   " vertex 0 1 0 endloop endfacet\nendsolid vertex 7\n"),
            "3 1");
  EXPECT_EQ(Counts("a.stl", BinaryStl("solid from a CAD program", 2, 2)), "4 2");
  EXPECT_EQ(Counts("a.stl", BinaryStl("", 2, 2) + "tail"), "4 2");
}

TEST(ReadTriMesh, SaysTruncatedOnlyOfStlThatIs) {
  EXPECT_THAT(
      Counts("a.stl", BinaryStl("", 3, 2)),
      HasSubstr("truncated, or not an STL file: it announces 3 triangles and has room for 2"));
  EXPECT_THAT(Counts("a.stl", std::string(kStl).substr(0, std::string(kStl).find("endsolid"))),
              HasSubstr("is truncated: it ends without endsolid after 2 facets"));
  EXPECT_THAT(Counts("a.stl", "hello"), HasSubstr("is not an STL file"));
  std::string comma(kStl);
  comma.replace(comma.find("0.5"), 3, "0,5");
  EXPECT_THAT(Counts("a.stl", comma), HasSubstr("a.stl:6: got \"0,5\"; expected a coordinate"));
}

TEST(ReadTriMesh, ReadsTheVariantsOfOff) {
  const std::string v = "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n", f = "3 0 1 2\n3 0 2 3\n";
  for (const std::string& head :
       {std::string("OFF 4 2 0\n"), std::string("OFF4 2 0\n"),
        std::string("# a comment\nOFF # another\n\n4 2\n"), std::string("off\n4 2 0\n"),
        std::string("4 2 0\n"), std::string("\xef\xbb\xbfOFF\r\n4 2 0\r\n"),
        std::string("OFF\n4\n2\n7\n"), std::string("OFF 4\n2\n")}) {
    EXPECT_EQ(Counts("a.off", head + v + f), "4 2") << head;
  }
  EXPECT_THAT(Counts("a.off", "OFF\n4 1 0\n" + v + f),
              HasSubstr("a.off:8: a line follows, but the number of faces is 1"));
  EXPECT_EQ(Counts("a.off",
                   "COFF\n4 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n1 1 0 9 9 9 9\n"
                   "0 1 0 0.1 0.2 0.3 1 # grey\n4 0 1 2 3 0.5 0.5 0.5\n"),
            "4 2");
  EXPECT_EQ(Counts("a.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"),
            "3 1");
  const auto binary = [](std::initializer_list<uint32_t> numbers) {
    std::string content = "OFF BINARY\n";
    for (const uint32_t number : numbers)
      for (const int shift : {24, 16, 8, 0}) content.push_back(static_cast<char>(number >> shift));
    return content;
  };
  constexpr uint32_t kOne = 0x3f800000;  // the bits of 1.0f
  EXPECT_EQ(Counts("a.off", binary({3, 1, 0, 0, 0, 0, kOne, 0, 0, 0, kOne, 0, 3, 0, 1, 2, 0})),
            "3 1");
  EXPECT_THAT(Counts("a.off", binary({3, 1, 0, 0, 0, 0, kOne, 0, 0, 0, kOne, 0, 3, 0, 1, 7, 0})),
              HasSubstr("face 1 of 1: there is no vertex 7"));
  EXPECT_THAT(Counts("a.off", binary({3, 1, 0, 0, 0, 0, kOne})), HasSubstr("is truncated"));
  EXPECT_THAT(Counts("a.off", binary({3, 1, 0, 0, 0, 0, kOne, 0, 0, 0, kOne, 0, 3, 0, 1, 2, 0, 9})),
              HasSubstr("4 bytes follow, but the number of faces is 1"));
  EXPECT_THAT(Counts("a.off", "4OFF\n1 0 0\n1 2 3 4\n"), HasSubstr("4OFF is not read"));
  EXPECT_THAT(Counts("a.off", "OFF\n4 2 0\n" + v + "3 0 1 2\n"),
              HasSubstr("the file ends where face 2 of 2 should follow"));
  EXPECT_THAT(Counts("a.off", "ply\n"), HasSubstr("an OFF file begins with OFF"));
}

}  // namespace
}  // namespace lacuna
