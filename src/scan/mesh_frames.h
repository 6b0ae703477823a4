// Frames of kind `mesh`: a triangle mesh per frame, from PLY, OBJ, STL or OFF.
//
// Everything that depends on this kind is here: its data and its reader. `lacuna info` has nothing
// to add for it, and nothing in Lacuna writes a recording of this kind. frame_source.h lists what
// each function has to do.
#ifndef LACUNA_SCAN_MESH_FRAMES_H_
#define LACUNA_SCAN_MESH_FRAMES_H_

#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/file_frames.h"
#include "scan/similarity.h"

namespace lacuna {

struct MeshFrames : FileFrames {
  static constexpr const char* kKind = "mesh";
  static constexpr const char* kTitle = "triangle meshes";

  Similarity world_from_file;  // its length unit included
  bool tracked = false;        // vertex i is the same material point in every frame
};

void ReadSource(const Config& frames, const DataLocation& data, MeshFrames* source,
                std::vector<std::string>* warnings);
// The points of the frame are the vertices of the mended surface (geometry/mended_surface.h), with
// normals from the triangles around them. In tracked frames `source_row` is the vertex in the file.
void LoadPoints(const MeshFrames& source, Frame* frame);
inline bool IsTracked(const MeshFrames& source) { return source.tracked; }

}  // namespace lacuna

#endif  // LACUNA_SCAN_MESH_FRAMES_H_
