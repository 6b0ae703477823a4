#include <fmt/format.h>

#include <array>
#include <cctype>
#include <functional>
#include <map>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/gmsh_io.h"
#include "geometry/mesh_io.h"
#include "geometry/node_numbers.h"
#include "geometry/tet_soup.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

// Reads the four node numbers of a tetrahedron, counted from `first`, from the rest of the line.
void AddTet(TextScanner* scanner, long long first, TetSoup* soup) {
  std::array<int, 4> tet;
  for (int& node : tet) {
    const long long number = scanner->Integer("the number of a node");
    if (soup->nodes.empty()) {
      scanner->Fail(fmt::format("there is no node {}: none has been read", number));
    }
    if (number < first || number - first >= static_cast<long long>(soup->nodes.size())) {
      scanner->Fail(fmt::format("there is no node {}: they count from {} to {}", number, first,
                                first + static_cast<long long>(soup->nodes.size()) - 1));
    }
    node = static_cast<int>(number - first);
  }
  soup->Add(tet, scanner->Line());
}

// The same where the line must end after them: a tetrahedron of ten nodes would otherwise lose six
// in silence.
void AddWholeTet(TextScanner* scanner, TetSoup* soup) {
  AddTet(scanner, 0, soup);
  if (!scanner->AtLineEnd()) scanner->Fail("a tetrahedron has more than 4 nodes");
}

// Lines after those that were counted would otherwise be left out in silence.
void ExpectFileEnd(TextScanner* scanner, long long count, const char* what) {
  if (scanner->NextLine()) {
    scanner->Fail(fmt::format("a line follows, but the number of {} is {}", what, count));
  }
}

TetSoup ReadVertexTetLines(const std::filesystem::path& file) {
  // Vertices may follow the tetrahedra that use them, so tetrahedra are read in a second pass.
  TetSoup soup;
  for (const bool reads_tets : {false, true}) {
    TextScanner scanner(file, '#');
    while (scanner.NextLine()) {
      const std::string_view kind = scanner.Word("v or t");
      if (kind != "v" && kind != "t") {
        scanner.Fail(fmt::format("got \"{}\"; expected v or t", kind));
      }
      if (kind == "v" && !reads_tets) soup.nodes.push_back(scanner.Point("a coordinate"));
      if (kind == "t" && reads_tets) AddWholeTet(&scanner, &soup);
    }
  }
  return soup;
}

TetSoup ReadCountedLists(const std::filesystem::path& file) {
  TextScanner scanner(file);
  TetSoup soup;
  scanner.ExpectLine("the numbers of nodes and tetrahedra");
  const long long nodes = scanner.Count("the number of nodes");
  const long long tets = scanner.Count("the number of tetrahedra");
  for (long long n = 0; n < nodes; ++n) {
    scanner.ExpectLine(fmt::format("node {} of {}", n + 1, nodes));
    soup.nodes.push_back(scanner.Point("a coordinate"));
  }
  for (long long e = 0; e < tets; ++e) {
    scanner.ExpectLine(fmt::format("tetrahedron {} of {}", e + 1, tets));
    AddWholeTet(&scanner, &soup);
  }
  ExpectFileEnd(&scanner, tets, "tetrahedra");
  return soup;
}

TetSoup ReadTetGen(std::filesystem::path file) {
  TetSoup soup;
  NodeNumbers numbers;
  TextScanner node_scanner(file.replace_extension(".node"), '#');
  node_scanner.ExpectLine("the number of nodes");
  const long long nodes = node_scanner.Count("the number of nodes");
  if (node_scanner.Integer("the dimension") != 3) node_scanner.Fail("expected dimension 3");
  for (long long n = 0; n < nodes; ++n) {
    node_scanner.ExpectLine(fmt::format("node {} of {}", n + 1, nodes));
    numbers.Add(node_scanner.Integer("the number of the node"), node_scanner);
    soup.nodes.push_back(node_scanner.Point("a coordinate"));
  }
  ExpectFileEnd(&node_scanner, nodes, "nodes");
  TextScanner scanner(file.replace_extension(".ele"), '#');
  scanner.ExpectLine("the number of tetrahedra");
  const long long tets = scanner.Count("the number of tetrahedra");
  const long long corners = scanner.Integer("the nodes per tetrahedron");
  if (corners != 4) {
    scanner.Fail(fmt::format("tetrahedra of {} nodes are not read, only of 4", corners));
  }
  for (long long e = 0; e < tets; ++e) {
    scanner.ExpectLine(fmt::format("tetrahedron {} of {}", e + 1, tets));
    scanner.Integer("the number of the tetrahedron");
    std::array<int, 4> tet;
    for (int& node : tet) {
      node = numbers.Place(scanner.Integer("the number of a node"), scanner);
    }
    soup.Add(tet, scanner.Line());
  }
  ExpectFileEnd(&scanner, tets, "tetrahedra");
  return soup;
}

