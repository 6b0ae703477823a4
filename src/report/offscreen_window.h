// A VTK window without a screen, for the pictures of this module.
//
// VTK draws through EGL, without a window system. On a machine with neither screen nor graphics
// processor, Mesa's software renderer is used.
#ifndef LACUNA_REPORT_OFFSCREEN_WINDOW_H_
#define LACUNA_REPORT_OFFSCREEN_WINDOW_H_

#include <filesystem>
#include <memory>

class vtkRenderer;

namespace lacuna {

class OffscreenWindow {
 public:
  OffscreenWindow(int width, int height);  // pixels
  ~OffscreenWindow();
  OffscreenWindow(const OffscreenWindow&) = delete;
  OffscreenWindow& operator=(const OffscreenWindow&) = delete;

  // False where OpenGL is not available through EGL; then nothing may be drawn (CHECK).
  bool IsUsable() const;
  // Adds a renderer, which is drawn over earlier ones.
  void Add(vtkRenderer* renderer);
  // Draws the window and writes it as PNG, atomically. Throws InputError when the file cannot be
  // written.
  void WritePng(const std::filesystem::path& file);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_REPORT_OFFSCREEN_WINDOW_H_
