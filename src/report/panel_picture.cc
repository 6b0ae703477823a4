#include "report/panel_picture.h"

#include <glog/logging.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/offscreen_window.h"
#include "report/page_drawing.h"

namespace lacuna {
namespace {

vtkNew<vtkPoints> ToPoints(const Eigen::Matrix3Xd& positions) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(positions.cols());
  for (Eigen::Index k = 0; k < positions.cols(); ++k) points->SetPoint(k, positions.col(k).data());
  return points;
}

vtkNew<vtkPolyData> ToVtk(const PanelSurface& drawn) {
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(ToPoints(drawn.mesh.vertices));
  vtkNew<vtkCellArray> triangles;
  for (const auto& triangle : drawn.mesh.triangles.colwise()) {
    const vtkIdType nodes[] = {triangle[0], triangle[1], triangle[2]};
    triangles->InsertNextCell(3, nodes);
  }
  surface->SetPolys(triangles);
  if (drawn.vertex_values.size() > 0) {
    vtkNew<vtkDoubleArray> values;
    values->SetNumberOfTuples(drawn.vertex_values.size());
    std::copy(drawn.vertex_values.begin(), drawn.vertex_values.end(), values->GetPointer(0));
    surface->GetPointData()->SetScalars(values);
  }
  return surface;
}

vtkNew<vtkPolyData> ToVtk(const PanelPoints& drawn) {
  vtkNew<vtkPolyData> dots;
  dots->SetPoints(ToPoints(drawn.points));
  vtkNew<vtkCellArray> cells;
  for (vtkIdType k = 0; k < drawn.points.cols(); ++k) cells->InsertNextCell(1, &k);
  dots->SetVerts(cells);
  return dots;
}

// The range `wanted` or, where it is absent, that of all values in the picture.
std::pair<double, double> ColourRange(const PanelPicture& picture,
                                      const std::optional<std::pair<double, double>>& wanted) {
  if (wanted) return *wanted;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Panel& panel : picture.panels) {
    for (const PanelSurface& surface : panel.surfaces) {
      for (const double value : surface.vertex_values) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
  }
  if (!(low <= high)) return {0, 1};
  // Lengths that are almost zero somewhere are easiest to read on a scale that begins at zero.
  constexpr double kAlmostZero = 0.05;
  if (low > 0 && low < kAlmostZero * high) low = 0;
  return {low, high};
}

// Even steps of lightness from yellow to dark blue: readable in grey and by colour-blind readers.
// The small values, which cover most of a surface, are light, so that edges drawn on it can be
// seen.
vtkNew<vtkColorTransferFunction> Colours(std::pair<double, double> range) {
  constexpr double kStops[][3] = {{0.993, 0.906, 0.144}, {0.478, 0.821, 0.318},
                                  {0.135, 0.659, 0.518}, {0.164, 0.471, 0.558},
                                  {0.254, 0.265, 0.530}, {0.267, 0.005, 0.329}};
  const double width =
      std::max(range.second - range.first, 1e-12 * std::max(1e-300, std::abs(range.first)));
  vtkNew<vtkColorTransferFunction> colours;
  for (int k = 0; k < 6; ++k) {
    colours->AddRGBPoint(range.first + width * k / 5, kStops[k][0], kStops[k][1], kStops[k][2]);
  }
  colours->SetNanColor(0.6, 0.6, 0.6);
  return colours;
}

vtkNew<vtkActor> ActorOf(const PanelSurface& drawn, vtkColorTransferFunction* colours) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(ToVtk(drawn));
  if (drawn.vertex_values.size() > 0) {
    mapper->SetLookupTable(colours);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetColor(drawn.colour[0], drawn.colour[1], drawn.colour[2]);
  property->SetAmbient(0.25);
  property->SetDiffuse(0.75);
  property->SetEdgeVisibility(drawn.show_edges);
  property->SetEdgeColor(0.25, 0.25, 0.25);
  if (drawn.flat) property->SetInterpolationToFlat();
  if (drawn.only_edges) {
    property->SetRepresentationToWireframe();
  }
  property->SetLighting(drawn.is_lit && !drawn.only_edges);
  return actor;
}

vtkNew<vtkActor> ActorOf(const PanelPoints& drawn) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(ToVtk(drawn));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(drawn.colour[0], drawn.colour[1], drawn.colour[2]);
  actor->GetProperty()->SetLighting(false);
  actor->GetProperty()->SetPointSize(static_cast<float>(drawn.size));
  return actor;
}

