#include "analysis/agreement.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "analysis/whiteness.h"
#include "support/uniformity.h"

namespace lacuna {
namespace {

constexpr int kAgreementRows = 60, kParameters = 3, kOwn = 2, kShared = 2;

// Recordings whose rows depend on their parameters, own amounts and shared amounts linearly.
class LinearRecordings {
 public:
  LinearRecordings(int count, unsigned seed) : random_(seed), rows_(static_cast<size_t>(count)) {
    for (RecordingRows& rows : rows_) {
      rows.parameters = Random(kAgreementRows, kParameters);
      rows.own = Random(kAgreementRows, kOwn);
      rows.own_priors.assign(kOwn, {0, 0.5, false});
      rows.shared = Random(kAgreementRows, kShared);
    }
  }
  // The test of one draw, in which parameter `k` of recording `which` differs by `apart`.
  AgreementTest Draw(double apart = 0, Eigen::Index k = 0, size_t which = 0,
                     double model_error = 0) {
    const Eigen::VectorXd common = Random(kParameters, 1);
    const Eigen::VectorXd shared = Random(kShared, 1);
    for (size_t i = 0; i < rows_.size(); ++i) {
      RecordingRows& rows = rows_[i];
      Eigen::VectorXd truth = common;
      if (i == which) truth[k] += apart;
      rows.residual = Random(kAgreementRows, 1) - rows.parameters * truth -
                      0.5 * rows.own * Random(kOwn, 1) - rows.shared * shared;
    }
    return TestAgreement(rows_, std::vector<LinearPrior>(kShared, {0, 1, false}),
                         Eigen::VectorXd::Ones(kParameters), 1, model_error);
  }
  std::vector<RecordingRows>& rows() { return rows_; }

 private:
  Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal_(random_); });
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<RecordingRows> rows_;
};

// The same draw, judged with and without an error of the model.
TEST(Agreement, LeavesDifferencesToAnErrorOfTheModel) {
  const auto judged = [](double model_error) {
    return LinearRecordings(2, 5).Draw(3, 1, 0, model_error);
  };
  const AgreementTest exact = judged(0), doubtful = judged(2), hopeless = judged(100);
  ASSERT_LT(exact.p_value, 0.01);
  EXPECT_NEAR(std::sqrt(doubtful.chi_square), std::sqrt(exact.chi_square) - 2, 1e-12);
  EXPECT_GT(doubtful.p_value, exact.p_value);
  EXPECT_GT(doubtful.p_values[1], exact.p_values[1]);
  EXPECT_EQ(hopeless.chi_square, 0);
  EXPECT_EQ(hopeless.p_value, 1);
  EXPECT_EQ(hopeless.p_values[1], 1);
}

TEST(Agreement, HasUniformPValuesWhereOnlyChanceDiffers) {
  for (const int count : {2, 3}) {
    LinearRecordings recordings(count, 5);
    std::vector<double> all, of_second;
    for (int draw = 0; draw < 400; ++draw) {
      const AgreementTest test = recordings.Draw();
      EXPECT_EQ(test.degrees_of_freedom, kParameters * (count - 1));
      all.push_back(test.p_value);
      of_second.push_back(test.p_values[1]);
    }
    EXPECT_GT(UniformityOf(all), 0.01) << count;
    EXPECT_GT(UniformityOf(of_second), 0.01) << count;
  }
}

// Without them in the covariance, the estimates would differ by less than expected.
TEST(Agreement, DoesNotCountErrorsThatAllRecordingsShare) {
  LinearRecordings recordings(2, 7);
  // The shared errors act like the parameters.
  for (RecordingRows& rows : recordings.rows()) rows.shared = 3 * rows.parameters.leftCols(kShared);
  std::vector<double> all;
  for (int draw = 0; draw < 400; ++draw) all.push_back(recordings.Draw().p_value);
  EXPECT_GT(UniformityOf(all), 0.01);
}

TEST(Agreement, NamesTheParameterAndTheRecordingThatDiffer) {
  LinearRecordings recordings(3, 9);
  int named = 0, placed = 0;
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    const AgreementTest test = recordings.Draw(1, 2, 1);  // about 5 standard deviations
    Eigen::Index parameter = 0, recording = 0;
    test.p_values.minCoeff(&parameter);
    test.odd.row(2).maxCoeff(&recording);
    named += parameter == 2 && test.p_value < 0.05 ? 1 : 0;
    placed += recording == 1 ? 1 : 0;
    EXPECT_NEAR(test.change(2, 1) - test.change(2, 0), 1, 1.2);
  }
  EXPECT_GE(named, 0.95 * kDraws);
  EXPECT_GE(placed, 0.95 * kDraws);
}

TEST(Agreement, ComparesOnlyWhatEachRecordingDetermines) {
  LinearRecordings recordings(2, 11);
  recordings.rows()[1].parameters.col(0).setZero();
  std::vector<double> all;
  for (int draw = 0; draw < 200; ++draw) {
    const AgreementTest test = recordings.Draw();
    EXPECT_EQ(test.degrees_of_freedom, 2);
    EXPECT_EQ(test.deviation(0, 1), std::numeric_limits<double>::infinity());
    EXPECT_LT(test.deviation(0, 0), 0.5);
    EXPECT_EQ(test.p_values[0], 1);
    all.push_back(test.p_value);
  }
  EXPECT_GT(UniformityOf(all), 0.01);
}

}  // namespace
}  // namespace lacuna
