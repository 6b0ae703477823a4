#include "geometry/gmsh_io.h"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include "geometry/node_numbers.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

constexpr int kTet = 4;
constexpr int kQuadraticTet = 11;

// Elements of at most two dimensions, from Gmsh's header GmshDefines.h: points, lines, triangles,
// quadrangles and polygons of all orders.
bool IsFlat(long long type) {
  return (type >= 1 && type <= 3) || (type >= 8 && type <= 10) || type == 15 || type == 16 ||
         (type >= 20 && type <= 28) || type == 34 || (type >= 36 && type <= 70) ||
         (type >= 84 && type <= 86) || (type >= 133 && type <= 135) || type == 138;
}

std::string NameOf(long long type) {
  const char* kind = type == 5 || type == 12 || type == 17   ? "hexahedron"
                     : type == 6 || type == 13 || type == 18 ? "prism"
                     : type == 7 || type == 14 || type == 19 ? "pyramid"
                     : type >= 29 && type <= 33              ? "tetrahedron of another order"
                                                             : "volume element";
  return fmt::format("a {} (type {} of Gmsh)", kind, type);
}

void SkipSection(const std::string& name, TextScanner* scanner) {
  do {
    scanner->ExpectLine("$End" + name);
  } while (scanner->Word("a word") != "$End" + name);
}

void ExpectEnd(const std::string& name, TextScanner* scanner) {
  scanner->ExpectLine("$End" + name);
  if (scanner->Word("the end of the section") != "$End" + name)
    scanner->Fail("expected $End" + name);
}

GmshVersion ReadFormat(TextScanner* scanner) {
  scanner->ExpectLine("the version");
  const double version = scanner->Number("the version");
  const bool is_4 = version == 4.1;
  if (!is_4 && (version < 2 || version >= 3)) {
    scanner->Fail(fmt::format(
        "Gmsh version {} is not read; save as version 4.1 or 2.2 (-format msh2)", version));
  }
  if (scanner->Integer("0 for text") != 0) {
    scanner->Fail("binary Gmsh files are not read; save as text");
  }
  ExpectEnd("MeshFormat", scanner);
  return is_4 ? GmshVersion::k41 : GmshVersion::k22;
}

void ReadNodes22(TextScanner* scanner, NodeNumbers* numbers, TetSoup* soup) {
  scanner->ExpectLine("the number of nodes");
  const long long count = scanner->Count("the number of nodes");
  for (long long n = 0; n < count; ++n) {
    scanner->ExpectLine(fmt::format("node {} of {}", n + 1, count));
    numbers->Add(scanner->Integer("the number of the node"), *scanner);
    soup->nodes.push_back(scanner->Point("a coordinate"));
  }
}

// Blocks of "dimension tag parametric count", then the numbers of all nodes of the block, then
// their coordinates, which in parametric blocks are followed by parameters.
void ReadNodes41(TextScanner* scanner, NodeNumbers* numbers, TetSoup* soup) {
  scanner->ExpectLine("the numbers of blocks and nodes");
  const long long blocks = scanner->Count("the number of blocks");
  for (long long b = 0; b < blocks; ++b) {
    scanner->ExpectLine(fmt::format("block {} of {} of the nodes", b + 1, blocks));
    for (const char* what : {"a dimension", "a tag", "0 or 1"}) scanner->Integer(what);
    const long long count = scanner->Count("the number of nodes in the block");
    for (long long n = 0; n < count; ++n) {
      scanner->ExpectLine(fmt::format("the number of node {} of {} in the block", n + 1, count));
      numbers->Add(scanner->Integer("the number of the node"), *scanner);
    }
    for (long long n = 0; n < count; ++n) {
      scanner->ExpectLine(fmt::format("node {} of {} in the block", n + 1, count));
      soup->nodes.push_back(scanner->Point("a coordinate"));
    }
  }
}

void AddTet(long long type, const NodeNumbers& numbers, TextScanner* scanner, TetSoup* soup) {
  std::array<int, 10> nodes{};
  const int node_count = type == kTet ? 4 : 10;
  for (int k = 0; k < node_count; ++k)
    nodes[k] = numbers.Place(scanner->Integer("the number of a node"), *scanner);
  // Gmsh lists the midpoint of (2,3) before that of (1,3).
  std::swap(nodes[8], nodes[9]);
  soup->Add({nodes.data(), static_cast<size_t>(node_count)}, scanner->Line());
}

void ReadElements22(TextScanner* scanner, const NodeNumbers& numbers, TetSoup* soup) {
  scanner->ExpectLine("the number of elements");
  const long long count = scanner->Count("the number of elements");
  for (long long e = 0; e < count; ++e) {
    scanner->ExpectLine(fmt::format("element {} of {}", e + 1, count));
    scanner->Integer("the number of the element");
    const long long type = scanner->Integer("the type of the element");
    if (type != kTet && type != kQuadraticTet) {
      if (!IsFlat(type)) soup->AddOther(NameOf(type), scanner->Line());
      continue;
    }
    const long long tags = scanner->Count("the number of tags");
    for (long long tag = 0; tag < tags; ++tag) scanner->Integer("a tag");
    AddTet(type, numbers, scanner, soup);
  }
}

