#include "scan/camera_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CameraDoubts, IntrinsicsOfAnotherResolutionAreTold) {
  EXPECT_EQ(DoubtOfIntrinsics({600, 600, 319.5, 239.5}, 640, 480), "");
  EXPECT_EQ(DoubtOfIntrinsics({600, 601, 330, 200}, 640, 480), "") << "a real camera";
  EXPECT_THAT(DoubtOfIntrinsics({600, 600, 319.5, 239.5}, 320, 240),
              AllOf(HasSubstr("far from the middle of the images of 320 × 240 pixels"),
                    HasSubstr("suits images of 640 × 480 pixels"), HasSubstr("(here by 0.5)")));
  EXPECT_THAT(DoubtOfIntrinsics({600, 600, 319.5, 239.5}, 1280, 960),
              AllOf(HasSubstr("far from the middle"), HasSubstr("(here by 2)")));
  EXPECT_THAT(DoubtOfIntrinsics({600, 600, 700, 239.5}, 640, 480), HasSubstr("outside the images"));
  EXPECT_THAT(DoubtOfIntrinsics({60, 60, 319.5, 239.5}, 640, 480), HasSubstr("show 159° × 152°"));
  EXPECT_THAT(DoubtOfIntrinsics({6e5, 6e5, 319.5, 239.5}, 640, 480), HasSubstr("focal lengths"));
  EXPECT_THAT(DoubtOfIntrinsics({600, 400, 319.5, 239.5}, 640, 480), HasSubstr("square"));
}

// Two cameras 0.5 m from an object at the origin, at right angles, and what each of them sees in
// its own frame: a square patch in front of it.
struct Pair {
  std::vector<Camera> cameras = {{"left", {}, {}}, {"right", {}, {}}};
  Eigen::Matrix3Xd patch{3, 4};
  Pair() {
    patch << -0.05, 0.05, 0.05, -0.05, -0.05, -0.05, 0.05, 0.05, 0.45, 0.45, 0.45, 0.45;
    const double quarter = std::numbers::pi / 2;
    for (const int c : {0, 1}) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.rotate(Eigen::AngleAxisd(c * quarter + 0.3, Eigen::Vector3d::UnitY()));
      pose.translate(Eigen::Vector3d(0, 0, -0.5));
      cameras[c].world_from_camera = pose;
    }
  }
  std::string Doubt(bool inverted) {
    std::vector<Eigen::Matrix3Xd> views;
    for (Camera& camera : cameras) {
      if (inverted) camera.world_from_camera = camera.world_from_camera.inverse();
      views.push_back(camera.world_from_camera * patch);
    }
    return DoubtOfPoses(views, cameras, true);
  }
};

TEST(CameraDoubts, PosesTheWrongWayRoundAreTold) {
  EXPECT_EQ(Pair().Doubt(false), "");
  EXPECT_THAT(Pair().Doubt(true),
              AllOf(HasSubstr("nothing that it sees is near what another camera sees"),
                    HasSubstr("with world_from_camera in place of camera_from_world")));
}

TEST(CameraDoubts, ASingleCameraIsNotDoubted) {
  Pair pair;
  pair.cameras.resize(1);
  EXPECT_EQ(pair.Doubt(true), "");
}

}  // namespace
}  // namespace lacuna
