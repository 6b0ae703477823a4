// The reference shape: the undeformed object, to which all deformation refers.
#ifndef LACUNA_SCAN_REFERENCE_SHAPE_H_
#define LACUNA_SCAN_REFERENCE_SHAPE_H_

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/similarity.h"

namespace lacuna {

// Where the reference shape comes from.
enum class ReferenceSource { kFirstFrame, kMesh, kTetMesh };

// Which face of a sheet the given surface is.
enum class SheetFace { kMiddle, kFront };

struct ReferenceShape {
  ReferenceSource source = ReferenceSource::kFirstFrame;
  std::filesystem::path file;  // kMesh, kTetMesh
  Similarity world_from_file;  // its length unit included
  double sheet_thickness = 0;  // m; > 0: the surface is an open sheet of that thickness
  SheetFace sheet_face = SheetFace::kMiddle;
};

// Reads `reference` from recording.yaml. Its file is looked for in data.folder and then in
// `own_folder`, the folder of recording.yaml, which may accompany data from another
// source. Frames that do not show the object's surface (`frames_show_surface` is false) need a
// mesh. Throws InputError (file, line, column and field).
ReferenceShape ReadReference(const Config& config, const DataLocation& data,
                             const std::filesystem::path& own_folder, bool frames_show_surface);

// What `lacuna info` says about the reference shape; reads the file of a mesh.
std::string DescribeReference(const ReferenceShape& reference);

// The bounding box of the mesh, m, in the world frame, without the thickness of a sheet; reads its
// file. The source must not be the first frame.
Eigen::AlignedBox3d ReferenceBox(const ReferenceShape& reference);

}  // namespace lacuna

#endif  // LACUNA_SCAN_REFERENCE_SHAPE_H_
