#include "report/surface_picture.h"

#include <utility>

namespace lacuna {

PictureResult RenderSurfacePng(const std::filesystem::path& file, const SurfaceScene& scene,
                               const PictureOptions& options) {
  Panel panel;
  PanelSurface surface;
  surface.mesh = scene.mesh;
  surface.vertex_values = scene.vertex_values;
  surface.show_edges = options.show_edges;
  panel.surfaces.push_back(std::move(surface));
  if (scene.points.cols() > 0) {
    PanelPoints dots;
    dots.points = scene.points;
    dots.size = options.point_size;
    panel.points.push_back(std::move(dots));
  }
  PanelPicture picture;
  picture.panels.push_back(std::move(panel));
  picture.value_name = scene.value_name;
  picture.caption = scene.caption;
  return RenderPanelPng(file, picture, options);
}

}  // namespace lacuna
