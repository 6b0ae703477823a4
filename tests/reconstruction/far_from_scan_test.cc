// Results that are far from their own scan are errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "experiment/frame_states.h"
#include "reconstruction/follow.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// A scan of two balls of 40 mm whose middles are `distance` apart, as views with wrong poses make
// it.
Recording TwoBalls(const TemporaryFolder& folder, double distance) {
  const TriMesh ball = Icosphere(0.02, 3);
  std::ofstream table(folder / "p.csv");
  table << "x,y,z,nx,ny,nz\n";
  for (const double shift : {0.0, distance}) {
    for (const auto p : ball.vertices.colwise()) {
      table << p.x() + shift << ',' << p.y() << ',' << p.z();
      for (const double n : Eigen::Vector3d(p.normalized())) table << ',' << n;
      table << '\n';
    }
  }
  table.close();
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nlength_unit: m\nframes: {kind: points, files: [p.csv]}\n";
  return LoadRecording(folder.Path());
}

TEST(FarFromScan, ASurfaceThatDoesNotDescribeItsPointsIsAnError) {
  const TemporaryFolder folder;
  const Recording recording = TwoBalls(folder, 0.2);
  EXPECT_THAT([&] { MakeFrameState(recording, 0, {}); },
              ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("frame 0: the surface made from the points is"),
                                 HasSubstr("poses or intrinsics"), HasSubstr("`keep_largest`"))));
}

TEST(FarFromScan, AModelFarFromHalfOfItsScanIsTold) {
  const TriMesh model = Icosphere(0.02, 3);
  Eigen::Matrix3Xd points(3, 2 * model.vertices.cols());
  const auto told = [&](double far_share, double distance) {
    points << model.vertices, model.vertices;
    const auto count = static_cast<Eigen::Index>(far_share * static_cast<double>(points.cols()));
    points.leftCols(count).row(0).array() += distance;
    return FarFromScan(model, points);
  };
  EXPECT_EQ(told(1, 0.001), "") << "a small error";
  EXPECT_EQ(told(0.4, 0.5), "") << "a table beside the object, which the fit leaves out";
  EXPECT_THAT(told(0.6, 0.5), HasSubstr("half of the scanned points are farther than"));
  EXPECT_THAT(told(1, 0.06), HasSubstr("`crop` and `keep_largest`"));
}

}  // namespace
}  // namespace lacuna
