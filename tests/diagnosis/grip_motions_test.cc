#include "diagnosis/grip_motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/single_frame_columns.h"
#include "prediction/grip_placement.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr int kTurnedFrames = 5;    // at 100 Hz
constexpr double kLastTime = 0.04;  // s

// Writes a bar that is clamped at one end, while a jaw turns the other one about the bar's axis by
// `angle`, rad, until the last frame. Without an angle there is no jaw.
void WriteTurnedBar(const std::filesystem::path& folder, double angle) {
  std::vector<Eigen::Matrix3Xd> markers(kTurnedFrames, BarMarkerPlaces());
  for (int frame = 0; frame < kTurnedFrames; ++frame)  // nothing can be fitted to what is at rest
    markers[static_cast<size_t>(frame)].row(2).array() += 1e-3 * frame;
  WriteBarRecording(folder, markers);
  if (angle == 0) return;
  std::ofstream path(folder / "jaw.csv");
  path << "t,x,y,z,rx,ry,rz\n";
  for (int frame = 0; frame < kTurnedFrames; ++frame)
    path << fmt::format("{},0,0,0,{},0,0\n", 0.01 * frame, angle * frame / (kTurnedFrames - 1));
  std::ofstream(folder / "recording.yaml", std::ios::app)
      << "gripped:\n  - {name: jaw, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}, "
         "path: {file: jaw.csv, time: t, x: x, y: y, z: z, turn: {x: rx, y: ry, z: rz, about: [0 "
         "m, 0 m, 0 m]}}}\n";
}

// The problem of recordings, named after their folders, in slow motion.
struct SlowProblem {
  explicit SlowProblem(const std::vector<std::filesystem::path>& folders) {
    std::string entries;
    for (const std::filesystem::path& folder : folders)
      entries += fmt::format("  - {{recording: {}, name: {}}}\n",
                             (folder / "recording.yaml").string(), folder.filename().string());
    study = ReadPredictionStudy(Config::Parse(
        "schema_version: 1\nname: slow\nmesh: {max_volume: 1000 mm^3, order: 1}\n"
        "material: {law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.4}\n"
        "motion: {scheme: quasi_static, time_step: 10 ms}\nnoise: 0.05 mm\n"
        "place_deviation: 0.2 mm\nfit: {parameters: [{name: poisson_ratio}]}\nrecordings:\n" +
            entries,
        (folders.front() / "study.yaml").string()));
    problem = std::make_unique<const CalibrationProblem>(study, BarMesh({4, 1, 1}, 1));
  }
  LinearisedWithGrips Linearise() const {
    LinearisedWithGrips linearised = LineariseWithGrips(*problem, problem->Start(), {});
    EXPECT_TRUE(linearised.misfit.usable) << linearised.misfit.message;
    return linearised;
  }

  PredictionStudy study;
  std::unique_ptr<const CalibrationProblem> problem;
};

// The columns of all motions in the rows of one recording's points.
Eigen::MatrixXd ColumnsIn(const LinearisedWithGrips& linearised, size_t recording) {
  const LinearisedMisfit::Part& part = linearised.misfit.PointsOf(recording);
  return linearised.OfGrips().middleRows(part.first_row, part.layout.Rows());
}

// A jaw that has turned by 90 degrees, so that y has become z, and z has become -y.
class QuarterTurn : public testing::Test {
 protected:
  QuarterTurn() {
    WriteTurnedBar(folder_ / "a", std::numbers::pi / 2);
    slow_ = std::make_unique<const SlowProblem>(std::vector{folder_ / "a"});
    motions_ = MakeGripMotions(*slow_->problem);
    EXPECT_EQ(motions_.grips.size(), 2u);
    const Model& model = slow_->problem->models().front().model();
    jaw_ = model.grips[1];
    rest_ = model.body->mesh.nodes;
    places_ = rest_(Eigen::all, jaw_.nodes);
    const Eigen::RowVectorXd y = places_.row(1);
    places_.row(1) = -places_.row(2);
    places_.row(2) = y;
    places_.colwise() -= Eigen::Vector3d(places_.rowwise().mean());
  }