// Sections of volume elements that are not read, those of higher order such as TetrahedraP2
// included.
bool IsOtherVolume(const std::string& keyword) {
  for (const char* kind : {"Hexahedra", "Prisms", "Pyramids", "TetrahedraP"})
    if (keyword.starts_with(kind)) return true;
  return false;
}

TetSoup ReadMedit(const std::filesystem::path& file) {
  TextScanner scanner(file, '#');
  TetSoup soup;
  while (scanner.NextLine()) {
    const std::string keyword(scanner.Word("a keyword"));
    const auto count = [&] {
      if (scanner.AtLineEnd()) scanner.ExpectLine("a number after " + keyword);
      return scanner.Count("a number of lines");
    };
    // Numbers after the lines that were counted would otherwise be taken for a section.
    if (std::isalpha(static_cast<unsigned char>(keyword[0])) == 0) {
      scanner.Fail(fmt::format("got \"{}\"; expected a keyword such as Vertices", keyword));
    }
    if (keyword == "End") return soup;
    if (keyword == "MeshVersionFormatted") {
      count();
    } else if (keyword == "Dimension") {
      if (count() != 3) scanner.Fail("expected dimension 3");
    } else if (keyword == "Vertices") {
      const long long nodes = count();
      for (long long n = 0; n < nodes; ++n) {
        scanner.ExpectLine(fmt::format("vertex {} of {}", n + 1, nodes));
        soup.nodes.push_back(scanner.Point("a coordinate"));
      }
    } else if (keyword == "Tetrahedra") {
      const long long tets = count();
      for (long long e = 0; e < tets; ++e) {
        scanner.ExpectLine(fmt::format("tetrahedron {} of {}", e + 1, tets));
        AddTet(&scanner, 1, &soup);
      }
    } else {
      const long long lines = count();
      if (IsOtherVolume(keyword)) soup.AddOther("in the section " + keyword, scanner.Line(), lines);
      for (long long line = 0; line < lines; ++line) scanner.ExpectLine("a line of " + keyword);
    }
  }
  scanner.Fail("the file ends without End");
}

using Reader = std::function<TetSoup(const std::filesystem::path&)>;

const std::map<std::string, Reader>& Readers() {
  static const std::map<std::string, Reader> readers{
      {".msh", ReadGmsh},    {".tet", ReadVertexTetLines}, {".txt", ReadCountedLists},
      {".node", ReadTetGen}, {".ele", ReadTetGen},         {".mesh", ReadMedit}};
  return readers;
}

}  // namespace

TetMeshFile ReadTetMesh(const std::filesystem::path& file) {
  const auto reader = Readers().find(LowerExtension(file));
  if (reader == Readers().end()) {
    throw InputError({file.string()},
                     fmt::format("\"{}\" is not a format of tetrahedral meshes; expected .msh, "
                                 ".tet, .txt, .node, .ele or .mesh",
                                 file.extension().string()));
  }
  return FinishTetMesh(reader->second(file), file);
}

std::vector<std::filesystem::path> FilesOfTetMesh(const std::filesystem::path& file) {
  const std::string extension = LowerExtension(file);
  if (extension != ".node" && extension != ".ele") return {file};
  std::filesystem::path nodes = file, elements = file;
  return {nodes.replace_extension(".node"), elements.replace_extension(".ele")};
}

void WriteTetMesh(const std::filesystem::path& msh, const TetMesh& mesh) {
  WriteFileAtomically(msh, GmshText(mesh, GmshVersion::k22));
}

}  // namespace lacuna
