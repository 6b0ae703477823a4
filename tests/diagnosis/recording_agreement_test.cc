// Two recordings of a bar, from two pulls, made with finer elements and shorter steps than those of
// the model that is fitted to them.
#include "diagnosis/recording_agreement.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <random>
#include <utility>

#include "calibration/calibration_problem.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/recorded_diagnosis.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "report/verdict_text.h"
#include "support/held_bar.h"
#include "support/silent_fit.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"
#include "support/uniformity.h"

namespace lacuna {
namespace {

constexpr double kMarkerNoise = 5e-5, kPlaceDeviation = 2e-4;  // m
constexpr int kPairs = 60;

// The fit of two recordings, without noise unless it is given, linearised. Noise may be added to
// the residual: it enters linearly. With `alone`, only that recording is fitted.
struct TwoRecordings {
  // The second recording's Young's modulus is `factor` times the first one's.
  explicit TwoRecordings(double factor, std::optional<int> alone = {}, double noise = 0) {
    std::string entries;
    for (int r = 0; r < 2; ++r) {
      HeldBarTruth truth;
      truth.noise = noise;
      if (r == 1) {
        truth.hold_force = {0, -0.03, 0.05};
        truth.young_modulus *= factor;
      }
      const std::filesystem::path recording = folder / fmt::format("recording_{}", r);
      WriteBarRecording(recording, FilmHeldBar(truth));
      if (alone && *alone != r) continue;
      entries += fmt::format(
          "  - recording: {}\n    name: {}\n    fit_until: {} s\n    clock_deviation: 10 ms\n"
          "    hold:\n      region: {{half_space: {{point: [0.078 m, 0 m, 0 m], normal: [1, 0, "
          "0]}}}}\n      release: {} s\n",
          (recording / "recording.yaml").string(), "ab"[r], kFitUntil, kRelease);
    }
    std::string text =
        BarExperiment(folder / "recording_0", {{"order: 2", "order: 2, preserve_surface: false"},
                                               {"{name: mass_damping.alpha}",
                                                "{name: mass_damping.alpha}, "
                                                "{name: poisson_ratio}"}});
    text.replace(text.find("recordings:\n"), std::string::npos, "recordings:\n" + entries);
    study = ReadPredictionStudy(Config::Parse(text, (folder / "study.yaml").string()));
    mesh = MakeReferenceBody(study).mesh;
    problem.emplace(study, mesh);
    values = FitSilently(*problem).parameters;
    LinearisedWithGrips linearised = LineariseWithGrips(*problem, values, {});
    const Eigen::MatrixXd grip_columns = linearised.OfGrips();
    misfit = std::move(linearised.misfit);
    shared.columns.resize(misfit.residual.size(), 0);
    for (const NuisanceCandidate& nuisance :
         ModelNuisances({*problem, values, misfit, linearised.grips, grip_columns}))
      if (nuisance.card.is_always_in_model) shared = shared.And(nuisance);
  }

  AgreementRecord Compare(const LinearisedMisfit& with_noise) const {
    return CompareRecordings(*problem, values, with_noise, shared, {0, 1});
  }
  // The comparison of one draw of the noise and of the errors of the markers' places, which are the
  // same in both recordings.
  AgreementRecord Draw(std::mt19937* random) const {
    std::normal_distribution<double> normal;
    Eigen::Matrix3Xd places(3, kMarkers);
    for (double& error : places.reshaped()) error = kPlaceDeviation * normal(*random);
    LinearisedMisfit drawn = misfit;
    for (const LinearisedMisfit::Part& part : drawn.parts)
      for (size_t at = 0; at < part.layout.deformation.size(); ++at) {
        auto row = drawn.residual.segment<3>(part.first_row + 3 * static_cast<Eigen::Index>(at));
        row -= part.layout.deformation[at] * places.col(static_cast<Eigen::Index>(at % kMarkers));
        for (double& coordinate : row) coordinate -= kMarkerNoise * normal(*random);
      }
    return Compare(drawn);
  }

