#include "report/surface_picture.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <glog/logging.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/atomic_file.h"

namespace lacuna {
namespace {

// A current OpenGL context of one small off-screen surface; VTK draws into its own framebuffer.
class EglContext {
 public:
  EglContext() {
    const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get_platform_display == nullptr) return;
    display_ = get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) return;
    if (!eglBindAPI(EGL_OPENGL_API)) return;
    const EGLint wanted[] = {
        EGL_SURFACE_TYPE,    EGL_PBUFFER_BIT, EGL_RED_SIZE, 8, EGL_GREEN_SIZE, 8, EGL_BLUE_SIZE, 8,
        EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,  EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0) return;
    const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display_, config, size);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2, EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
    current_ = surface_ != EGL_NO_SURFACE && context_ != EGL_NO_CONTEXT &&
               eglMakeCurrent(display_, surface_, surface_, context_);
  }
  ~EglContext() {
    if (display_ == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
    eglTerminate(display_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  bool IsCurrent() const { return current_; }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLSurface surface_ = EGL_NO_SURFACE;
  EGLContext context_ = EGL_NO_CONTEXT;
  bool current_ = false;
};

// VTK's window over a context that somebody else made. GLEW, through which VTK finds the OpenGL
// functions, finds them all and then complains that there is no X display; that is the point here.
class SurfacelessWindow : public vtkGenericOpenGLRenderWindow {
 public:
  static SurfacelessWindow* New();
  vtkTypeMacro(SurfacelessWindow, vtkGenericOpenGLRenderWindow);

  void OpenGLInitContext() override {
    const int warnings = vtkObject::GetGlobalWarningDisplay();
    vtkObject::SetGlobalWarningDisplay(0);
    Superclass::OpenGLInitContext();
    vtkObject::SetGlobalWarningDisplay(warnings);
    GlewInitValid = true;
  }
};
vtkStandardNewMacro(SurfacelessWindow);

vtkNew<vtkPoints> ToPoints(const Eigen::Matrix3Xd& positions) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(positions.cols());
  for (Eigen::Index k = 0; k < positions.cols(); ++k) points->SetPoint(k, positions.col(k).data());
  return points;
}

vtkNew<vtkPolyData> ToSurface(const SurfaceScene& scene) {
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(ToPoints(scene.mesh.vertices));
  vtkNew<vtkCellArray> triangles;
  for (const auto& triangle : scene.mesh.triangles.colwise()) {
    const vtkIdType nodes[] = {triangle[0], triangle[1], triangle[2]};
    triangles->InsertNextCell(3, nodes);
  }
  surface->SetPolys(triangles);
  if (scene.vertex_values.size() > 0) {
    vtkNew<vtkDoubleArray> values;
    values->SetNumberOfTuples(scene.vertex_values.size());
    std::copy(scene.vertex_values.begin(), scene.vertex_values.end(), values->GetPointer(0));
    surface->GetPointData()->SetScalars(values);
  }
  return surface;
}

vtkNew<vtkPolyData> ToDots(const Eigen::Matrix3Xd& positions) {
  vtkNew<vtkPolyData> dots;
  dots->SetPoints(ToPoints(positions));
  vtkNew<vtkCellArray> cells;
  for (vtkIdType k = 0; k < positions.cols(); ++k) cells->InsertNextCell(1, &k);
  dots->SetVerts(cells);
  return dots;
}

std::pair<double, double> ColourRange(const Eigen::VectorXd& values,
                                      const std::optional<std::pair<double, double>>& wanted) {
  if (wanted) return *wanted;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return low <= high ? std::make_pair(low, high) : std::make_pair(0.0, 1.0);
}

// Even steps of lightness from dark blue to yellow, readable in grey and for colour-blind eyes.
vtkNew<vtkColorTransferFunction> Colours(std::pair<double, double> range) {
  constexpr double kStops[][3] = {{0.267, 0.005, 0.329}, {0.254, 0.265, 0.530},
                                  {0.164, 0.471, 0.558}, {0.135, 0.659, 0.518},
                                  {0.478, 0.821, 0.318}, {0.993, 0.906, 0.144}};
  const double width =
      std::max(range.second - range.first, 1e-12 * std::max(1e-300, std::abs(range.first)));
  vtkNew<vtkColorTransferFunction> colours;
  for (int k = 0; k < 6; ++k) {
    colours->AddRGBPoint(range.first + width * k / 5, kStops[k][0], kStops[k][1], kStops[k][2]);
  }
  colours->SetNanColor(0.6, 0.6, 0.6);
  return colours;
}

vtkNew<vtkActor> SurfaceActor(const SurfaceScene& scene, const PictureOptions& options,
                              vtkColorTransferFunction* colours) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(ToSurface(scene));
  if (colours != nullptr) {
    mapper->SetLookupTable(colours);
    mapper->UseLookupTableScalarRangeOn();
    mapper->InterpolateScalarsBeforeMappingOn();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.75, 0.78, 0.82);
  actor->GetProperty()->SetAmbient(0.25);
  actor->GetProperty()->SetDiffuse(0.75);
  actor->GetProperty()->SetEdgeVisibility(options.show_edges);
  actor->GetProperty()->SetEdgeColor(0.25, 0.25, 0.25);
  return actor;
}

