// Markers on a made-up bar, in a first frame that shows them elsewhere than at their places.
#include "prediction/place_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace lacuna {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr ExpectedPlaces kHeld{1e-4, true};

// 3 × 8, m, on four sides of a bar of 70 mm × 20 mm × 20 mm.
Eigen::Matrix3Xd PlacesOnBar() {
  Eigen::Matrix3Xd places(3, 8);
  places << 10, 20, 30, 40, 50, 60, 25, 55,  //
      0, 20, 10, 10, 0, 20, 5, 15,           //
      10, 10, 0, 20, 5, 15, 20, 0;
  return 1e-3 * places;
}

std::string DoubtAbout(const Eigen::Matrix3Xd& measured, const ExpectedPlaces& expected = kHeld) {
  return DoubtOfPlaces(PlacesOnBar(), measured, {"m0", "m1", "m2", "m3", "m4", "m5", "m6", "m7"},
                       expected);
}

// The bar, held at x = 0, bent downwards as by its weight: the tip by `sag`, m.
Eigen::Matrix3Xd Bent(double sag) {
  constexpr double kLength = 0.07;
  Eigen::Matrix3Xd bent = PlacesOnBar();
  for (auto place : bent.colwise()) {
    const double s = place.x() / kLength, height = place.z() - 0.01;
    const double slope = sag / kLength * (4 * s - 4 * s * s + 4.0 / 3 * s * s * s);
    place.z() -= sag * (6 * s * s - 4 * s * s * s + s * s * s * s) / 3;
    place.x() += std::sin(slope) * height;
  }
  return bent;
}

TEST(DoubtOfPlaces, IsNotRaisedByDeformation) {
  EXPECT_EQ(DoubtAbout(PlacesOnBar()), "");
  for (const double sag : {0.005, 0.02, 0.04}) EXPECT_EQ(DoubtAbout(Bent(sag)), "") << sag;
  const Eigen::Matrix3Xd swollen = 1.4 * PlacesOnBar();
  EXPECT_EQ(DoubtAbout(swollen), "");
}

TEST(DoubtOfPlaces, NamesExchangedMarkers) {
  Eigen::Matrix3Xd measured = Bent(0.005);
  measured.col(3).swap(measured.col(4));
  EXPECT_THAT(DoubtAbout(measured),
              HasSubstr("m3 is near the place of m4, m4 is near the place of m3: names or places"));
  // Within the accuracy of the places they may be anywhere.
  EXPECT_EQ(DoubtAbout(measured, {0.005, true}), "");
}

TEST(DoubtOfPlaces, NamesAnotherUnit) {
  EXPECT_THAT(DoubtAbout(0.1 * Bent(0.005)), HasSubstr("multiplied by 10, "));
  EXPECT_THAT(DoubtAbout(25.4 * Bent(0.005)), HasSubstr("multiplied by 0.03937, "));
}

TEST(DoubtOfPlaces, NamesAMirroredSystem) {
  Eigen::Matrix3Xd measured = Bent(0.003);
  measured.row(2) = 0.02 - measured.row(2).array();
  EXPECT_THAT(DoubtAbout(measured, {1e-4, false}),
              AllOf(HasSubstr("mirror image"), HasSubstr("are x, y, −z of the tracks")));
}

TEST(DoubtOfPlaces, NamesATurnedSystemWhereTheObjectCannotTurn) {
  Eigen::Matrix3Xd measured = PlacesOnBar();
  measured.row(1).swap(measured.row(2));
  measured.row(2) *= -1;
  EXPECT_THAT(DoubtAbout(measured),
              AllOf(HasSubstr("turned by 90°"), HasSubstr("are x, −z, y of the tracks")));
  EXPECT_EQ(DoubtAbout(measured, {1e-4, false}), "");
}

TEST(DoubtOfPlaces, PassesOverMarkersThatAreNotSeen) {
  Eigen::Matrix3Xd measured = 0.1 * PlacesOnBar();
  measured.col(0).setConstant(std::nan(""));
  EXPECT_THAT(DoubtAbout(measured), AllOf(HasSubstr("by 10, "), Not(HasSubstr("m0"))));
  measured.setConstant(std::nan(""));
  EXPECT_EQ(DoubtAbout(measured), "");
}

}  // namespace
}  // namespace lacuna
