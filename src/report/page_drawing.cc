#include "report/page_drawing.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

namespace lacuna {

void SetDarkText(vtkTextProperty* text, double size) {
  text->SetColor(0.1, 0.1, 0.1);
  text->SetFontSize(static_cast<int>(size));
  text->SetShadow(0);
  text->SetItalic(0);
  text->SetBold(0);
}

void DrawText(const std::string& text, double x, double y, TextAnchor anchor, double size,
              vtkRenderer* renderer) {
  if (text.empty()) return;
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  SetDarkText(actor->GetTextProperty(), size);
  actor->GetTextProperty()->SetVerticalJustificationToCentered();
  if (anchor == TextAnchor::kCentre) actor->GetTextProperty()->SetJustificationToCentered();
  if (anchor == TextAnchor::kRight) actor->GetTextProperty()->SetJustificationToRight();
  actor->SetDisplayPosition(static_cast<int>(x), static_cast<int>(y));
  renderer->AddActor(actor);
}

double TextWidth(const std::string& text, double size) {
  if (text.empty()) return 0;
  constexpr int kDotsPerInch = 72;  // one typographic point is one pixel
  vtkNew<vtkTextProperty> property;
  SetDarkText(property, size);
  int box[4] = {0, 0, 0, 0};
  vtkTextRenderer* renderer = vtkTextRenderer::GetInstance();
  if (renderer == nullptr || !renderer->GetBoundingBox(property, text, box, kDotsPerInch))
    return 0.55 * size * static_cast<double>(text.size());
  return box[1] - box[0] + 1;
}

void DrawRectangle(const Eigen::Vector2d& left_bottom, const Eigen::Vector2d& size,
                   const Eigen::Vector3d& colour, vtkRenderer* renderer) {
  const double left = left_bottom.x(), right = left + size.x();
  const double bottom = left_bottom.y(), top = bottom + size.y();
  vtkNew<vtkPoints> corners;
  corners->SetDataTypeToDouble();
  corners->InsertNextPoint(left, bottom, 0);
  corners->InsertNextPoint(right, bottom, 0);
  corners->InsertNextPoint(right, top, 0);
  corners->InsertNextPoint(left, top, 0);
  vtkNew<vtkCellArray> cells;
  const vtkIdType order[] = {0, 1, 2, 3};
  cells->InsertNextCell(4, order);
  vtkNew<vtkPolyData> shape;
  shape->SetPoints(corners);
  shape->SetPolys(cells);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(shape);
  vtkNew<vtkActor2D> rectangle;
  rectangle->SetMapper(mapper);
  rectangle->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  renderer->AddActor(rectangle);
}

}  // namespace lacuna