vtkNew<vtkActor> DotActor(const Eigen::Matrix3Xd& positions, double size) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(ToDots(positions));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.85, 0.15, 0.1);
  actor->GetProperty()->SetLighting(false);
  actor->GetProperty()->SetPointSize(static_cast<float>(size));
  return actor;
}

void SetDarkText(vtkTextProperty* text, int size) {
  text->SetColor(0.1, 0.1, 0.1);
  text->SetFontSize(size);
  text->SetShadow(0);
  text->SetItalic(0);
  text->SetBold(0);
}

vtkNew<vtkScalarBarActor> ColourBar(const std::string& name, vtkColorTransferFunction* colours,
                                    int height) {
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
  bar->SetVerticalTitleSeparation(height / 60);
  SetDarkText(bar->GetTitleTextProperty(), height / 45);
  SetDarkText(bar->GetLabelTextProperty(), height / 50);
  return bar;
}

vtkNew<vtkTextActor> Caption(const std::string& text, int height) {
  vtkNew<vtkTextActor> caption;
  caption->SetInput(text.c_str());
  SetDarkText(caption->GetTextProperty(), height / 40);
  caption->SetDisplayPosition(height / 40, height / 40);
  return caption;
}

// Parallel projection, so that equal lengths look equal; the whole framing box is in the picture,
// left of the colour bar.
void PlaceCamera(const Eigen::AlignedBox3d& box, const PictureOptions& options, bool has_bar,
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
  const double used_width = has_bar ? 0.82 : 1.0;  // of the picture
  const double aspect = static_cast<double>(options.width) / options.height;
  const double scale = kMargin * std::max(half_height, half_width / (aspect * used_width));
  const Eigen::Vector3d centre = box.center() + right * (1 - used_width) * aspect * scale;
  const double distance = std::max(box.diagonal().norm(), 1e-9);
  const Eigen::Vector3d eye = centre - 2 * distance * forward;
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(centre.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(above.data());
  camera->SetParallelScale(std::max(scale, 1e-9));
  renderer->ResetCameraClippingRange();
}

void FillScene(const SurfaceScene& scene, const PictureOptions& options, vtkRenderer* renderer) {
  const bool has_values = scene.vertex_values.size() > 0;
  const auto colours = Colours(ColourRange(scene.vertex_values, options.range));
  renderer->SetBackground(1, 1, 1);
  renderer->AddActor(SurfaceActor(scene, options, has_values ? colours.Get() : nullptr));
  if (scene.points.cols() > 0) renderer->AddActor(DotActor(scene.points, options.point_size));
  if (has_values) renderer->AddActor(ColourBar(scene.value_name, colours, options.height));
  if (!scene.caption.empty()) renderer->AddActor(Caption(scene.caption, options.height));
  Eigen::AlignedBox3d box = options.framing;
  if (box.isEmpty()) {
    box = BoundingBox(scene.mesh.vertices);
    if (scene.points.cols() > 0) box.extend(BoundingBox(scene.points));
  }
  PlaceCamera(box, options, has_values, renderer);
}

}  // namespace

PictureResult RenderSurfacePng(const std::filesystem::path& file, const SurfaceScene& scene,
                               const PictureOptions& options) {
  CHECK_GT(scene.mesh.vertices.cols(), 0);
  CHECK(scene.vertex_values.size() == 0 || scene.vertex_values.size() == scene.mesh.vertices.cols())
      << "the picture's values must be as many as the vertices";
  CHECK_GT(options.view_direction.cross(options.up).norm(), 0)
      << "up must not be the view direction";

  const EglContext context;  // outlives the window
  if (!context.IsCurrent()) {
    return {PictureResult::Status::kNoRenderer,
            "no picture: this machine offers no OpenGL through EGL (Debian: libegl1, "
            "libgl1-mesa-dri)"};
  }
  vtkNew<SurfacelessWindow> window;
  window->SetReadyForRendering(true);
  window->SetIsCurrent(true);
  window->SetOwnContext(0);
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(4);
  window->SetSize(options.width, options.height);
  window->OpenGLInitContext();
  vtkNew<vtkRenderer> renderer;
  window->AddRenderer(renderer);
  FillScene(scene, options, renderer);
  window->Render();

  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  WriteFileAtomically(file, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                             static_cast<size_t>(bytes->GetNumberOfValues())});
  window->Finalize();
  return {PictureResult::Status::kWritten, ""};
}

}  // namespace lacuna
