// A picture of several panels with one view and one colour bar, drawn without a screen.
//
// From top to bottom: the title, the panels row by row, each under its own title, and the legend.
// All panels show the same region at the same scale, to the left of the colour bar.
#ifndef LACUNA_REPORT_PANEL_PICTURE_H_
#define LACUNA_REPORT_PANEL_PICTURE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Colours are red, green and blue, 0 to 1.
struct PanelSurface {
  TriMesh mesh;                   // m
  Eigen::VectorXd vertex_values;  // for the colour bar; empty: use `colour`; NaN: grey
  Eigen::Vector3d colour{0.75, 0.78, 0.82};
  bool show_edges = false;
  bool only_edges = false;  // draw the edges alone, in `colour`
  bool flat = false;        // each triangle in one shade: for cuts and facets
  bool is_lit = true;       // false: `colour` as it is, without shading
};

struct PanelPoints {
  Eigen::Matrix3Xd points;  // m
  Eigen::Vector3d colour{0.85, 0.15, 0.1};
  double size = 4;  // pixels
};

struct Panel {
  std::string title;  // above the panel; if all titles are empty, they take no space
  std::vector<PanelSurface> surfaces;
  std::vector<PanelPoints> points;
};

struct LegendEntry {
  Eigen::Vector3d colour;
  std::string text;
};

struct PanelPicture {
  std::string title;  // may be empty
  std::vector<Panel> panels;
  int columns = 1;
  std::string value_name;  // above the colour bar, with the unit; there is a colour bar if any
                           // surface has values
  std::vector<LegendEntry> legend;  // at the bottom; may be empty
  std::string caption;              // below the legend; may be empty
};

struct PanelOptions {
  int width = 1200;  // pixels; larger for print
  int height = 900;
  // The ends of the colour bar. If absent, the smallest and the largest value of all panels; a
  // smallest value close to 0 is replaced by 0.
  std::optional<std::pair<double, double>> range;
  // The region that each panel shows, m; if empty, everything that is drawn in any of them.
  Eigen::AlignedBox3d framing;
  Eigen::Vector3d view_direction{-1, 2, -0.7};  // from the eye to the object
  Eigen::Vector3d up{0, 0, 1};
  double text_size = 0;  // pixels; 0: a fortieth of the height
};

struct PictureResult {
  enum class Status { kNotRun, kWritten, kNoRenderer };
  Status status = Status::kNotRun;
  std::string message;
  bool IsUsable() const { return status == Status::kWritten; }
};

// The result where OpenGL is not available through EGL; the message says what to install.
PictureResult NoRenderer();

// Writes the picture as PNG, atomically. Returns kNoRenderer where OpenGL is not available through
// EGL. Throws InputError when the file cannot be written. CHECKs that there is something to draw,
// and that there is one value for each vertex.
PictureResult RenderPanelPng(const std::filesystem::path& file, const PanelPicture& picture,
                             const PanelOptions& options = {});

}  // namespace lacuna

#endif  // LACUNA_REPORT_PANEL_PICTURE_H_
