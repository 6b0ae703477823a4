#include "diagnosis/projected_hypotheses.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

constexpr int kDrag = SyntheticSpace::kBase, kMassDamping = kDrag + 1;
constexpr double kPrior = 20;  // SyntheticSpace

// Drag and mass damping, alike or opposed, both positive, and both at once as one more hypothesis.
struct TwoPositive {
  explicit TwoPositive(double alikeness, bool is_opposed = false) : synthetic(alikeness) {
    if (is_opposed) synthetic.columns.col(kMassDamping) *= -1;
    for (const int column : {kDrag, kMassDamping})
      synthetic.priors[static_cast<size_t>(column)].positive = true;
    WeighedHypothesis& both = synthetic.hypotheses.emplace_back();
    both.name = "drag with mass_damping";
    both.columns = {kDrag, kMassDamping};
  }
  size_t Both() const { return synthetic.hypotheses.size() - 1; }
  // The residual of noise if these amounts are missing.
  Eigen::VectorXd Missing(double drag, double mass_damping) const {
    return SyntheticSpace::Noise(2) - drag * synthetic.columns.col(kDrag) -
           mass_damping * synthetic.columns.col(kMassDamping);
  }

  SyntheticSpace synthetic;
};

// The untruncated posterior of both amounts, from the rows of the recording.
struct Posterior {
  Posterior(const TwoPositive& two, const Eigen::VectorXd& residual) {
    const Eigen::MatrixXd columns = two.synthetic.columns.leftCols(kMassDamping + 1);
    Eigen::MatrixXd precision = columns.transpose() * columns;
    precision.diagonal().tail<2>().array() += 1 / (kPrior * kPrior);
    const Eigen::MatrixXd inverse = precision.inverse();
    mean = -(inverse * columns.transpose() * residual).tail<2>();
    covariance = inverse.bottomRightCorner<2, 2>();
  }
  // (x − mean)ᵀ covariance⁻¹ (x − mean)
  double Distance(const Eigen::Vector2d& x) const {
    return (x - mean).dot(covariance.inverse() * (x - mean));
  }

  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

Eigen::Vector2d AmountsOfBoth(const TwoPositive& two, const Eigen::VectorXd& residual) {
  const HypothesisSpace space = two.synthetic.With(residual);
  const ProjectedHypotheses beside(space);
  return beside.AmountsOf(two.Both(), beside.Project(space.model.toward())).value;
}

// The truncation of both priors changes the evidence by 4 P, where P is the share of the posterior
// in which both amounts are positive.
TEST(ProjectedHypotheses, TruncatesTwoPositiveAmountsTogether) {
  for (const bool is_opposed : {false, true}) {
    TwoPositive two(0.3, is_opposed);
    const Eigen::VectorXd residual = two.Missing(3, 1);
    const auto factor = [&] {
      const HypothesisSpace space = two.synthetic.With(residual);
      return ProjectedHypotheses(space).FactorsOfResidual()[static_cast<Eigen::Index>(two.Both())];
    };
    const double truncated = factor();
    for (LinearPrior& prior : two.synthetic.priors) prior.positive = false;
    const double whole = factor();

    const Posterior posterior(two, residual);
    const Eigen::Matrix2d root = posterior.covariance.llt().matrixL();
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    constexpr int kDraws = 400000;
    int positive = 0;
    for (int k = 0; k < kDraws; ++k) {
      const double first = normal(random), second = normal(random);
      const Eigen::Vector2d x = posterior.mean + root * Eigen::Vector2d(first, second);
      positive += x[0] > 0 && x[1] > 0;
    }
    ASSERT_GT(positive, kDraws / 100);
    EXPECT_NEAR(truncated - whole, std::log(4.0 * positive / kDraws), 4 / std::sqrt(positive));
  }
}

// Mass damping would be negative. Drag, which is alike, then takes the place of both.
TEST(ProjectedHypotheses, MovesOneAmountBesideAnotherThatIsZero) {
  const TwoPositive two(0.3);
  const Eigen::VectorXd residual = two.Missing(30, -15);
  const Posterior posterior(two, residual);
  ASSERT_LT(posterior.mean[1], -5);
  const Eigen::Vector2d amounts = AmountsOfBoth(two, residual);
  EXPECT_EQ(amounts[1], 0);
  const double alone = posterior.mean[0] -
                       posterior.covariance(0, 1) / posterior.covariance(1, 1) * posterior.mean[1];
  EXPECT_NEAR(amounts[0], alone, 1e-9 * alone);
  EXPECT_LT(amounts[0], 0.8 * posterior.mean[0]);
}

// Both would be negative. With opposed columns, an amount rises where the other one is set to 0.
TEST(ProjectedHypotheses, FindsTheLargestDensityWhereBothAmountsWouldBeNegative) {
  const struct {
    bool is_opposed;
    double drag, mass_damping;
  } cases[] = {{false, -8, -8}, {true, -15, -15}, {true, -15, -30}, {true, -30, -15}};
  for (const auto& one : cases) {
    const TwoPositive two(0.3, one.is_opposed);
    const Eigen::VectorXd residual = two.Missing(one.drag, one.mass_damping);
    const Posterior posterior(two, residual);
    ASSERT_LT(posterior.mean.maxCoeff(), 0);
    const Eigen::Vector2d amounts = AmountsOfBoth(two, residual);
    EXPECT_GE(amounts.minCoeff(), 0);
    double least = std::numeric_limits<double>::infinity();
    constexpr double kStep = 0.05;
    Eigen::Vector2d best;
    for (int j = 0; j < 400; ++j)
      for (int k = 0; k < 400; ++k) {
        const Eigen::Vector2d at(kStep * j, kStep * k);
        const double distance = posterior.Distance(at);
        if (distance >= least) continue;
        least = distance;
        best = at;
      }
    EXPECT_LT((amounts - best).cwiseAbs().maxCoeff(), kStep)
        << amounts.transpose() << " instead of " << best.transpose();
    EXPECT_LE(posterior.Distance(amounts), least * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace lacuna
