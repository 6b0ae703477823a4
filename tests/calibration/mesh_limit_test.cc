#include "calibration/mesh_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "calibration/calibration_fits.h"
#include "calibration/known_errors.h"
#include "calibration/linear_misfit.h"
#include "calibration/parameter_response.h"
#include "calibration/size_errors.h"
#include "calibration/step_errors.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

struct BarFit {
  PredictionStudy study;
  CalibrationProblem problem;
  Calibration calibration;

  BarFit(const std::filesystem::path& folder, const std::string& volume)
      : study(ReadBarStudy(folder, {{"max_volume: 1000 mm^3",
                                     "max_volume: " + volume + ", preserve_surface: false"}})),
        problem(study, MakeReferenceBody(study).mesh) {
    SilentProgress progress;
    calibration = FitFromStart(problem, &progress);
  }
};

KnownErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  SilentProgress progress;
  return FindKnownErrors(problem, values, &progress);
}

// A bar of few elements, fitted to a film of a finer one. What several tests use is computed once.
class MeshLimitOfACoarseBar : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    WriteBarRecording(folder_->Path(), FilmHeldBar({}));
    // Held at its face: a clamp of some depth would reach more nodes of a finer mesh.
    ReplaceInFile(*folder_ / "recording.yaml", "point: [0.002 m", "point: [0.00001 m");
    coarse_ = new BarFit(folder_->Path(), "4000 mm^3");
    misfit_ = new LinearisedMisfit(Problem().Linearise(Values(), {.with_jacobian = true}));
  }
  static void TearDownTestSuite() {
    delete misfit_;
    delete coarse_;
    delete folder_;
  }

  static const std::filesystem::path& Folder() { return folder_->Path(); }
  static const BarFit& Coarse() { return *coarse_; }
  static const CalibrationProblem& Problem() { return coarse_->problem; }
  static const Eigen::VectorXd& Values() { return coarse_->calibration.parameters; }
  static const LinearisedMisfit& MisfitThere() { return *misfit_; }
  static const KnownErrors& Errors() {
    static const KnownErrors errors = ErrorsOf(Problem(), Values());
    return errors;
  }
  static const std::optional<OtherMesh>& Finer() {
    static const std::optional<OtherMesh> finer = MakeOtherMesh(Problem(), Values(), MisfitThere());
    return finer;
  }
  // The residual on that finer mesh with parameters changed by `change`, and the study's steps.
  static Eigen::VectorXd ResidualOnFiner(const Eigen::VectorXd& change) {
    const PredictionStudy study = Problem().WithEstimatedNoise();
    const auto on_finer = WithOtherElements(study, Problem().body()->mesh, kRatio);
    EXPECT_TRUE(on_finer.has_value());
    if (!on_finer) return {};
    EXPECT_EQ(on_finer->ratio, Finer()->ratio);
    return on_finer->problem->Linearise(MovedBy(Problem().parameters(), Values(), change)).residual;
  }

  static constexpr double kRatio = 12;  // that of a mesh with few elements

 private:
  static inline TemporaryFolder* folder_ = nullptr;
  static inline BarFit* coarse_ = nullptr;
  static inline LinearisedMisfit* misfit_ = nullptr;
};

// A coarse mesh is stiff: its modulus is fitted too low.
TEST_F(MeshLimitOfACoarseBar, IsWhatAFinerMeshIsFittedWith) {
  const BarFit fine(Folder(), "400 mm^3");
  const Eigen::VectorXd& limit = Errors().at_mesh_limit;
  ASSERT_EQ(limit.size(), Values().size());
  EXPECT_TRUE(Errors().other_mesh.has_value());
  const double of_fine = fine.calibration.parameters[0], missing = of_fine - Values()[0];
  ParameterEstimate estimate = Coarse().calibration.estimates[0];
  EXPECT_GT(missing, estimate.posterior_deviation * Values()[0]);
  OtherMesh refined;
  refined.ratio = static_cast<double>(fine.problem.body()->ElementCount()) /
                  static_cast<double>(Problem().body()->ElementCount());
  const double share_of_limit = 1 / refined.ToLimit();
  EXPECT_NEAR(share_of_limit * (limit[0] - Values()[0]), missing, 0.25 * missing);
  EXPECT_LT(estimate.high, of_fine);
  WidenIntervalByModelErrors(Problem().parameters()[0], limit[0], Errors().deviation[0], &estimate);
  EXPECT_GT(estimate.high, of_fine) << "an interval that counts the mesh";
  EXPECT_LT(estimate.low, of_fine);
}

