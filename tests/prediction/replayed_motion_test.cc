#include "prediction/replayed_motion.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "support/held_bar.h"
#include "support/scanned_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Scans of a bar at rest and a model of it that bends under its weight: what both see is compared
// in the same way, whichever of the two functions predicts.
TEST(ReplayedMotion, ComparesScansAsAFitDoes) {
  const TemporaryFolder folder;
  const TriMesh rest = MakeBody(BarMesh({2, 1, 1}, 1), 1000).boundary.surface;
  WriteBarScans(folder.Path(), std::vector<TriMesh>(kScans, rest),
                "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, "
                "0]}}]\nreference: {from: mesh, file: box.off}\n");
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"young_modulus: 0.15 MPa", "young_modulus: 1 MPa"},
                      {"motion: {time_step: 1.5 ms}", "motion: {time_step: 4 ms}"},
                      {"    fit_until: 0.1501 s\n",
                       "    to: 0.1001 s\n"
                       "    registration: {shift_deviation: 1 mm, turn_deviation: 1 deg}\n"}});
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
  const RecordingModel& model = problem.models()[0];
  Eigen::VectorXd nuisance(static_cast<Eigen::Index>(model.nuisances().size()));
  std::vector<MisfitDirection> directions;
  for (const RecordingModel::Nuisance& entry : model.nuisances()) {
    const std::string& name = entry.prior.name;
    double& value = nuisance[static_cast<Eigen::Index>(directions.size())];
    value = 0;
    if (name == "bar.hold_force_y") value = 0.02;  // N
    if (name == "bar.clock") value = 0.001;        // s
    if (name == "bar.shift_x") value = 2e-4;       // m
    if (name == "bar.turn_z") value = 0.005;
    directions.push_back(entry.direction);
  }
  ASSERT_EQ((nuisance.array() != 0).count(), 4);
  const std::vector<int>& frames = model.recording().frames;
  const Misfit expected = model.Predict(frames, nuisance, directions);
  const ReplayedMotion motion = Replay(model, nuisance);
  ASSERT_TRUE(expected.summary.IsUsable()) << expected.summary.message;
  ASSERT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
  EXPECT_EQ(motion.misfit.frames, frames);
  EXPECT_EQ(motion.misfit.count, expected.count);
  // Rounding, in m, m/s and m per rad.
  constexpr double kRounding = 1e-9;
  EXPECT_LT((motion.misfit.residual - expected.residual).lpNorm<Eigen::Infinity>(), kRounding);
  EXPECT_GT(expected.residual.lpNorm<Eigen::Infinity>(), 1e-4);
  ASSERT_EQ(motion.misfit.jacobian.cols(), expected.jacobian.cols());
  for (size_t k = 0; k < directions.size(); ++k) {
    const Eigen::VectorXd column = motion.misfit.jacobian.col(static_cast<Eigen::Index>(k));
    const Eigen::VectorXd of_fit = expected.jacobian.col(static_cast<Eigen::Index>(k));
    EXPECT_GT(of_fit.norm(), 0) << k;
    if (directions[k].IsSimulated())
      EXPECT_EQ(column.norm(), 0) << k;
    else
      EXPECT_LT((column - of_fit).lpNorm<Eigen::Infinity>(), kRounding) << k;
  }
  // The centres of the patches hang down with the bar, by about 1 mm on average.
  const Eigen::Index last = motion.height.cols() - 1;
  const double sag = model.observer().Places().row(2).mean() - motion.height.col(last).mean();
  EXPECT_GT(sag, 1e-4);
  EXPECT_LT(sag, 5e-3);
  EXPECT_GT(motion.strain.col(last).maxCoeff(), 1e-3);
  EXPECT_TRUE(motion.up_from_gravity);
}

// Registration turns the deformation gradients of the markers with their positions: F becomes RF.
TEST(ReplayedMotion, RegistersTheDeformationOnce) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"motion: {time_step: 1.5 ms}", "motion: {time_step: 4 ms}"},
                      {"    fit_until: 0.1501 s\n",
                       "    to: 0.1001 s\n"
                       "    registration: {shift_deviation: 1 mm, turn_deviation: 1 deg}\n"}});
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  const RecordingModel& model = problem.models()[0];
  Eigen::VectorXd nuisance =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.nuisances().size()));
  const ReplayedMotion in_place = Replay(model, nuisance);
  for (size_t k = 0; k < model.nuisances().size(); ++k)
    if (model.nuisances()[k].prior.name == "bar.turn_z")
      nuisance[static_cast<Eigen::Index>(k)] = 0.5;
  const ReplayedMotion turned = Replay(model, nuisance);
  ASSERT_TRUE(turned.summary.IsUsable()) << turned.summary.message;
  const Eigen::Matrix3d expected =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  ASSERT_TRUE(turned.registration.linear().isApprox(expected, 1e-12));
  const std::vector<Eigen::Matrix3d>& before = in_place.misfit.deformation;
  const std::vector<Eigen::Matrix3d>& after = turned.misfit.deformation;
  ASSERT_EQ(after.size(), before.size());
  ASSERT_EQ(after.size(), model.recording().frames.size() * model.PointCount());
  for (size_t k = 0; k < after.size(); ++k)
    EXPECT_TRUE(after[k].isApprox(expected * before[k], 1e-9)) << k;
}

}  // namespace
}  // namespace lacuna
