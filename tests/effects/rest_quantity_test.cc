#include "effects/rest_quantity.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

// The sum of the settings, and how often it was computed.
class CountedSum {
 public:
  void SetSettings(const Eigen::VectorXd& settings) { sum_.SetSettings(settings); }
  double Of(const Body& body) {
    return *sum_.Of(body, [this](const Body&, const Eigen::VectorXd& settings) {
      ++computations_;
      return settings.sum();
    });
  }
  int computations() const { return computations_; }

 private:
  RestQuantity<double> sum_;
  int computations_ = 0;
};

TEST(RestQuantity, IsComputedAgainWhenItsSettingsChangeAndOnlyThen) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), 1000);
  CountedSum sum;
  sum.SetSettings(Eigen::Vector2d(1, 2));
  EXPECT_EQ(sum.Of(body), 3);
  sum.SetSettings(Eigen::Vector2d(1, 2));
  EXPECT_EQ(sum.Of(body), 3);
  EXPECT_EQ(sum.computations(), 1);

  CountedSum other = sum;
  other.SetSettings(Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(other.Of(body), 6);
  EXPECT_EQ(other.computations(), 2);
  // The quantity that was copied keeps its own settings and value.
  EXPECT_EQ(sum.Of(body), 3);
  EXPECT_EQ(sum.computations(), 1);
}

}  // namespace
}  // namespace lacuna
