#include "experiment/listed_regions.h"

#include <fmt/format.h>

#include <string>
#include <variant>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

// The nodes that have numbers, or why there are none.
struct NumberedNodes {
  int count = 0;
  bool is_sheet = false;
  std::string problem = {};
};

NumberedNodes NodesOfTetMesh(const ReferenceShape& reference) {
  const TetMeshFile given = ReadTetMesh(reference.file);
  for (Eigen::Index i = 0; i < given.node_in_file.size(); ++i)
    if (given.node_in_file[i] != i)
      return {.problem =
                  "nodes that no tetrahedron uses are left out, which would shift the "
                  "numbers; remove them from the file"};
  return {.count = static_cast<int>(given.mesh.NodeCount())};
}

NumberedNodes NodesOfSurface(int count, const ReferenceShape& reference,
                             const MeshSettings& settings) {
  if (reference.sheet_thickness > 0) return {.count = count, .is_sheet = true};
  if (!settings.tets.preserve_surface)
    return {.problem =
                "they are vertices of the given surface, between which `mesh: {preserve_surface: "
                "false}` adds others that the list cannot name; set `preserve_surface: true`"};
  return {.count = count};
}

// Why the vertices of a surface do not have the numbers of the file.
constexpr const char* kShifted =
    "repeated vertices and those that no triangle uses are left out, which would shift the "
    "numbers; "
    "remove them from the file";

NumberedNodes NodesOfMesh(const ReferenceShape& reference, const MeshSettings& settings) {
  if (LowerExtension(reference.file) == ".stl")
    return {.problem = "an STL file does not number its vertices; convert it, for instance to OBJ"};
  const TriMeshFile given = ReadTriMesh(reference.file);
  if (given.vertex_in_file.size() != given.vertices_in_file) return {.problem = kShifted};
  return NodesOfSurface(static_cast<int>(given.vertices_in_file), reference, settings);
}

NumberedNodes NodesOfFirstFrame(const Recording& recording, const MeshSettings& settings) {
  const Frame first = HasTrackedPoints(recording) ? LoadFrame(recording, 0) : Frame{};
  if (first.triangles.cols() == 0)
    return {.problem =
                "the reference shape is a surface that is reconstructed from the first frame, "
                "whose nodes have no numbers"};
  if (first.cloud.Size() + first.dropped_count != first.row_count) return {.problem = kShifted};
  return NodesOfSurface(static_cast<int>(first.row_count), recording.reference, settings);
}

NumberedNodes NodesOfReference(const Recording& recording, const MeshSettings& settings) {
  const ReferenceShape& reference = recording.reference;
  switch (reference.source) {
    case ReferenceSource::kTetMesh:
      return NodesOfTetMesh(reference);
    case ReferenceSource::kMesh:
      return NodesOfMesh(reference, settings);
    case ReferenceSource::kFirstFrame:
      break;
  }
  return NodesOfFirstFrame(recording, settings);
}

}  // namespace

void NumberListedNodes(const Recording& recording, const MeshSettings& settings,
                       const std::vector<Region*>& regions) {
  NumberedNodes numbered;
  bool is_known = false;
  for (Region* region : regions) {
    auto* listed = std::get_if<NodeRegion>(&region->shape);
    if (listed == nullptr) continue;
    if (!is_known) numbered = NodesOfReference(recording, settings);
    is_known = true;
    const std::filesystem::path& file = recording.reference.file;
    const std::string where = (file.empty() ? recording.file : file).string();
    if (!numbered.problem.empty())
      throw InputError(
          {where}, fmt::format("region \"{}\" lists nodes by their numbers, but {}; or describe "
                               "the region by a box, sphere or half_space",
                               region->name, numbered.problem));
    if (!listed->nodes.empty() && listed->nodes.back() >= numbered.count)
      throw InputError(
          {where}, fmt::format("region \"{}\" lists node {}; there are {} nodes, counted from 0",
                               region->name, listed->nodes.back(), numbered.count));
    listed->file_nodes = numbered.count;
    listed->is_sheet = numbered.is_sheet;
  }
}

void ListNodesOfMesh(const TetMesh& mesh, const std::vector<Region*>& regions) {
  for (Region* region : regions)
    if (std::holds_alternative<NodeRegion>(region->shape))
      region->shape = NodeRegion{SelectNodes(*region, mesh)};
}

}  // namespace lacuna