// What was found is kept, and where it was kept the finer mesh is not simulated there again.
TEST_F(MeshLimitOfACoarseBar, IsFoundFromWhatWasKept) {
  ASSERT_TRUE(Finer().has_value());
  WriteOtherMesh(*Finer(), Folder());
  auto kept = ReadOtherMesh(Folder());
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->other, Finer()->other);
  const auto from_kept = MakeOtherMesh(Problem(), Values(), MisfitThere(), &*kept);
  ASSERT_TRUE(from_kept.has_value());
  EXPECT_LT((from_kept->other - Finer()->other).norm(),
            0.2 * (Finer()->other - Finer()->own).norm());
  constexpr double kMark = 1e-4;  // m
  kept->other[0] += kMark;
  const auto marked = MakeOtherMesh(Problem(), Values(), MisfitThere(), &*kept);
  ASSERT_TRUE(marked.has_value());
  EXPECT_GT(marked->other[0] - from_kept->other[0], 0.5 * kMark);
}

// With parameters of its own a finer mesh moves as the coarse one does; with the same, it parts.
TEST_F(MeshLimitOfACoarseBar, ComesFromAFinerMeshInPhase) {
  ASSERT_TRUE(Finer().has_value());
  const Eigen::VectorXd before = Problem().Linearise(Values()).residual;
  const Eigen::VectorXd with_the_same =
      ResidualOnFiner(Eigen::VectorXd::Zero(Values().size())) - before;
  const Eigen::VectorXd with_its_own = ResidualOnFiner(Finer()->change) - before;
  const auto length = [&](const Eigen::VectorXd& part) {
    return WhitenedRows(part, MisfitThere()).norm();
  };
  EXPECT_LT(length(with_its_own), 0.5 * length(with_the_same));
  // With long steps on both meshes the difference is nearly the same one.
  EXPECT_LT((Finer()->other - Finer()->own - with_its_own).norm(), 0.3 * with_its_own.norm());
}

TEST_F(MeshLimitOfACoarseBar, ComesFromTheResidualAtItsRatio) {
  ASSERT_TRUE(Finer().has_value());
  const Eigen::VectorXd before = Problem().Linearise(Values()).residual;
  const Eigen::VectorXd again = ResidualAtRatio(Problem(), Values(), *Finer(), kRatio);
  ASSERT_EQ(again.size(), Finer()->other.size());
  // The last step of the search, which may remove half of ‖difference‖², is added to first order.
  EXPECT_LT((again - Finer()->other).norm(), 0.03 * (Finer()->other - Finer()->own).norm());
  EXPECT_EQ(Problem().Linearise(Values()).residual, before)
      << "a prediction depends on nothing that was predicted before it";
}

// The dimensions of the object add a deviation of their own, by the response to each of them.
TEST_F(MeshLimitOfACoarseBar, LeavesTheUncertaintyOfTheDimensions) {
  PredictionStudy measured = Problem().WithEstimatedNoise();
  measured.size_deviation = 0;
  const KnownErrors without =
      ErrorsOf(CalibrationProblem(measured, Problem().body()->mesh), Values());
  const Eigen::MatrixXd by_sizes = ParameterResponse(Problem(), Values(), MisfitThere(), true)
                                       .To(ChangesBySize(Problem(), Values(), MisfitThere()));
  ASSERT_EQ(by_sizes.cols(), 3);
  for (Eigen::Index k = 0; k < Values().size(); ++k) {
    const double scale = Problem().parameters()[k].log_scale ? Values()[k] : 1;
    const double expected = std::hypot(without.deviation[k], by_sizes.row(k).norm() / scale);
    EXPECT_NEAR(Errors().deviation[k], expected, 1e-6 * expected) << k;
  }
}

// Beyond the limit of the mesh, at_limit has the response to infinitely short steps.
TEST_F(MeshLimitOfACoarseBar, IsMovedOnByTheLimitOfTheTimeStep) {
  const auto step = FindStepErrors(Problem(), Values(), MisfitThere());
  ASSERT_TRUE(step.has_value());
  const Eigen::VectorXd change =
      ParameterResponse(Problem(), Values(), MisfitThere(), true).To(step->to_limit);
  ASSERT_EQ(Errors().at_mesh_limit.size(), Values().size());
  for (Eigen::Index k = 0; k < Values().size(); ++k) {
    const double from = Errors().at_mesh_limit[k];
    const bool log_scale = Problem().parameters()[k].log_scale;
    const double expected = log_scale ? from * std::exp(change[k] / Values()[k]) : from + change[k];
    // Rounding, and a millionth of the change.
    EXPECT_NEAR(Errors().at_limit[k], expected,
                1e-12 * std::abs(from) + 1e-6 * std::abs(expected - from))
        << k;
  }
  // Steps of 1.5 ms slow the vibration, so that without them the modulus is another one.
  EXPECT_GT(std::abs(change[0]), 1e-3 * Values()[0]);
}

