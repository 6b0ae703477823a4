#include "geometry/tet_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/error.h"
#include "geometry/shape_functions.h"
#include "geometry/used_indices.h"

namespace lacuna {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& file, int line, const std::string& message) {
  throw InputError({file.string(), line}, message);
}

// Removes the tetrahedra that list the same nodes as an earlier one in the same order, and returns
// their number.
size_t DropRepetitions(TetSoup* soup) {
  const size_t count = soup->tets.size();
  const auto nodes = [&](size_t e) { return std::tie(soup->sizes[e], soup->tets[e]); };
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t e, size_t other) {
    return nodes(e) != nodes(other) ? nodes(e) < nodes(other) : e < other;
  });
  std::vector<char> is_repeated(count, 0);
  for (size_t k = 1; k < count; ++k)
    if (nodes(order[k]) == nodes(order[k - 1])) is_repeated[order[k]] = 1;
  size_t kept = 0;
  for (size_t e = 0; e < count; ++e) {
    if (is_repeated[e]) continue;
    soup->tets[kept] = soup->tets[e];
    soup->sizes[kept] = soup->sizes[e];
    soup->lines[kept] = soup->lines[e];
    ++kept;
  }
  soup->tets.resize(kept);
  soup->sizes.resize(kept);
  soup->lines.resize(kept);
  return count - kept;
}

Eigen::MatrixXi UniformTets(const TetSoup& soup, const std::filesystem::path& file) {
  if (soup.tets.empty()) Fail(file, 0, "has no tetrahedra");
  const int size = soup.sizes.front();
  Eigen::MatrixXi tets(size, soup.tets.size());
  for (size_t e = 0; e < soup.tets.size(); ++e) {
    if (soup.sizes[e] != size) {
      Fail(file, soup.lines[e], "tetrahedra of 4 and of 10 nodes in one file");
    }
    for (int k = 0; k < size; ++k) {
      tets(k, e) = soup.tets[e][k];
      for (int other = 0; other < k; ++other) {
        if (tets(k, e) == tets(other, e)) {
          Fail(file, soup.lines[e], "a tetrahedron refers to one node twice");
        }
      }
    }
  }
  return tets;
}

// Refuses a quadratic tetrahedron whose midside nodes lie nearest to the midpoints of each other's
// edges: the file lists them in the order of another format.
void RefuseExchangedMidpoints(const TetSoup& soup, const std::filesystem::path& file,
                              const TetMesh& mesh) {
  if (mesh.Order() == 1) return;
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    std::array<int, kTetEdges.size()> nearest{};
    for (size_t k = 0; k < nearest.size(); ++k) {
      const auto distance = [&](int edge) {
        const auto& [i, j] = kTetEdges[static_cast<size_t>(edge)];
        const Eigen::Vector3d midpoint =
            0.5 * (mesh.nodes.col(mesh.tets(i, e)) + mesh.nodes.col(mesh.tets(j, e)));
        return (mesh.nodes.col(mesh.tets(4 + static_cast<int>(k), e)) - midpoint).squaredNorm();
      };
      nearest[k] = static_cast<int>(k);
      for (int edge = 0; edge < static_cast<int>(nearest.size()); ++edge)
        if (distance(edge) < distance(nearest[k])) nearest[k] = edge;
    }
    std::array<int, kTetEdges.size()> sorted = nearest;
    std::sort(sorted.begin(), sorted.end());
    const bool is_permutation = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
    for (size_t k = 0; is_permutation && k < nearest.size(); ++k) {
      if (nearest[k] == static_cast<int>(k)) continue;
      const auto name = [](int edge) {
        const auto& [i, j] = kTetEdges[static_cast<size_t>(edge)];
        return fmt::format("{} and {}", i + 1, j + 1);
      };
      Fail(file, soup.lines[static_cast<size_t>(e)],
           fmt::format("the midside nodes of tetrahedron {} are not in the order of this format: "
                       "the one of corners {} lies between corners {}; programs number them "
                       "differently",
                       e + 1, name(static_cast<int>(k)), name(nearest[k])));
    }
  }
}

