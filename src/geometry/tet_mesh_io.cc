#include <fmt/format.h>

#include <array>
#include <functional>
#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/tet_soup.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

constexpr int kGmshTet = 4;
constexpr int kGmshQuadraticTet = 11;

// Maps the node numbers of the file to indices in the list of nodes.
class NodeNumbers {
 public:
  void Add(long long number, const TextScanner& scanner) {
    const int place = static_cast<int>(place_.size());
    if (!place_.emplace(number, place).second) {
      scanner.Fail(fmt::format("node {} appears a second time", number));
    }
  }
  int Place(long long number, const TextScanner& scanner) const {
    const auto found = place_.find(number);
    if (found == place_.end()) scanner.Fail(fmt::format("there is no node {}", number));
    return found->second;
  }

 private:
  std::unordered_map<long long, int> place_;
};

long long Count(TextScanner& scanner, const char* what) {
  const long long count = scanner.Integer(what);
  if (count < 0) scanner.Fail(fmt::format("got {}; expected {}", count, what));
  return count;
}

// Reads the four node numbers of a tetrahedron, counted from `first`, from the rest of the line.
void AddTet(TextScanner& scanner, long long first, TetSoup& soup) {
  std::array<int, 4> tet;
  for (int& node : tet) {
    const long long number = scanner.Integer("the number of a node");
    if (number < first || number - first >= static_cast<long long>(soup.nodes.size())) {
      scanner.Fail(fmt::format("there is no node {}: they count from {} to {}", number, first,
                               first + static_cast<long long>(soup.nodes.size()) - 1));
    }
    node = static_cast<int>(number - first);
  }
  soup.Add(tet, scanner.Line());
}

void SkipGmshSection(const std::string& name, TextScanner& scanner) {
  do {
    scanner.ExpectLine("$End" + name);
  } while (scanner.Word("a word") != "$End" + name);
}

void ExpectGmshEnd(const std::string& name, TextScanner& scanner) {
  scanner.ExpectLine("$End" + name);
  if (scanner.Word("the end of the section") != "$End" + name) {
    scanner.Fail("expected $End" + name);
  }
}

void ReadGmshFormat(TextScanner& scanner) {
  scanner.ExpectLine("the version");
  const double version = scanner.Number("the version");
  if (version < 2 || version >= 3) {
    scanner.Fail(
        fmt::format("Gmsh version {} is not read; save as version 2 (-format msh2)", version));
  }
  if (scanner.Integer("0 for text") != 0) {
    scanner.Fail("binary Gmsh files are not read; save as text");
  }
  ExpectGmshEnd("MeshFormat", scanner);
}

void ReadGmshNodes(TextScanner& scanner, NodeNumbers& numbers, TetSoup& soup) {
  scanner.ExpectLine("the number of nodes");
  const long long count = Count(scanner, "the number of nodes");
  for (long long n = 0; n < count; ++n) {
    scanner.ExpectLine(fmt::format("node {} of {}", n + 1, count));
    numbers.Add(scanner.Integer("the number of the node"), scanner);
    soup.nodes.push_back(scanner.Point("a coordinate"));
  }
  ExpectGmshEnd("Nodes", scanner);
}

void ReadGmshElements(TextScanner& scanner, const NodeNumbers& numbers, TetSoup& soup) {
  scanner.ExpectLine("the number of elements");
  const long long count = Count(scanner, "the number of elements");
  for (long long e = 0; e < count; ++e) {
    scanner.ExpectLine(fmt::format("element {} of {}", e + 1, count));
    scanner.Integer("the number of the element");
    const long long type = scanner.Integer("the type of the element");
    if (type != kGmshTet && type != kGmshQuadraticTet) continue;
    const long long tags = Count(scanner, "the number of tags");
    for (long long tag = 0; tag < tags; ++tag) scanner.Integer("a tag");
    std::array<int, 10> nodes{};
    const int node_count = type == kGmshTet ? 4 : 10;
    for (int k = 0; k < node_count; ++k) {
      nodes[k] = numbers.Place(scanner.Integer("the number of a node"), scanner);
    }
    // Gmsh lists the midpoint of (2,3) before that of (1,3).
    std::swap(nodes[8], nodes[9]);
    soup.Add({nodes.data(), static_cast<size_t>(node_count)}, scanner.Line());
  }
  ExpectGmshEnd("Elements", scanner);
}