// How far a fit is from the measurements is that of the fitted frames: they do not become closer
// where others are held out.
TEST(MeshLimit, AFitFarFromTheMeasurementsIsComparedWithAMeshThatIsLessFine) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const BarFit fit(folder.Path(), "4000 mm^3");
  const Eigen::VectorXd& values = fit.calibration.parameters;
  LinearisedMisfit misfit = fit.problem.Linearise(values, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  // 10 of the 26 frames are held out: 3.5 σ in the others would be less than 3 σ if they counted.
  constexpr double kFar = 3.5;
  misfit.residual *= kFar / RmsOverSigma(misfit.residual, misfit, /*fitted_only=*/true);
  const double fitted = WhitenedRows(misfit.residual, misfit, {.fitted_only = true}).norm();
  ASSERT_LT(fitted, kFarFromTruth * std::sqrt(static_cast<double>(ObservedRows(misfit))));
  const auto other = MakeOtherMesh(fit.problem, values, misfit);
  ASSERT_TRUE(other.has_value());
  const PredictionStudy study = fit.problem.WithEstimatedNoise();
  const auto expected = WithOtherElements(study, fit.problem.body()->mesh, 4);
  ASSERT_TRUE(expected.has_value());
  EXPECT_EQ(other->ratio, expected->ratio);
}

// A model that removes all mass somewhere cannot be predicted.
TEST(KnownErrors, SayThatTheyCouldNotBeComputed) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"  - {type: mass_damping, alpha: 1 1/s}",
                       "  - {type: attached_mass, mass: 1 g, centre: [0.08 m, 0 m, 0 m]}"},
                      {"mass_damping.alpha", "attached_mass.mass"}});
  const CalibrationProblem problem(study, MakeReferenceBody(study).mesh);
  ASSERT_EQ(problem.parameters()[1].name, "attached_mass.mass");
  Eigen::VectorXd values = problem.Start();
  values[1] = -1;  // kg
  const KnownErrors errors = ErrorsOf(problem, values);
  EXPECT_EQ(errors.at_limit, values);
  EXPECT_EQ(errors.at_mesh_limit.size(), 0);
  ASSERT_EQ(errors.notes.size(), 1u);
  EXPECT_THAT(errors.notes[0], testing::HasSubstr("attached_mass with a mass of -1 kg removes"));
}

// Of a sheet, which has no other mesh, with exact dimensions: the fitted motion and those with half
// and a quarter of the step are predicted.
TEST(KnownErrors, CountThePredictedFrames) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"noise: 0.05 mm\n", "noise: 0.05 mm\nsize_deviation: 0\n"}});
  study.recordings.front().recording.reference.sheet_thickness = 1e-3;  // m
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  std::ostringstream stream;
  ProgressOptions options;
  options.style = ProgressStyle::kJsonLines;
  options.json_interval = 0;
  options.stream = &stream;
  Progress progress(options);
  progress.Begin("errors", 0);
  FindKnownErrors(problem, problem.Start(), &progress);
  std::vector<int> counts;
  std::istringstream text(stream.str());
  for (std::string line; std::getline(text, line);)
    if (const auto report = nlohmann::json::parse(line); report.at("event") == "progress")
      counts.push_back(report.at("done"));
  std::sort(counts.begin(), counts.end());  // two predictions run side by side
  std::vector<int> expected(3 * kFrames);
  std::iota(expected.begin(), expected.end(), 1);
  EXPECT_EQ(counts, expected);
}

// Richardson's extrapolation from a coarser mesh, which a study of many elements uses.
TEST(OtherMesh, ExtrapolatesFromBothSides) {
  const double power = 0.7;
  const auto at = [&](double ratio) { return 5 + 2 * std::pow(ratio, -power); };
  for (const double ratio : {12.0, 4.0, 0.25}) {
    OtherMesh mesh;
    mesh.ratio = ratio;
    const double change = at(ratio) - at(1);
    EXPECT_NEAR(at(1) + mesh.ToLimit() * change, 5, 1e-12);
    EXPECT_NEAR(at(1) + mesh.ToRatio(0.5) * change, at(0.5), 1e-12);
    EXPECT_NEAR(mesh.ToRatio(ratio), 1, 1e-12);
  }
}

}  // namespace
}  // namespace lacuna