// Parts of the picture in pixels, from the lower left.
struct Layout {
  double text = 0;                            // size of letters
  double right = 0, bottom = 0, top = 0;      // edges of the area of the panels
  double caption = 0, legend = 0, title = 0;  // y of the middle of the line
  double panel_title = 0;                     // height of the strip above each panel
  int rows = 1;
};

Layout LayOut(const PanelPicture& picture, const PanelOptions& options, bool has_bar) {
  constexpr double kLine = 2.2;  // line height over letter size
  Layout layout;
  layout.text = options.text_size > 0 ? options.text_size : options.height / 40.0;
  const double line = kLine * layout.text;
  layout.right = has_bar ? 0.82 * options.width : options.width;
  const auto take_bottom = [&](bool wanted) {
    const double middle = layout.bottom + 0.5 * line;
    if (wanted) layout.bottom += line;
    return middle;
  };
  layout.caption = take_bottom(!picture.caption.empty());
  layout.legend = take_bottom(!picture.legend.empty());
  layout.top = options.height - (picture.title.empty() ? 0 : line);
  layout.title = options.height - 0.5 * line;
  const bool has_titles = std::any_of(picture.panels.begin(), picture.panels.end(),
                                      [](const Panel& panel) { return !panel.title.empty(); });
  if (has_titles) layout.panel_title = line;
  layout.rows = static_cast<int>(picture.panels.size() + picture.columns - 1) / picture.columns;
  return layout;
}

void AddColourBar(const std::string& name, const Layout& layout, const PanelOptions& options,
                  vtkColorTransferFunction* colours, vtkRenderer* renderer) {
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetTitle(name.c_str());
  bar->SetMaximumNumberOfColors(256);
  bar->SetNumberOfLabels(5);
  bar->SetLabelFormat("%.3g");
  bar->SetPosition(0.86, 0.15);
  bar->SetWidth(0.12);
  bar->SetHeight(0.7);
  bar->SetBarRatio(0.25);
  bar->UnconstrainedFontSizeOn();
  bar->SetVerticalTitleSeparation(options.height / 60);
  SetDarkText(bar->GetTitleTextProperty(), 0.9 * layout.text);
  SetDarkText(bar->GetLabelTextProperty(), 0.8 * layout.text);
  renderer->AddActor(bar);
}

// Draws coloured squares with their texts, side by side from the left.
void AddLegend(const std::vector<LegendEntry>& legend, const Layout& layout,
               vtkRenderer* renderer) {
  double x = layout.text;
  for (const LegendEntry& entry : legend) {
    const double side = 0.7 * layout.text;
    DrawRectangle({x, layout.legend - 0.5 * side}, {side, side}, entry.colour, renderer);
    DrawText(entry.text, x + 1.4 * layout.text, layout.legend, TextAnchor::kLeft, 0.9 * layout.text,
             renderer);
    x += (3 + 0.5 * static_cast<double>(entry.text.size())) * layout.text;
  }
}

// Sets a parallel projection, in which equal lengths look equal, with the whole box in the panel.
void PlaceCamera(const Eigen::AlignedBox3d& box, const PanelOptions& options, double aspect,
                 vtkRenderer* renderer) {
  const Eigen::Vector3d forward = options.view_direction.normalized();
  const Eigen::Vector3d right = forward.cross(options.up).normalized();
  const Eigen::Vector3d above = right.cross(forward);
  double half_width = 0;
  double half_height = 0;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner =
        box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)) - box.center();
    half_width = std::max(half_width, std::abs(corner.dot(right)));
    half_height = std::max(half_height, std::abs(corner.dot(above)));
  }
  constexpr double kMargin = 1.08;
  const double scale = kMargin * std::max(half_height, half_width / aspect);
  const double distance = std::max(box.diagonal().norm(), 1e-9);
  const Eigen::Vector3d centre = box.center();
  const Eigen::Vector3d eye = centre - 2 * distance * forward;
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(centre.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(above.data());
  camera->SetParallelScale(std::max(scale, 1e-9));
  renderer->ResetCameraClippingRange();
}

