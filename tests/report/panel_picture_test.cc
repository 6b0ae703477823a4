#include "report/panel_picture.h"

#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <functional>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// A picture that is read back. It counts the pixels of a given kind in a part of the picture, which
// is given as fractions of the width and height from the lower left corner.
class Pixels {
 public:
  explicit Pixels(const std::filesystem::path& file) {
    reader_->SetFileName(file.c_str());
    reader_->Update();
  }
  double Share(double left, double right, double bottom, double top,
               const std::function<bool(int red, int green, int blue)>& is_counted) const {
    const int* size = reader_->GetOutput()->GetDimensions();
    int counted = 0, all = 0;
    for (int x = static_cast<int>(left * size[0]); x < static_cast<int>(right * size[0]); ++x) {
      for (int y = static_cast<int>(bottom * size[1]); y < static_cast<int>(top * size[1]); ++y) {
        const auto* rgb =
            static_cast<const unsigned char*>(reader_->GetOutput()->GetScalarPointer(x, y, 0));
        counted += is_counted(rgb[0], rgb[1], rgb[2]);
        ++all;
      }
    }
    return static_cast<double>(counted) / all;
  }

 private:
  vtkNew<vtkPNGReader> reader_;
};

bool IsRed(int red, int green, int blue) { return red > green + 60 && red > blue + 60; }
bool IsGreen(int red, int green, int blue) { return green > red + 60 && green > blue + 60; }
bool IsDrawn(int red, int green, int blue) { return red + green + blue < 3 * 250; }

// The unit square in the plane z = 0.
PanelSurface Square(const Eigen::Vector3d& colour) {
  PanelSurface surface;
  surface.mesh.vertices.resize(3, 4);
  surface.mesh.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,                       //
      0, 0, 0, 0;
  surface.mesh.triangles.resize(3, 2);
  surface.mesh.triangles << 0, 0,  //
      1, 2,                        //
      2, 3;
  surface.colour = colour;
  return surface;
}

PanelOptions FromAbove(int width, int height) {
  PanelOptions options;
  options.width = width;
  options.height = height;
  options.view_direction = {0, 0, -1};
  options.up = {0, 1, 0};
  return options;
}

const Eigen::Vector3d kRed(1, 0, 0), kGreen(0, 1, 0);

#define RENDER_OR_SKIP(file, picture, options)                           \
  do {                                                                   \
    const PictureResult result = RenderPanelPng(file, picture, options); \
    if (result.status == PictureResult::Status::kNoRenderer) {           \
      GTEST_SKIP() << "skipped, " << result.message;                     \
    }                                                                    \
    ASSERT_TRUE(result.IsUsable());                                      \
  } while (false)

TEST(PanelPictureTest, PanelsAreArrangedRowByRow) {
  const TemporaryFolder folder;
  PanelPicture picture;
  picture.columns = 2;
  picture.panels = {
      {"", {Square(kRed)}, {}}, {"", {Square(kGreen)}, {}}, {"", {Square(kGreen)}, {}}};
  RENDER_OR_SKIP(folder / "a.png", picture, FromAbove(400, 400));
  const Pixels pixels(folder / "a.png");
  // Each square covers 1/1.08² of its quarter (the margin); 2 % for pixels cut by the edge.
  constexpr double kCovered = 1 / (1.08 * 1.08);
  EXPECT_NEAR(pixels.Share(0, 0.5, 0.5, 1, IsRed), kCovered, 0.02);
  EXPECT_NEAR(pixels.Share(0.5, 1, 0.5, 1, IsGreen), kCovered, 0.02);
  EXPECT_NEAR(pixels.Share(0, 0.5, 0, 0.5, IsGreen), kCovered, 0.02);
  EXPECT_EQ(pixels.Share(0.5, 1, 0, 0.5, IsDrawn), 0);
}

TEST(PanelPictureTest, TextsDoNotCoverThePanels) {
  const TemporaryFolder folder;
  PanelPicture picture;
  picture.title = "a title";
  picture.panels = {{"a panel", {Square(kRed)}, {}}};
  picture.legend = {{kGreen, "a legend"}};
  picture.caption = "a caption";
  PanelOptions options = FromAbove(400, 400);
  options.text_size = 16;
  RENDER_OR_SKIP(folder / "a.png", picture, options);
  const Pixels pixels(folder / "a.png");
  // Lines of 2.2 · 16 pixels: caption and legend below, panel title and title above.
  constexpr double kLine = 2.2 * 16 / 400;
  EXPECT_GT(pixels.Share(0, 1, 0, kLine, IsDrawn), 0.005);
  EXPECT_GT(pixels.Share(0, 0.2, kLine, 2 * kLine, IsGreen), 0.01) << "the legend's colour";
  EXPECT_GT(pixels.Share(0, 1, 1 - 2 * kLine, 1 - kLine, IsDrawn), 0.005);
  EXPECT_GT(pixels.Share(0, 1, 1 - kLine, 1, IsDrawn), 0.005);
  EXPECT_EQ(pixels.Share(0, 1, 0, 2 * kLine, IsRed), 0);
  EXPECT_EQ(pixels.Share(0, 1, 1 - 2 * kLine, 1, IsRed), 0);
}

TEST(PanelPictureTest, AWireframeDoesNotFillItsTriangles) {
  const TemporaryFolder folder;
  PanelPicture picture;
  picture.panels = {{"", {Square(kRed)}, {}}};
  picture.panels[0].surfaces[0].only_edges = true;
  RENDER_OR_SKIP(folder / "a.png", picture, FromAbove(400, 400));
  // Five edges, 370 pixels long or half as much again, one or two pixels wide.
  const double share = Pixels(folder / "a.png").Share(0, 1, 0, 1, IsDrawn);
  EXPECT_GT(share, 0.005);
  EXPECT_LT(share, 0.05);
}

TEST(PanelPictureTest, AllPanelsShareOneColourScale) {
  const TemporaryFolder folder;
  PanelPicture picture;
  picture.columns = 2;
  picture.value_name = "strain %";
  picture.panels = {{"", {Square(kRed)}, {}}, {"", {Square(kRed)}, {}}};
  picture.panels[0].surfaces[0].vertex_values = Eigen::Vector4d::Constant(1);
  picture.panels[1].surfaces[0].vertex_values = Eigen::Vector4d::Constant(3);
  RENDER_OR_SKIP(folder / "a.png", picture, FromAbove(800, 400));
  const Pixels pixels(folder / "a.png");
  const auto is_dark = [](int red, int green, int blue) { return red + green + blue < 300; };
  const auto is_yellow = [](int red, int green, int blue) {
    return red > blue + 80 && green > blue + 80;
  };
  // Each has half of the 82 % left of the bar; the squares are 0.41 / 1.08 of the width.
  EXPECT_GT(pixels.Share(0.1, 0.3, 0.4, 0.6, is_yellow), 0.99);
  EXPECT_GT(pixels.Share(0.51, 0.71, 0.4, 0.6, is_dark), 0.99);
  EXPECT_GT(pixels.Share(0.83, 1, 0, 1, IsDrawn), 0.02) << "the bar";
}

TEST(PanelPictureDeathTest, RefusesAPictureWithNothingToDraw) {
  EXPECT_DEATH(RenderPanelPng("a.png", PanelPicture()), "nothing to draw");
}

}  // namespace
}  // namespace lacuna