TetSoup ReadGmsh(const std::filesystem::path& file) {
  TextScanner scanner(file);
  NodeNumbers numbers;
  TetSoup soup;
  bool has_elements = false;
  scanner.ExpectLine("$MeshFormat");
  if (scanner.Word("a section") != "$MeshFormat") scanner.Fail("expected $MeshFormat");
  ReadGmshFormat(scanner);
  while (scanner.NextLine()) {
    const std::string section(scanner.Word("a section"));
    if (section == "$Nodes") {
      ReadGmshNodes(scanner, numbers, soup);
    } else if (section == "$Elements") {
      ReadGmshElements(scanner, numbers, soup);
      has_elements = true;
    } else if (section.starts_with('$')) {
      SkipGmshSection(section.substr(1), scanner);
    } else {
      scanner.Fail(fmt::format("got \"{}\"; expected a section such as $Nodes", section));
    }
  }
  if (!has_elements) scanner.Fail("the file ends without $Elements");
  return soup;
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
      if (kind == "t" && reads_tets) AddTet(scanner, 0, soup);
    }
  }
  return soup;
}

TetSoup ReadCountedLists(const std::filesystem::path& file) {
  TextScanner scanner(file);
  TetSoup soup;
  scanner.ExpectLine("the numbers of nodes and tetrahedra");
  const long long nodes = Count(scanner, "the number of nodes");
  const long long tets = Count(scanner, "the number of tetrahedra");
  for (long long n = 0; n < nodes; ++n) {
    scanner.ExpectLine(fmt::format("node {} of {}", n + 1, nodes));
    soup.nodes.push_back(scanner.Point("a coordinate"));
  }
  for (long long e = 0; e < tets; ++e) {
    scanner.ExpectLine(fmt::format("tetrahedron {} of {}", e + 1, tets));
    AddTet(scanner, 0, soup);
  }
  return soup;
}

TetSoup ReadTetGen(std::filesystem::path file) {
  TetSoup soup;
  NodeNumbers numbers;
  TextScanner node_scanner(file.replace_extension(".node"), '#');
  node_scanner.ExpectLine("the number of nodes");
  const long long nodes = Count(node_scanner, "the number of nodes");
  if (node_scanner.Integer("the dimension") != 3) node_scanner.Fail("expected dimension 3");
  for (long long n = 0; n < nodes; ++n) {
    node_scanner.ExpectLine(fmt::format("node {} of {}", n + 1, nodes));
    numbers.Add(node_scanner.Integer("the number of the node"), node_scanner);
    soup.nodes.push_back(node_scanner.Point("a coordinate"));
  }
  TextScanner scanner(file.replace_extension(".ele"), '#');
  scanner.ExpectLine("the number of tetrahedra");
  const long long tets = Count(scanner, "the number of tetrahedra");
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
  return soup;
}

TetSoup ReadMedit(const std::filesystem::path& file) {
  TextScanner scanner(file, '#');
  TetSoup soup;
  while (scanner.NextLine()) {
    const std::string keyword(scanner.Word("a keyword"));
    const auto count = [&] {
      if (scanner.AtLineEnd()) scanner.ExpectLine("a number after " + keyword);
      return Count(scanner, "a number of lines");
    };
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
        AddTet(scanner, 1, soup);
      }
    } else {
      const long long lines = count();
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

void WriteTetMesh(const std::filesystem::path& msh, const TetMesh& mesh) {
  std::string content = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  auto end = std::back_inserter(content);
  fmt::format_to(end, "$Nodes\n{}\n", mesh.NodeCount());
  for (Eigen::Index n = 0; n < mesh.NodeCount(); ++n) {
    const auto node = mesh.nodes.col(n);
    fmt::format_to(end, "{} {} {} {}\n", n + 1, node.x(), node.y(), node.z());
  }
  fmt::format_to(end, "$EndNodes\n$Elements\n{}\n", mesh.TetCount());
  const int type = mesh.Order() == 2 ? kGmshQuadraticTet : kGmshTet;
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    Eigen::VectorXi nodes = mesh.tets.col(e);
    if (mesh.Order() == 2) std::swap(nodes(8), nodes(9));
    fmt::format_to(end, "{} {} 2 0 1", e + 1, type);
    for (const int node : nodes) fmt::format_to(end, " {}", node + 1);
    content += '\n';
  }
  content += "$EndElements\n";
  WriteFileAtomically(msh, content);
}

}  // namespace lacuna
