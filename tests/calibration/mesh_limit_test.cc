#include "calibration/mesh_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "calibration/calibration_fits.h"
#include "calibration/known_errors.h"
#include "calibration/linear_misfit.h"
#include "calibration/parameter_response.h"
#include "calibration/size_errors.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
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

void ReplaceInFile(const std::filesystem::path& file, const std::string& from,
                   const std::string& to) {
  std::string text = FileContent(file);
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(), to);
  std::ofstream(file) << text;
}

TEST(MeshLimit, ACoarseMeshTellsWhatAFinerOneWouldBeFittedWith) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  // Held at its face: a clamp of some depth would reach more nodes of a finer mesh.
  ReplaceInFile(folder / "recording.yaml", "point: [0.002 m", "point: [0.00001 m");
  const BarFit coarse(folder.Path(), "4000 mm^3"), fine(folder.Path(), "400 mm^3");
  const Eigen::VectorXd& values = coarse.calibration.parameters;
  const Eigen::VectorXd before = coarse.problem.Linearise(values, false).residual;
  const KnownErrors errors = FindKnownErrors(coarse.problem, values);
  const Eigen::VectorXd& limit = errors.at_mesh_limit;
  ASSERT_EQ(limit.size(), values.size());
  // A coarse mesh is stiff: its modulus is fitted too low.
  const double missing = fine.calibration.parameters[0] - values[0];
  EXPECT_GT(missing, coarse.calibration.estimates[0].posterior_deviation * values[0]);
  OtherMesh refined;
  refined.ratio = static_cast<double>(fine.problem.body()->ElementCount()) /
                  static_cast<double>(coarse.problem.body()->ElementCount());
  const double share_of_limit = 1 / refined.ToLimit();
  EXPECT_NEAR(share_of_limit * (limit[0] - values[0]), missing, 0.25 * missing);
  ParameterEstimate estimate = coarse.calibration.estimates[0];
  const double of_fine = fine.calibration.parameters[0];
  EXPECT_LT(estimate.high, of_fine);
  CountModelErrors(coarse.problem.parameters()[0], limit[0], errors.deviation[0], &estimate);
  EXPECT_GT(estimate.high, of_fine) << "an interval that counts the mesh";
  EXPECT_LT(estimate.low, of_fine);
  // With parameters of its own a finer mesh moves as the coarse one does; with the same, it parts.
  const LinearisedMisfit misfit = coarse.problem.Linearise(values, /*with_jacobian=*/true);
  const auto finer = MakeOtherMesh(coarse.problem, values, misfit);
  ASSERT_TRUE(finer.has_value());
  // What was found is kept, and where it was kept the finer mesh is not simulated there again.
  ASSERT_TRUE(errors.other_mesh.has_value());
  SaveOtherMesh(*errors.other_mesh, folder.Path());
  auto kept = ReadOtherMesh(folder.Path());
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->other, errors.other_mesh->other);
  const auto from_kept = MakeOtherMesh(coarse.problem, values, misfit, &*kept);
  ASSERT_TRUE(from_kept.has_value());
  EXPECT_LT((from_kept->other - finer->other).norm(), 0.2 * (finer->other - finer->own).norm());
  constexpr double kMark = 1e-4;  // m
  kept->other[0] += kMark;
  const auto marked = MakeOtherMesh(coarse.problem, values, misfit, &*kept);
  ASSERT_TRUE(marked.has_value());
  EXPECT_GT(marked->other[0] - from_kept->other[0], 0.5 * kMark);
  const PredictionStudy study = coarse.problem.WithEstimatedNoise();
  constexpr double kRatio = 12;  // that of a mesh with few elements
  const auto on_finer = WithOtherElements(study, coarse.problem.body()->mesh, kRatio);
  ASSERT_TRUE(on_finer.has_value());
  ASSERT_EQ(on_finer->ratio, finer->ratio);
  const auto part = [&](const Eigen::VectorXd& change) {
    const Eigen::VectorXd there =
        on_finer->problem->Linearise(MovedBy(coarse.problem.parameters(), values, change), false)
            .residual;
    return WhitenedRows(there - before, misfit, 0, false).norm();
  };
  const double with_the_same = part(Eigen::VectorXd::Zero(values.size()));
  EXPECT_LT(part(finer->change), 0.5 * with_the_same);
  // With long steps on both meshes the difference is nearly the same one.
  const Eigen::VectorXd with_steps =
      on_finer->problem
          ->Linearise(MovedBy(coarse.problem.parameters(), values, finer->change), false)
          .residual -
      before;
  EXPECT_LT((finer->other - finer->own - with_steps).norm(), 0.3 * with_steps.norm());
  const Eigen::VectorXd again = ResidualAtRatio(coarse.problem, values, *finer, kRatio);
  ASSERT_EQ(again.size(), finer->other.size());
  // The last step of the search, which may remove half of ‖difference‖², is added to first order.
  EXPECT_LT((again - finer->other).norm(), 0.03 * (finer->other - finer->own).norm());
  EXPECT_EQ(coarse.problem.Linearise(values, false).residual, before)
      << "a prediction depends on nothing that was predicted before it";
  // The dimensions of the object add a deviation of their own, by the response to each of them.
  PredictionStudy measured = study;
  measured.size_deviation = 0;
  const KnownErrors without =
      FindKnownErrors(CalibrationProblem(measured, coarse.problem.body()->mesh), values);
  const Eigen::MatrixXd by_sizes = ParameterResponse(coarse.problem, values, misfit, true)
                                       .To(ChangesBySize(coarse.problem, values, misfit));
  ASSERT_EQ(by_sizes.cols(), 3);
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double scale = coarse.problem.parameters()[k].log_scale ? values[k] : 1;
    const double expected = std::hypot(without.deviation[k], by_sizes.row(k).norm() / scale);
    EXPECT_NEAR(errors.deviation[k], expected, 1e-6 * expected) << k;
  }
}

// How far a fit is from the measurements is that of the fitted frames: they do not become closer
// where others are held out.
TEST(MeshLimit, AFitFarFromTheMeasurementsIsComparedWithAMeshThatIsLessFine) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const BarFit fit(folder.Path(), "4000 mm^3");
  const Eigen::VectorXd& values = fit.calibration.parameters;
  LinearisedMisfit misfit = fit.problem.Linearise(values, /*with_jacobian=*/true);
  ASSERT_TRUE(misfit.usable) << misfit.message;
  // 10 of the 26 frames are held out: 3.5 σ in the others would be less than 3 σ if they counted.
  constexpr double kFar = 3.5;
  misfit.residual *= kFar / RmsOverSigma(misfit.residual, misfit, /*fitted_only=*/true);
  const double fitted = WhitenedRows(misfit.residual, misfit, 0, true).norm();
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
  const KnownErrors errors = FindKnownErrors(problem, values);
  EXPECT_EQ(errors.at_limit, values);
  EXPECT_EQ(errors.at_mesh_limit.size(), 0);
  ASSERT_EQ(errors.notes.size(), 1u);
  EXPECT_THAT(errors.notes[0], testing::HasSubstr("attached_mass with a mass of -1 kg removes"));
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