Eigen::AlignedBox3d BoxOf(const PanelPicture& picture) {
  Eigen::AlignedBox3d box;
  for (const Panel& panel : picture.panels) {
    for (const PanelSurface& surface : panel.surfaces)
      box.extend(BoundingBox(surface.mesh.vertices));
    for (const PanelPoints& dots : panel.points)
      if (dots.points.cols() > 0) box.extend(BoundingBox(dots.points));
  }
  return box;
}

void CheckPicture(const PanelPicture& picture, const PanelOptions& options) {
  CHECK_GE(picture.columns, 1);
  CHECK_GT(options.view_direction.cross(options.up).norm(), 0)
      << "up must not be the view direction";
  bool has_surface = false;
  for (const Panel& panel : picture.panels) {
    for (const PanelSurface& surface : panel.surfaces) {
      has_surface = true;
      CHECK_GT(surface.mesh.vertices.cols(), 0);
      CHECK(surface.vertex_values.size() == 0 ||
            surface.vertex_values.size() == surface.mesh.vertices.cols())
          << "the picture's values must be as many as the vertices";
    }
    has_surface = has_surface || !panel.points.empty();
  }
  CHECK(has_surface) << "nothing to draw";
}

}  // namespace

PictureResult NoRenderer() {
  return {PictureResult::Status::kNoRenderer,
          "no picture: this machine offers no OpenGL through EGL (Debian: libegl1, "
          "libgl1-mesa-dri)"};
}

PictureResult RenderPanelPng(const std::filesystem::path& file, const PanelPicture& picture,
                             const PanelOptions& options) {
  CheckPicture(picture, options);
  OffscreenWindow window(options.width, options.height);
  if (!window.IsUsable()) return NoRenderer();
  bool has_bar = false;
  for (const Panel& panel : picture.panels)
    for (const PanelSurface& surface : panel.surfaces)
      has_bar = has_bar || surface.vertex_values.size() > 0;
  const auto colours = Colours(ColourRange(picture, options.range));
  const Layout layout = LayOut(picture, options, has_bar);
  const Eigen::AlignedBox3d box = options.framing.isEmpty() ? BoxOf(picture) : options.framing;

  vtkNew<vtkRenderer> page;
  page->SetBackground(1, 1, 1);
  DrawText(picture.title, 0.5 * options.width, layout.title, TextAnchor::kCentre, 1.1 * layout.text,
           page);
  DrawText(picture.caption, layout.text, layout.caption, TextAnchor::kLeft, layout.text, page);
  AddLegend(picture.legend, layout, page);
  if (has_bar) AddColourBar(picture.value_name, layout, options, colours, page);
  window.Add(page);

  const double width = layout.right / picture.columns;
  const double height = (layout.top - layout.bottom) / layout.rows;
  for (size_t k = 0; k < picture.panels.size(); ++k) {
    const Panel& panel = picture.panels[k];
    const double left = width * static_cast<double>(k % picture.columns);
    const double top = layout.top - height * static_cast<double>(k / picture.columns);
    const double inner_top = top - layout.panel_title;
    DrawText(panel.title, left + 0.5 * width, top - 0.5 * layout.panel_title, TextAnchor::kCentre,
             0.9 * layout.text, page);
    vtkNew<vtkRenderer> renderer;
    renderer->SetBackground(1, 1, 1);
    renderer->SetViewport(left / options.width, (top - height) / options.height,
                          (left + width) / options.width, inner_top / options.height);
    for (const PanelSurface& surface : panel.surfaces)
      renderer->AddActor(ActorOf(surface, colours));
    for (const PanelPoints& dots : panel.points)
      if (dots.points.cols() > 0) renderer->AddActor(ActorOf(dots));
    PlaceCamera(box, options, width / (height - layout.panel_title), renderer);
    window.Add(renderer);
  }
  window.WritePng(file);
  return {PictureResult::Status::kWritten, ""};
}

}  // namespace lacuna
