#include "experiment/reference_body.h"

#include <fmt/format.h>

#include <fstream>
#include <utility>

#include "core/atomic_file.h"
#include "geometry/mesh_io.h"
#include "geometry/sheet.h"
#include "meshing/tetrahedralize.h"

namespace lacuna {
namespace {

SheetPosition PositionOf(SheetFace face) {
  // The scanned side is the one that its normals point to.
  return face == SheetFace::kFront ? SheetPosition::kTop : SheetPosition::kMiddle;
}

TriMesh ReferenceSurface(const ReferenceRequest& request, std::vector<std::string>* notes) {
  const ReferenceShape& reference = request.recording.reference;
  if (reference.source == ReferenceSource::kMesh) {
    TriMeshFile given = ReadTriMesh(reference.file);
    notes->insert(notes->end(), given.notes.begin(), given.notes.end());
    given.mesh.vertices = reference.world_from_file * given.mesh.vertices;
    return given.mesh;
  }
  if (HasTrackedPoints(request.recording)) {
    const Frame frame = LoadFrame(request.recording, request.first_frame);
    const bool has_triangles = frame.triangles.cols() > 0;
    if (has_triangles && frame.dropped_count > 0) {
      throw InputError(fmt::format("{}: frame {}: the reference frame lacks {} of its {} points",
                                   request.recording.file.string(), request.first_frame,
                                   frame.dropped_count, frame.row_count));
    }
    if (has_triangles) return {frame.cloud.points, frame.triangles};
  }
  return request.first_surface != nullptr ? *request.first_surface : TriMesh{};
}

MeshRecord Describe(const TetMesh& mesh) {
  const TetQuality quality = MeasureTets(mesh);
  return {.node_count = mesh.NodeCount(),
          .tet_count = mesh.TetCount(),
          .order = mesh.Order(),
          .volume = quality.total_volume,
          .smallest_angle = quality.min_dihedral_angle,
          .largest_radius_edge_ratio = quality.radius_edge_ratio.max};
}

// Throws InputError for a mesh of more tetrahedra than are allowed on any machine, with the name of
// the key. A mesh that does not fit into this machine's memory is no fault of the input.
void RefuseTooManyTets(const ReferenceRequest& request, const TriMesh& surface) {
  constexpr double kMost = 2e7;
  if (request.mesh.tets.max_volume == 0) return;
  const double tets = EnclosedVolume(surface) / request.mesh.tets.max_volume;
  if (tets <= kMost) return;
  throw InputError(fmt::format(
      "{}: mesh.max_volume: {:g} m³ would divide a body of {:.3g} m³ into {:.2g} tetrahedra, more "
      "than {:g}",
      request.name, request.mesh.tets.max_volume, EnclosedVolume(surface), tets, kMost));
}

}  // namespace

ReferenceBody MakeReferenceBody(const ReferenceRequest& request) {
  const ReferenceShape& reference = request.recording.reference;
  ReferenceBody body;
  if (reference.source == ReferenceSource::kTetMesh) {
    TetMeshFile given = ReadTetMesh(reference.file);
    given.mesh.nodes = reference.world_from_file * given.mesh.nodes;
    body.mesh = given.mesh;
    body.notes = given.notes;
  } else {
    const TriMesh surface = ReferenceSurface(request, &body.notes);
    if (surface.triangles.cols() == 0) {
      throw InputError(
          fmt::format("{}: the reference shape has no surface; give a mesh under "
                      "`reference`, or frames that surround the object",
                      request.recording.file.string()));
    }
    if (reference.sheet_thickness > 0) {
      body.mesh = ThickenToTets(surface, reference.sheet_thickness, request.sheet_layers,
                                PositionOf(reference.sheet_face));
    } else {
      RefuseTooManyTets(request, surface);
      const MeshResult meshed = MeshTetrahedra(surface, request.mesh.tets);
      if (!meshed.IsUsable()) {
        throw InputError(fmt::format("{}: the reference shape cannot be meshed: {}",
                                     request.recording.file.string(), meshed.message));
      }
      body.mesh = meshed.mesh;
      body.notes.insert(body.notes.end(), meshed.notes.begin(), meshed.notes.end());
    }
  }
  if (const Eigen::Index flat = FindFlatTet(body.mesh); flat >= 0) {
    const Eigen::Vector3d place = body.mesh.nodes.col(body.mesh.tets(0, flat));
    throw InputError(
        fmt::format("{}: the reference shape cannot be meshed: tetrahedron {} of {}, at ({:.4g}, "
                    "{:.4g}, {:.4g}) "
                    "m, has no volume; the surface nearly touches itself there",
                    request.recording.file.string(), flat + 1, body.mesh.TetCount(), place.x(),
                    place.y(), place.z()));
  }
  if (request.mesh.order == 2 && body.mesh.Order() == 1) body.mesh = ToQuadratic(body.mesh);
  body.quality = Describe(body.mesh);
  return body;
}

void WriteReferenceBody(const ReferenceBody& body, const std::filesystem::path& folder) {
  WriteTetMesh(folder / "body.msh", body.mesh);
  std::string notes;
  for (const std::string& note : body.notes) notes += note + "\n";
  WriteFileAtomically(folder / "notes.txt", notes);
}

ReferenceBody ReadReferenceBody(const std::filesystem::path& folder) {
  ReferenceBody body;
  body.mesh = ReadTetMesh(folder / "body.msh").mesh;
  body.quality = Describe(body.mesh);
  std::ifstream notes(folder / "notes.txt");
  for (std::string note; std::getline(notes, note);) body.notes.push_back(note);
  return body;
}

}  // namespace lacuna