  // What a motion of the jaw does to its nodes in the last frame, 3 × nodes.
  Eigen::Matrix3Xd Moved(Eigen::Index motion, const Eigen::VectorXd& reaction) const {
    const Perturbation perturbation =
        motions_.directions[static_cast<size_t>(motion)].perturbation_in(
            slow_->problem->models().front().model());
    const Eigen::VectorXd moved = perturbation.grip(kLastTime, reaction);
    return moved.reshaped(3, rest_.cols())(Eigen::all, jaw_.nodes);
  }

  TemporaryFolder folder_;
  std::unique_ptr<const SlowProblem> slow_;
  GripMotions motions_;
  Grip jaw_;
  Eigen::Matrix3Xd rest_;
  Eigen::Matrix3Xd places_;  // of the jaw's nodes in the last frame, about their mean
};

TEST_F(QuarterTurn, RotatesTheJawWithoutStretchingIt) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Matrix3Xd moved = Moved(motions_.grips[1].rigid + 3 + axis, {});
    EXPECT_GT(moved.norm(), 0.01);
    for (Eigen::Index i = 0; i < moved.cols(); ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        EXPECT_NEAR((moved.col(i) - moved.col(j)).dot(places_.col(i) - places_.col(j)), 0, 1e-12)
            << axis;
  }
}

TEST_F(QuarterTurn, IsPlacedLikeAFittedJaw) {
  constexpr double kStep = 1e-5;
  for (int motion = 0; motion < 6; ++motion) {
    GripPlacement plus, minus;
    (motion < 3 ? plus.shift : plus.turn)[motion % 3] = kStep;
    (motion < 3 ? minus.shift : minus.turn)[motion % 3] = -kStep;
    const Eigen::Matrix3Xd difference = (PlacedGrip(jaw_, rest_, plus).motion(kLastTime) -
                                         PlacedGrip(jaw_, rest_, minus).motion(kLastTime)) /
                                        (2 * kStep);
    const Eigen::Matrix3Xd moved = Moved(motions_.grips[1].rigid + motion, {});
    EXPECT_LT((moved - difference).norm(), 1e-8 * difference.norm()) << motion;
  }
}

TEST_F(QuarterTurn, YieldsToTheMomentAboutWhereItIs) {
  const Eigen::Vector3d force(0.3, -0.2, 0.5);
  Eigen::VectorXd reaction = Eigen::VectorXd::Zero(3 * rest_.cols());
  reaction.segment<3>(3 * jaw_.nodes[1]) = force;
  const Eigen::Vector3d moment = Eigen::Vector3d(places_.col(1)).cross(force);
  const GripMotions::Grip& grip = motions_.grips[1];
  const Eigen::Matrix3Xd shifted = Moved(grip.yielding, reaction);
  const Eigen::Matrix3Xd turned = Moved(grip.yielding + 1, reaction);
  for (Eigen::Index i = 0; i < places_.cols(); ++i) {
    EXPECT_LT((shifted.col(i) + force).norm(), 1e-12);
    EXPECT_LT((turned.col(i) + moment.cross(Eigen::Vector3d(places_.col(i)))).norm(), 1e-12);
  }
  EXPECT_NEAR(grip.force->Value(), force.norm(), 1e-12);
  EXPECT_NEAR(grip.moment->Value(), moment.norm(), 1e-12);
}

