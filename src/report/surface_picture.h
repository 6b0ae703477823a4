// A picture of one surface, drawn without a screen.
#ifndef LACUNA_REPORT_SURFACE_PICTURE_H_
#define LACUNA_REPORT_SURFACE_PICTURE_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "geometry/tri_mesh.h"
#include "report/panel_picture.h"

namespace lacuna {

// What to draw. Lengths are in m.
struct SurfaceScene {
  TriMesh mesh;
  Eigen::VectorXd vertex_values;  // colour the mesh; empty: one colour; NaN: grey
  std::string value_name;         // above the colour bar, with the unit
  Eigen::Matrix3Xd points;        // drawn as dots over the mesh; may be empty
  std::string caption;            // at the bottom; may be empty
};

struct PictureOptions : PanelOptions {
  bool show_edges = false;
  double point_size = 4;  // pixels
};

// Writes the picture as PNG, atomically. Returns kNoRenderer where OpenGL is not available through
// EGL. Throws InputError when the file cannot be written. CHECKs that there is one value for each
// vertex.
PictureResult RenderSurfacePng(const std::filesystem::path& file, const SurfaceScene& scene,
                               const PictureOptions& options = {});

}  // namespace lacuna

#endif  // LACUNA_REPORT_SURFACE_PICTURE_H_
