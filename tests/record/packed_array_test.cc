#include "record/packed_array.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Two points that move over four frames; the second was not seen in frame 2.
Eigen::MatrixXd Frames() {
  Eigen::MatrixXd frames(6, 4);
  for (Eigen::Index f = 0; f < 4; ++f)
    for (Eigen::Index k = 0; k < 6; ++k)
      frames(k, f) = std::sin(0.7 * static_cast<double>(6 * f + k)) - 0.2;
  frames.col(2).tail<3>().setConstant(kNan);
  return frames;
}

TEST(PackedArray, FramesComeBackWithinHalfAStep) {
  const Eigen::MatrixXd frames = Frames();
  const nlohmann::json packed = PackFrames(frames, {2, 3});
  const UnpackedArray unpacked = Unpack(packed);
  EXPECT_EQ(unpacked.shape, (std::vector<int>{4, 2, 3}));
  ASSERT_EQ(unpacked.values.cols(), 4);
  const double step = (packed.at("high").get<double>() - packed.at("low").get<double>()) / 65534;
  for (Eigen::Index k = 0; k < frames.size(); ++k) {
    const double before = frames.reshaped()[k], after = unpacked.values.reshaped()[k];
    EXPECT_EQ(std::isnan(before), std::isnan(after)) << k;
    // A rounding error of the arithmetic comes on top of the half step.
    if (std::isnan(before)) continue;
    EXPECT_NEAR(before, after, 0.5001 * step) << k;
  }
}

// Constant values, and none at all, have no range.
TEST(PackedArray, ValuesWithoutARangeComeBack) {
  EXPECT_EQ(Unpack(PackFrames(Eigen::MatrixXd::Constant(2, 3, 0.7), {2})).values,
            Eigen::MatrixXd::Constant(2, 3, 0.7));
  EXPECT_TRUE(
      Unpack(PackFrames(Eigen::MatrixXd::Constant(2, 3, kNan), {2})).values.array().isNaN().all());
  EXPECT_EQ(Unpack(PackFrames(Eigen::MatrixXd(0, 3), {0, 3})).values.size(), 0);
}

TEST(PackedArray, FloatsAndTrianglesComeBackExactly) {
  Eigen::MatrixXd values(2, 2);
  values << 0.5, -0.25, kNan, 1024;
  const Eigen::MatrixXd floats = Unpack(PackFloats(values, {2})).values;
  EXPECT_EQ(floats(0, 0), 0.5);
  EXPECT_EQ(floats(1, 1), 1024);
  EXPECT_TRUE(std::isnan(floats(1, 0)));
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 70000, 1, 2, 2, 3;
  const UnpackedArray unpacked = Unpack(PackTriangles(triangles));
  EXPECT_EQ(unpacked.shape, (std::vector<int>{2, 3}));
  EXPECT_EQ(unpacked.values.cast<int>(), triangles);
}

TEST(PackedArray, TheSameFramesGiveTheSameText) {
  EXPECT_EQ(PackFrames(Frames(), {2, 3}).dump(), PackFrames(Frames(), {2, 3}).dump());
}

TEST(PackedArray, RefusesOtherObjects) {
  EXPECT_THROW(Unpack({{"shape", {1}}}), InputError);
  nlohmann::json packed = PackFrames(Frames(), {2, 3});
  packed["shape"] = {4, 3, 3};
  EXPECT_THROW(Unpack(packed), InputError);
  packed = PackFrames(Frames(), {2, 3});
  packed["type"] = "int64";
  EXPECT_THROW(Unpack(packed), InputError);
}

}  // namespace
}  // namespace lacuna