  TemporaryFolder folder;
  PredictionStudy study;
  TetMesh mesh;
  std::optional<CalibrationProblem> problem;
  Eigen::VectorXd values;
  LinearisedMisfit misfit;
  AdoptedNuisances shared;
};

TEST(RecordingAgreement, HasUniformPValuesWhereRecordingsShareEverything) {
  const TwoRecordings pair(1);
  std::mt19937 random(3);
  std::vector<double> all, of_modulus;
  for (int draw = 0; draw < kPairs; ++draw) {
    const AgreementRecord record = pair.Draw(&random);
    ASSERT_EQ(record.degrees_of_freedom, 3);
    all.push_back(record.p_value);
    of_modulus.push_back(record.parameters.front().p_value);
  }
  EXPECT_GT(UniformityOf(all), 0.01);
  EXPECT_GT(UniformityOf(of_modulus), 0.01);
}

TEST(RecordingAgreement, NamesTheParameterThatDiffers) {
  const TwoRecordings same(1);
  const AgreementRecord agreement = same.Compare(same.misfit);
  const ParameterOfRecordings& modulus = agreement.parameters.front();
  ASSERT_EQ(modulus.name, "young_modulus");
  // Three standard deviations of the difference of both estimates.
  const double apart =
      3 * std::hypot(modulus.deviations[0], modulus.deviations[1]) / modulus.values[0];
  const TwoRecordings pair(1 + apart);
  std::mt19937 random(5);
  int named = 0, found = 0;
  for (int draw = 0; draw < kPairs; ++draw) {
    const AgreementRecord record = pair.Draw(&random);
    named += record.MostDifferent()->name == "young_modulus" ? 1 : 0;
    found += record.Disagree() ? 1 : 0;
  }
  RecordProperty("named", named);
  RecordProperty("found", found);
  EXPECT_GE(named, 0.9 * kPairs);
  // A normal variable with the mean 3 exceeds 1.96 in 85 %; the test of three parameters together
  // has less power, the correlation of the estimates adds to it.
  EXPECT_GE(found, 0.6 * kPairs);
}

// What is estimated from the linearised joint fit is what a fit to one recording finds.
TEST(RecordingAgreement, EstimatesWhatAFitToOneRecordingFinds) {
  const TwoRecordings pair(1.01);
  // The fits know of no error of the mesh, the step or the dimensions.
  AdoptedNuisances none;
  none.columns.resize(pair.misfit.residual.size(), 0);
  const AgreementRecord together =
      CompareRecordings(*pair.problem, pair.values, pair.misfit, none, {0, 1});
  for (int r = 0; r < 2; ++r) {
    const TwoRecordings alone(1.01, r);
    for (size_t k = 0; k < together.parameters.size(); ++k) {
      const ParameterOfRecordings& parameter = together.parameters[k];
      EXPECT_NEAR(parameter.values[static_cast<size_t>(r)],
                  alone.values[static_cast<Eigen::Index>(k)],
                  0.5 * parameter.deviations[static_cast<size_t>(r)])
          << parameter.name;
    }
  }
}

// A model whose parameters may differ is a hypothesis beside the effects.
TEST(RecordingAgreement, IsWeighedAgainstTheEffects) {
  const TwoRecordings pair(1.08, {}, kMarkerNoise);
  SilentProgress progress;
  DiagnosisOptions options;
  options.refits = 2;
  const Diagnosis diagnosis = Diagnose(*pair.problem, pair.values, options, &progress);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, testing::Contains("recordings_differ"));
  EXPECT_TRUE(diagnosis.agreement.Disagree()) << "although the model has the nuisance";
}

TEST(RecordingAgreement, HasColumnsOfEachRecording) {
  const TwoRecordings pair(1);
  const std::vector<NuisanceCandidate> nuisances = ModelNuisances(
      {*pair.problem, pair.values, pair.misfit, GripMotions{}, Eigen::MatrixXd()}, {});
  const auto differ = std::find_if(nuisances.begin(), nuisances.end(), [](const auto& nuisance) {
    return nuisance.card.name == "recordings_differ";
  });
  ASSERT_NE(differ, nuisances.end());
  ASSERT_EQ(differ->columns.cols(), 6);
  const Eigen::MatrixXd of_both = pair.misfit.jacobian.leftCols(3);
  const Eigen::MatrixXd of_first = differ->columns.leftCols(3),
                        of_second = differ->columns.rightCols(3);
  EXPECT_EQ(of_first + of_second, of_both);
  const Eigen::Index second = pair.misfit.parts.back().first_row;
  EXPECT_EQ(of_first.topRows(second), of_both.topRows(second));
  EXPECT_TRUE(of_first.bottomRows(of_first.rows() - second).isZero(0));
  EXPECT_EQ(differ->priors[0].deviation, 0.2 * pair.values[0]);
}

TEST(RecordingAgreement, NeedsTwoFittedRecordings) {
  const TwoRecordings alone(1, 0);
  const AgreementRecord record = alone.Compare(alone.misfit);
  EXPECT_FALSE(record.Exists());
  EXPECT_FALSE(record.Disagree());
}

}  // namespace
}  // namespace lacuna
