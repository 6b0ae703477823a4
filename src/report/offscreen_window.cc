#include "report/offscreen_window.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <glog/logging.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

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

// A VTK window for an existing context. GLEW, with which VTK loads the OpenGL functions, loads them
// all and then reports that there is no X display; this warning is suppressed here.
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

}  // namespace

struct OffscreenWindow::Implementation {
  EglContext context;  // outlives the window
  vtkSmartPointer<SurfacelessWindow> window;
};

OffscreenWindow::OffscreenWindow(int width, int height)
    : implementation_(std::make_unique<Implementation>()) {
  if (!IsUsable()) return;
  implementation_->window = vtkSmartPointer<SurfacelessWindow>::New();
  SurfacelessWindow* window = implementation_->window;
  window->SetReadyForRendering(true);
  window->SetIsCurrent(true);
  window->SetOwnContext(0);
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(4);
  window->SetSize(width, height);
  window->OpenGLInitContext();
}

OffscreenWindow::~OffscreenWindow() {
  if (IsUsable()) implementation_->window->Finalize();
}

bool OffscreenWindow::IsUsable() const { return implementation_->context.IsCurrent(); }

void OffscreenWindow::Add(vtkRenderer* renderer) {
  CHECK(IsUsable());
  implementation_->window->AddRenderer(renderer);
}

void OffscreenWindow::WritePng(const std::filesystem::path& file) {
  CHECK(IsUsable());
  implementation_->window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(implementation_->window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  WriteFileAtomically(file, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                             static_cast<size_t>(bytes->GetNumberOfValues())});
}

}  // namespace lacuna
