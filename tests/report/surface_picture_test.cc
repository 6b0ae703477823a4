#include "report/surface_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A picture read back, origin at the lower left.
class Pixels {
 public:
  explicit Pixels(const std::filesystem::path& file) {
    reader_->SetFileName(file.c_str());
    reader_->Update();
  }
  int Width() const { return reader_->GetOutput()->GetDimensions()[0]; }
  int Height() const { return reader_->GetOutput()->GetDimensions()[1]; }
  Eigen::Vector3i At(double x, double y) const {
    const auto* rgb = static_cast<const unsigned char*>(reader_->GetOutput()->GetScalarPointer(
        static_cast<int>(x * (Width() - 1)), static_cast<int>(y * (Height() - 1)), 0));
    return {rgb[0], rgb[1], rgb[2]};
  }
  double FractionNotWhite() const {
    int count = 0;
    for (int x = 0; x < Width(); ++x) {
      for (int y = 0; y < Height(); ++y) {
        const auto* rgb =
            static_cast<const unsigned char*>(reader_->GetOutput()->GetScalarPointer(x, y, 0));
        count += rgb[0] + rgb[1] + rgb[2] < 3 * 250;
      }
    }
    return static_cast<double>(count) / (Width() * Height());
  }

 private:
  vtkNew<vtkPNGReader> reader_;
};

// The unit square in the plane z = 0, value 0 on the left edge and 1 on the right.
SurfaceScene Square() {
  SurfaceScene scene;
  scene.mesh.vertices.resize(3, 4);
  scene.mesh.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,                     //
      0, 0, 0, 0;
  scene.mesh.triangles.resize(3, 2);
  scene.mesh.triangles << 0, 0,  //
      1, 2,                      //
      2, 3;
  return scene;
}

// From above, x to the right, y up, a square window of 2 × 2 m about the middle of the square.
PictureOptions FromAbove() {
  PictureOptions options;
  options.width = options.height = 400;
  options.view_direction = {0, 0, -1};
  options.up = {0, 1, 0};
  options.framing = {Eigen::Vector3d(-0.5, -0.5, 0), Eigen::Vector3d(1.5, 1.5, 0)};
  return options;
}

#define RENDER_OR_SKIP(file, scene, options)                             \
  do {                                                                   \
    const PictureResult result = RenderSurfacePng(file, scene, options); \
    if (result.status == PictureResult::Status::kNoRenderer) {           \
      GTEST_SKIP() << "skipped, " << result.message;                     \
    }                                                                    \
    ASSERT_TRUE(result.IsUsable());                                      \
  } while (false)

TEST(SurfacePictureTest, SquareCoversThePixelsThatItShould) {
  const TemporaryFolder folder;
  RENDER_OR_SKIP(folder / "a.png", Square(), FromAbove());
  const Pixels pixels(folder / "a.png");
  EXPECT_EQ(pixels.Width(), 400);
  EXPECT_EQ(pixels.Height(), 400);
  // The square's side is 1 of 2 · 1.08 (the margin); 1 % for pixels cut by the edge.
  EXPECT_NEAR(pixels.FractionNotWhite(), 1 / (2.16 * 2.16), 0.01);
  EXPECT_EQ(pixels.At(0.05, 0.05), Eigen::Vector3i(255, 255, 255));
  EXPECT_LT(pixels.At(0.5, 0.5).maxCoeff(), 240);
}

TEST(SurfacePictureTest, ColoursRunFromYellowToDarkBlueWithTheValue) {
  const TemporaryFolder folder;
  SurfaceScene scene = Square();
  scene.vertex_values = Eigen::Vector4d(0, 1, 1, 0);
  scene.value_name = "distance (m)";
  RENDER_OR_SKIP(folder / "a.png", scene, FromAbove());
  const Pixels pixels(folder / "a.png");
  // With a colour bar the middle of the box stands at 0.41 of the width and its half side is
  // 0.41 / 1.08 / 2; the two samples lie just inside the left and right edge.
  const Eigen::Vector3i left = pixels.At(0.41 - 0.17, 0.5);
  const Eigen::Vector3i right = pixels.At(0.41 + 0.17, 0.5);
  EXPECT_GT(left[0], left[2] + 80);  // red and green without blue: yellow
  EXPECT_GT(left[1], left[2] + 80);
  EXPECT_GT(right[2], right[1]);  // blue before green
  EXPECT_LT(right.sum(), 300);    // dark
  EXPECT_GT(left.sum(), right.sum() + 100);
}

TEST(SurfacePictureTest, FixedRangeMakesFramesComparable) {
  const TemporaryFolder folder;
  SurfaceScene scene = Square();
  scene.vertex_values = Eigen::Vector4d::Constant(0.25);
  PictureOptions options = FromAbove();
  options.range = {0.0, 1.0};
  RENDER_OR_SKIP(folder / "a.png", scene, options);
  scene.vertex_values = Eigen::Vector4d::Constant(0.75);
  RENDER_OR_SKIP(folder / "b.png", scene, options);
  EXPECT_GT(Pixels(folder / "a.png").At(0.41, 0.5)[1],
            Pixels(folder / "b.png").At(0.41, 0.5)[1] + 40);
}

TEST(SurfacePictureTest, UnmeasuredValuesAreGrey) {
  const TemporaryFolder folder;
  SurfaceScene scene = Square();
  scene.vertex_values = Eigen::Vector4d::Constant(std::numeric_limits<double>::quiet_NaN());
  RENDER_OR_SKIP(folder / "a.png", scene, FromAbove());
  const Eigen::Vector3i middle = Pixels(folder / "a.png").At(0.41, 0.5);
  EXPECT_LE(middle.maxCoeff() - middle.minCoeff(), 2);
  EXPECT_LT(middle.maxCoeff(), 240);
}

TEST(SurfacePictureTest, PointsAreDrawnOverTheSurface) {
  const TemporaryFolder folder;
  SurfaceScene scene = Square();
  scene.points = Eigen::Vector3d(0.5, 0.5, 0.01);
  PictureOptions options = FromAbove();
  options.point_size = 12;
  RENDER_OR_SKIP(folder / "a.png", scene, options);
  const Eigen::Vector3i middle = Pixels(folder / "a.png").At(0.5, 0.5);
  EXPECT_GT(middle[0], middle[1] + 100);
}

TEST(SurfacePictureTest, SameSceneGivesTheSameBytesAndNoEnvironmentIsNeeded) {
  const TemporaryFolder folder;
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  SurfaceScene scene = Square();
  scene.vertex_values = Eigen::Vector4d(0, 1, 2, 3);
  scene.value_name = "distance (mm)";
  scene.caption = "frame 3";
  RENDER_OR_SKIP(folder / "a.png", scene, {});
  RENDER_OR_SKIP(folder / "b.png", scene, {});
  EXPECT_EQ(FileContent(folder / "a.png"), FileContent(folder / "b.png"));
}

TEST(SurfacePictureTest, UnwritableFileIsNamed) {
  const TemporaryFolder folder;
  RENDER_OR_SKIP(folder / "a.png", Square(), FromAbove());
  EXPECT_THAT([] { RenderSurfacePng("/proc/a.png", Square(), FromAbove()); },
              ThrowsMessage<InputError>(HasSubstr("/proc/a.png: cannot be written")));
}

TEST(SurfacePictureDeathTest, ValuesMustBeAsManyAsTheVertices) {
  SurfaceScene scene = Square();
  scene.vertex_values = Eigen::Vector3d::Zero();
  EXPECT_DEATH(RenderSurfacePng("a.png", scene), "as many as the vertices");
}

}  // namespace
}  // namespace lacuna
