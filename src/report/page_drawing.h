// Text and rectangles on a page that VTK draws. Places and sizes are pixels from the lower left
// corner; colours are red, green and blue, 0 to 1.
#ifndef LACUNA_REPORT_PAGE_DRAWING_H_
#define LACUNA_REPORT_PAGE_DRAWING_H_

#include <Eigen/Core>
#include <string>

class vtkRenderer;
class vtkTextProperty;

namespace lacuna {

enum class TextAnchor { kLeft, kCentre, kRight };

// Sets the style of dark letters of `size` pixels, without shadow.
void SetDarkText(vtkTextProperty* text, double size);

// Draws a line of dark text: (x, y) is its left end, centre or right end, half way up the letters.
// An empty text draws nothing.
void DrawText(const std::string& text, double x, double y, TextAnchor anchor, double size,
              vtkRenderer* renderer);

// The width, in pixels, of a text with letters of `size` pixels.
double TextWidth(const std::string& text, double size);

// Draws a filled rectangle whose lower left corner is `left_bottom`. Where rectangles overlap, the
// one that was drawn first is visible.
void DrawRectangle(const Eigen::Vector2d& left_bottom, const Eigen::Vector2d& size,
                   const Eigen::Vector3d& colour, vtkRenderer* renderer);

}  // namespace lacuna

#endif  // LACUNA_REPORT_PAGE_DRAWING_H_
