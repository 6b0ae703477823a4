#include "scan/mesh_frames.h"

#include <glog/logging.h>

#include "geometry/mesh_io.h"
#include "geometry/tri_mesh.h"
#include "scan/frame_list.h"
#include "scan/frame_points.h"

namespace lacuna {

void ReadSource(const Config& frames, const DataLocation& data, MeshFrames* source,
                std::vector<std::string>*) {
  source->world_from_file = ReadWorldFromFile(frames, LengthOf(data.length_unit));
  source->files = OneFilePerFrame(ReadFrameFiles(frames, data.folder));
  ReadObjectChoice(frames, data, source);
  source->tracked = frames.Flag("tracked", false);
}

void LoadPoints(const MeshFrames& source, Frame* frame) {
  const std::filesystem::path& path = source.files[frame->index][0];
  const TriMeshFile file = ReadTriMesh(path);
  for (const std::string& note : file.notes) {
    LOG(INFO) << path.string() << ": " << note;
    if (file.is_mended) frame->notes.push_back(path.string() + ": " + note);
  }
  Eigen::Matrix3Xd vertices = source.world_from_file * file.mesh.vertices;
  ForgetOtherObjects(source, file.mesh.triangles, &vertices, frame);
  KeepUsablePoints({vertices, Eigen::Matrix3Xd(3, 0)}, file.mesh.triangles, frame);
  if (source.tracked) {
    // A vertex that was merged or dropped is a row that the frame does not have.
    frame->row_count = file.vertices_in_file;
    frame->source_row = file.vertex_in_file(frame->source_row).eval();
  }
  if (frame->triangles.cols() > 0) {
    frame->cloud.normals = UnitNormals(VertexNormals({frame->cloud.points, frame->triangles}),
                                       Eigen::Matrix3d::Identity());
  }
  RequirePoints(*frame, kFewestScannedPoints, "is finite");
}

}  // namespace lacuna