// Blocks of "dimension tag type count", then "number node …" for each element.
void ReadElements41(TextScanner* scanner, const NodeNumbers& numbers, TetSoup* soup) {
  scanner->ExpectLine("the numbers of blocks and elements");
  const long long blocks = scanner->Count("the number of blocks");
  for (long long b = 0; b < blocks; ++b) {
    scanner->ExpectLine(fmt::format("block {} of {} of the elements", b + 1, blocks));
    for (const char* what : {"a dimension", "a tag"}) scanner->Integer(what);
    const long long type = scanner->Integer("the type of the elements");
    const long long count = scanner->Count("the number of elements in the block");
    for (long long e = 0; e < count; ++e) {
      scanner->ExpectLine(fmt::format("element {} of {} in the block", e + 1, count));
      if (type != kTet && type != kQuadraticTet) {
        if (!IsFlat(type)) soup->AddOther(NameOf(type), scanner->Line());
        continue;
      }
      scanner->Integer("the number of the element");
      AddTet(type, numbers, scanner, soup);
    }
  }
}

Eigen::VectorXi NodesOf(const TetMesh& mesh, Eigen::Index element) {
  Eigen::VectorXi nodes = mesh.tets.col(element).array() + 1;
  if (mesh.Order() == 2) std::swap(nodes(8), nodes(9));
  return nodes;
}

std::string Text22(const TetMesh& mesh) {
  std::string content = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const auto end = std::back_inserter(content);
  fmt::format_to(end, "$Nodes\n{}\n", mesh.NodeCount());
  for (Eigen::Index n = 0; n < mesh.NodeCount(); ++n) {
    const auto node = mesh.nodes.col(n);
    fmt::format_to(end, "{} {} {} {}\n", n + 1, node.x(), node.y(), node.z());
  }
  fmt::format_to(end, "$EndNodes\n$Elements\n{}\n", mesh.TetCount());
  const int type = mesh.Order() == 2 ? kQuadraticTet : kTet;
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    fmt::format_to(end, "{} {} 2 0 1", e + 1, type);
    for (const int node : NodesOf(mesh, e)) fmt::format_to(end, " {}", node);
    content += '\n';
  }
  return content + "$EndElements\n";
}

std::string Text41(const TetMesh& mesh) {
  std::string content =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n";
  const auto end = std::back_inserter(content);
  const Eigen::Vector3d low = mesh.nodes.rowwise().minCoeff();
  const Eigen::Vector3d high = mesh.nodes.rowwise().maxCoeff();
  // No points, curves and surfaces, and one volume with one physical tag.
  fmt::format_to(end, "$Entities\n0 0 0 1\n1 {} {} {} {} {} {} 1 1 0\n$EndEntities\n", low.x(),
                 low.y(), low.z(), high.x(), high.y(), high.z());
  const Eigen::Index count = mesh.NodeCount();
  fmt::format_to(end, "$Nodes\n1 {0} 1 {0}\n3 1 0 {0}\n", count);
  for (Eigen::Index n = 0; n < count; ++n) fmt::format_to(end, "{}\n", n + 1);
  for (const auto node : mesh.nodes.colwise())
    fmt::format_to(end, "{} {} {}\n", node.x(), node.y(), node.z());
  fmt::format_to(end, "$EndNodes\n$Elements\n1 {0} 1 {0}\n3 1 {1} {0}\n", mesh.TetCount(),
                 mesh.Order() == 2 ? kQuadraticTet : kTet);
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    fmt::format_to(end, "{}", e + 1);
    for (const int node : NodesOf(mesh, e)) fmt::format_to(end, " {}", node);
    content += '\n';
  }
  return content + "$EndElements\n";
}

}  // namespace

TetSoup ReadGmsh(const std::filesystem::path& file) {
  TextScanner scanner(file);
  NodeNumbers numbers;
  TetSoup soup;
  bool has_elements = false;
  scanner.ExpectLine("$MeshFormat");
  if (scanner.Word("a section") != "$MeshFormat") scanner.Fail("expected $MeshFormat");
  const bool is_4 = ReadFormat(&scanner) == GmshVersion::k41;
  while (scanner.NextLine()) {
    const std::string section(scanner.Word("a section"));
    if (section == "$Nodes") {
      (is_4 ? ReadNodes41 : ReadNodes22)(&scanner, &numbers, &soup);
      ExpectEnd("Nodes", &scanner);
    } else if (section == "$Elements") {
      (is_4 ? ReadElements41 : ReadElements22)(&scanner, numbers, &soup);
      ExpectEnd("Elements", &scanner);
      has_elements = true;
    } else if (section.starts_with('$')) {
      SkipSection(section.substr(1), &scanner);
    } else {
      scanner.Fail(fmt::format("got \"{}\"; expected a section such as $Nodes", section));
    }
  }
  if (!has_elements) scanner.Fail("the file ends without $Elements");
  return soup;
}

std::string GmshText(const TetMesh& mesh, GmshVersion version) {
  return version == GmshVersion::k22 ? Text22(mesh) : Text41(mesh);
}

}  // namespace lacuna