// Reorients the tetrahedra of negative volume and returns their number; refuses flat ones, and
// those that lie so far out that a product of three distances may overflow.
Eigen::Index TurnPositive(const TetSoup& soup, const std::filesystem::path& file, TetMesh* mesh) {
  for (Eigen::Index e = 0; e < mesh->TetCount(); ++e)
    for (const int node : mesh->tets.col(e))
      if (mesh->nodes.col(node).cwiseAbs().maxCoeff() > kFarthestCoordinate)
        Fail(file, soup.lines[e],
             fmt::format("tetrahedron {} has a coordinate beyond {}", e + 1, kFarthestCoordinate));
  if (const Eigen::Index flat = FindFlatTet(*mesh); flat >= 0)
    Fail(file, soup.lines[flat], fmt::format("tetrahedron {} has no volume", flat + 1));
  const Eigen::VectorXd volumes = TetVolumes(*mesh);
  Eigen::Index turned = 0;
  for (Eigen::Index e = 0; e < mesh->TetCount(); ++e) {
    if (volumes(e) > 0) continue;
    ++turned;
    auto tet = mesh->tets.col(e);
    std::swap(tet(0), tet(1));
    if (mesh->Order() == 2) {
      std::swap(tet(5), tet(6));  // (1,2) and (0,2)
      std::swap(tet(7), tet(8));  // (0,3) and (1,3)
    }
  }
  return turned;
}

// A face with its corners in ascending order, and whether that order is counter-clockwise seen from
// outside.
struct Face {
  std::array<int, 3> corners;
  bool outward;
  Eigen::Index tet;
  bool operator<(const Face& other) const {
    return std::tie(corners, tet) < std::tie(other.corners, other.tet);
  }
};

Face MakeFace(int a, int b, int c, Eigen::Index tet) {
  Face face{{a, b, c}, ((a < b) + (b < c) + (c < a)) == 2, tet};
  std::sort(face.corners.begin(), face.corners.end());
  return face;
}

// Two tetrahedra of positive volume that share a face must lie on different sides of it.
void RefuseOverlaps(const TetSoup& soup, const std::filesystem::path& file, const TetMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.TetCount());
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    const auto t = mesh.tets.col(e);
    for (const auto& face : kTetFaces)
      faces.push_back(MakeFace(t(face[0]), t(face[1]), t(face[2]), e));
  }
  std::sort(faces.begin(), faces.end());
  for (size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].corners != faces[i - 1].corners) continue;
    const auto complain = [&](const char* what) {
      Fail(file, soup.lines[faces[i].tet],
           fmt::format("tetrahedra {} and {} {}", faces[i - 1].tet + 1, faces[i].tet + 1, what));
    };
    if (i >= 2 && faces[i - 2].corners == faces[i].corners) {
      complain("share a face with a third");
    }
    if (faces[i].outward == faces[i - 1].outward)
      complain("overlap: they lie on one side of a face");
  }
}

void DropUnusedNodes(TetMeshFile* result) {
  TetMesh& mesh = result->mesh;
  const UsedIndices nodes = FindUsedIndices(mesh.tets, mesh.NodeCount());
  const auto kept = static_cast<Eigen::Index>(nodes.used.size());
  const Eigen::Index dropped = mesh.NodeCount() - kept;
  result->node_in_file = Eigen::Map<const Eigen::VectorXi>(nodes.used.data(), kept);
  if (dropped == 0) return;
  result->notes.push_back(fmt::format("dropped {} nodes that no tetrahedron uses", dropped));
  mesh.nodes = mesh.nodes(Eigen::all, nodes.used).eval();
  mesh.tets = nodes.Renumbered(mesh.tets);
}

}  // namespace

void TetSoup::AddOther(const std::string& what, int line, long long count) {
  if (count > 0 && others == 0) {
    first_other = what;
    line_of_other = line;
  }
  others += count;
}

void TetSoup::Add(std::span<const int> tet, int line) {
  tets.emplace_back();
  std::copy(tet.begin(), tet.end(), tets.back().begin());
  sizes.push_back(static_cast<int>(tet.size()));
  lines.push_back(line);
}

TetMeshFile FinishTetMesh(TetSoup soup, const std::filesystem::path& file) {
  TetMeshFile result;
  if (soup.others > 0)
    Fail(file, soup.line_of_other,
         fmt::format(
             "has {} volume elements that are not read, the first of them {}: mesh the whole "
             "body with tetrahedra of 4 or 10 nodes, or remove elements that do not belong "
             "to it",
             soup.others, soup.first_other));
  if (const size_t repeated = DropRepetitions(&soup); repeated > 0)
    result.notes.push_back(
        fmt::format("dropped {} tetrahedra that repeat an earlier one", repeated));
  TetMesh& mesh = result.mesh;
  mesh.tets = UniformTets(soup, file);
  mesh.nodes.resize(3, soup.nodes.size());
  for (size_t n = 0; n < soup.nodes.size(); ++n) mesh.nodes.col(n) = soup.nodes[n];

  RefuseExchangedMidpoints(soup, file, mesh);
  const Eigen::Index turned = TurnPositive(soup, file, &mesh);
  if (turned > 0) {
    result.notes.push_back(fmt::format("reoriented {} of {} tetrahedra that had a negative volume",
                                       turned, mesh.TetCount()));
  }
  RefuseOverlaps(soup, file, mesh);
  DropUnusedNodes(&result);
  return result;
}

}  // namespace lacuna