// The same jaw turns either way. Its placement is the same error in both recordings, along the
// motion of each.
TEST(GripMotions, OfAJawFollowEachRecording) {
  const TemporaryFolder folder;
  WriteTurnedBar(folder / "a", 0.4);
  WriteTurnedBar(folder / "b", -0.3);
  const LinearisedWithGrips both = SlowProblem({folder / "a", folder / "b"}).Linearise();
  ASSERT_EQ(both.grips.grips.size(), 2u);
  EXPECT_EQ(both.grips.grips[0].label, "grip 1");
  EXPECT_EQ(both.grips.grips[1].label, "grip 2");
  size_t recording = 0;
  for (const std::string name : {"a", "b"}) {
    const Eigen::MatrixXd alone = ColumnsIn(SlowProblem({folder / name}).Linearise(), 0);
    const Eigen::MatrixXd among = ColumnsIn(both, recording++);
    ASSERT_EQ(among.cols(), alone.cols());
    for (Eigen::Index motion = 0; motion < alone.cols(); ++motion) {
      EXPECT_GT(alone.col(motion).norm(), 0) << motion;
      EXPECT_LT((among - alone).col(motion).norm(), 1e-9 * alone.col(motion).norm())
          << name << " " << motion;
    }
  }
}

// Each recording is clamped at another end.
TEST(GripMotions, OfDifferentClampsChangeTheirOwnRecordingsOnly) {
  const TemporaryFolder folder;
  WriteTurnedBar(folder / "a", 0);
  WriteTurnedBar(folder / "b", 0);
  ReplaceInFile(folder / "b" / "recording.yaml", "{point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}",
                "{point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}");
  const LinearisedWithGrips both = SlowProblem({folder / "a", folder / "b"}).Linearise();
  ASSERT_EQ(both.grips.grips.size(), 2u);
  EXPECT_EQ(both.grips.grips[0].label, "the grip of a");
  EXPECT_EQ(both.grips.grips[1].label, "the grip of b");
  for (size_t recording = 0; recording < 2; ++recording) {
    const Eigen::MatrixXd columns = ColumnsIn(both, recording);
    const GripMotions::Grip& own = both.grips.grips[recording];
    const GripMotions::Grip& other = both.grips.grips[1 - recording];
    EXPECT_EQ(own.In(recording), 0u);
    EXPECT_FALSE(other.In(recording).has_value());
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_GT(columns.col(own.rigid + axis).norm(), 0) << axis;
      EXPECT_EQ(columns.col(other.rigid + axis).norm(), 0) << axis;
    }
  }
}

TEST(SingleFrameColumns, AreLimitedInTheirNumberOfEntries) {
  EXPECT_EQ(WhyTooLarge(250'000, 400), "");
  EXPECT_EQ(WhyTooLarge(250'000, 800),
            "the columns for the single frames of all recordings would need 1.6 GB of memory, more "
            "than the 0.8 GB that are allowed: thin the frames out with `every`");
}

// Few frames of very many points.
TEST(SingleFrameColumns, OfTimesAreNotMadeWhereTheyWouldBeTooLarge) {
  const TemporaryFolder folder;
  WriteTurnedBar(folder / "a", 0);
  const SlowProblem slow({folder / "a"});
  LinearisedMisfit misfit = slow.problem->Linearise(slow.problem->Start());
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const auto make = [&] {
    for (const NuisanceEntry& entry : NuisanceCatalogue())
      if (entry.card.name == "time_jitter")
        return std::get<RecordingNuisance>(entry.make)({*slow.problem, misfit, misfit.parts.front(),
                                                        misfit.residual, 0.01,
                                                        Eigen::Vector3d::Zero()});
    return std::optional<NuisanceCandidate>();
  };
  const std::optional<NuisanceCandidate> small = make();
  ASSERT_TRUE(small.has_value());
  EXPECT_EQ(small->columns.cols(), kTurnedFrames);
  EXPECT_EQ(small->untried, "");
  misfit.parts.front().layout.times.resize(300);
  misfit.residual.resize(400'000);
  const std::optional<NuisanceCandidate> large = make();
  ASSERT_TRUE(large.has_value());
  EXPECT_EQ(large->columns.cols(), 0);
  EXPECT_NE(large->untried.find("1.0 GB"), std::string::npos) << large->untried;
}

}  // namespace
}  // namespace lacuna
