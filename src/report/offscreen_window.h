// VTK's window without a screen, for the pictures of this module.
//
// VTK draws through EGL without a window system: on a machine with neither screen nor graphics
// processor Mesa's software renderer does it.
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

  // False when the machine offers no OpenGL through EGL; nothing can be drawn then (CHECK).
  bool IsUsable() const;
  // Later ones are drawn over earlier ones.
  void Add(vtkRenderer* renderer);
  // Draws, and writes what was drawn as PNG, atomically. Throws InputError when the file cannot be
  // written.
  void WritePng(const std::filesystem::path& file);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_REPORT_OFFSCREEN_WINDOW_H_
