#include "diagnosis/extended_experiment.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <variant>

#include "calibration/prior_conflicts.h"
#include "diagnosis/candidates.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/model_change.h"
#include "diagnosis/rank_effects.h"
#include "effects/catalogue.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// Fits the bar's study without its damping; `more` are further keys of the experiment.
std::filesystem::path FitBar(const std::filesystem::path& folder, const std::string& more = "") {
  WriteBarRecording(folder, FilmHeldBar({}));
  std::ofstream(folder / "bar.yaml") << BarExperiment(
      folder, {{"name: bar", "name: bar\noutput: runs/bar" + more},
               {"max_volume: 1000 mm^3", "max_volume: 2000 mm^3, preserve_surface: false"},
               {"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
               {", {name: mass_damping.alpha}", ""}});
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "bar.yaml"));
  SilentProgress progress;
  EXPECT_TRUE(RunCalibration(study, &progress).usable);
  return study.output;
}

TEST(ExtendedExperiment, StartsFromTheFitWithOneMoreEffect) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBar(folder.Path());
  FittedRun fitted = OpenRun(run);
  EXPECT_EQ(fitted.study.effects.front()->Parameters()[0], fitted.values[0]) << "as it was fitted";
  std::vector<std::string> held;
  for (const HeldParameter& parameter : fitted.record.held) held.push_back(parameter.name);
  EXPECT_THAT(held, ::testing::ElementsAre("density", "poisson_ratio", "gravity.acceleration"));
  CalibratedParameter& modulus = fitted.study.fitted[0].prior;  // as another measurement has it
  ASSERT_TRUE(modulus.log_scale);
  modulus.prior_mean = 1.4e5;
  modulus.prior_deviation = 0.05;
  modulus.has_default_prior = false;

  ScoredEffect scored;
  const Body body = MakeBody(fitted.mesh, 1000);
  for (const CandidateEffect& candidate : MakeCandidates(
           {body, fitted.study.effects, ScaleOf(fitted.study), fitted.study.time_step, 0.25}))
    if (candidate.type == "mass_damping") scored.candidate = candidate;
  ASSERT_NE(scored.candidate.effect, nullptr);
  scored.score.size = Eigen::VectorXd::Constant(1, 2.5);
  scored.score.evidence = 40;
  fitted.study.explained_misfit = 20;

  const std::filesystem::path file = WriteExtendedExperiment(fitted, run, scored);
  EXPECT_EQ(file.filename(), "bar+mass_damping.yaml");
  const PredictionStudy extended = ReadPredictionStudy(Config::Load(file));
  EXPECT_EQ(extended.output.filename(), "bar+mass_damping");
  ASSERT_EQ(extended.effects.size(), fitted.study.effects.size() + 1);
  EXPECT_EQ(extended.effects.front()->Parameters(), fitted.study.effects.front()->Parameters());
  EXPECT_EQ(extended.effects.back()->Parameters()[0], 2.5);
  ASSERT_EQ(extended.fitted.size(), 2u);
  EXPECT_EQ(extended.fitted[0].prior.prior_mean, modulus.prior_mean);
  EXPECT_FALSE(extended.fitted[0].prior.has_default_prior);
  EXPECT_NEAR(extended.fitted[0].prior.prior_deviation, modulus.prior_deviation, 1e-12);
  const CalibratedParameter &alpha = extended.fitted[1].prior,
                            expected = WithEffect(fitted.study, scored).fitted[1].prior;
  EXPECT_EQ(alpha.name, "mass_damping.alpha");
  // The prior is that of the refits of a diagnosis, not the start of this fit.
  EXPECT_EQ(expected.prior_mean, 0);
  EXPECT_EQ(alpha.prior_mean, expected.prior_mean);
  EXPECT_EQ(alpha.prior_deviation, expected.prior_deviation);
  EXPECT_EQ(alpha.max, expected.max);
  EXPECT_EQ(extended.recordings.size(), fitted.study.recordings.size());
  EXPECT_EQ(extended.explained_misfit, 100);
  // Where the effect was refitted, the experiment starts from all values of the refit.
  scored.baseline_values = Eigen::VectorXd::Constant(1, 1.1e5);
  const PredictionStudy refitted =
      ReadPredictionStudy(Config::Load(WriteExtendedExperiment(fitted, run, scored)));
  EXPECT_EQ(refitted.effects.front()->Parameters()[0], 1.1e5);
  EXPECT_EQ(refitted.effects.back()->Parameters()[0], 2.5);
}

// Mass damping as one of two laws of the user: it has the same score as that of the catalogue, and
// the experiment that adds it keeps the other law as a candidate.
TEST(ExtendedExperiment, ALawOfTheUsersOwnIsRankedAndAddedLikeTheCatalogues) {
  const TemporaryFolder folder;
  const ParameterCard& alpha = FindEntry("mass_damping")->card->parameters[0];
  const std::string damping = fmt::format(
      "{{type: expression, name: my_damping, per: mass, force: [-k*vx, -k*vy, -k*vz], parameters: "
      "{{k: {{value: 1 1/s, plausible: [{} 1/s, {} 1/s], min: {} 1/s}}}}}}",
      alpha.plausible_min, alpha.plausible_max, alpha.bounds.min);
  const std::string push =
      "{type: expression, name: push, per: mass, force: [a, 0, 0], parameters: "
      "{a: {value: 1 m/s^2, plausible: [-9 m/s^2, 9 m/s^2]}}}";
  const std::filesystem::path run =
      FitBar(folder.Path(), "\ncandidates:\n  - " + damping + "\n  - " + push);
  const FittedRun fitted = OpenRun(run);
  SilentProgress progress;
  const EffectRanking ranking =
      RankEffects(CalibrationProblem(fitted.study, fitted.mesh), fitted.values, &progress);
  const auto scored = [&](const std::string& type) {
    const auto found =
        std::find_if(ranking.effects.begin(), ranking.effects.end(),
                     [&](const ScoredEffect& effect) { return effect.candidate.type == type; });
    EXPECT_NE(found, ranking.effects.end()) << type;
    return *found;
  };
  const ScoredEffect own = scored("my_damping"), built_in = scored("mass_damping");
  EXPECT_GT(own.score.evidence, 5);
  EXPECT_NEAR(own.score.evidence, built_in.score.evidence, 1e-3 * built_in.score.evidence);
  EXPECT_NEAR(own.score.size[0], built_in.score.size[0], 1e-3 * built_in.score.size[0]);
  EXPECT_LT(scored("push").score.evidence, own.score.evidence);

  const std::filesystem::path file = WriteExtendedExperiment(fitted, run, own);
  EXPECT_EQ(file.filename(), "bar+my_damping.yaml");
  const PredictionStudy extended = ReadPredictionStudy(Config::Load(file));
  EXPECT_EQ(extended.effects.back()->Card().title, "my_damping, a user-defined force law");
  EXPECT_EQ(extended.effects.back()->Parameters()[0], own.score.size[0]);
  EXPECT_EQ(extended.fitted.back().prior.name, "expression.k");
  ASSERT_EQ(extended.candidates.size(), 1u);
  EXPECT_EQ(extended.candidates[0].name, "push");
}

// "bar: #2" would be a mapping and a comment without quotes.
TEST(ExtendedExperiment, ANameIsReadBackWhateverCharactersItHolds) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBar(folder.Path());
  FittedRun fitted = OpenRun(run);
  fitted.study.name = "bar: #2";
  ScoredEffect scored;
  const Body body = MakeBody(fitted.mesh, 1000);
  for (const CandidateEffect& candidate : MakeCandidates(
           {body, fitted.study.effects, ScaleOf(fitted.study), fitted.study.time_step, 0.25}))
    if (candidate.type == "mass_damping") scored.candidate = candidate;
  scored.score.size = Eigen::VectorXd::Constant(1, 2.5);
  const PredictionStudy extended =
      ReadPredictionStudy(Config::Load(WriteExtendedExperiment(fitted, run, scored)));
  EXPECT_EQ(extended.name, "bar: #2+mass_damping");
  EXPECT_EQ(extended.output.filename(), "bar: #2+mass_damping");
}

TEST(ExtendedExperiment, ARunFromTheExperimentsOwnFolderIsOpened) {
  // A relative path without a folder name is resolved too.
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  std::filesystem::create_directory(folder / "experiments");
  std::ofstream(folder / "experiments/bar.yaml") << BarExperiment(
      folder.Path(), {{"max_volume: 1000 mm^3", "max_volume: 2000 mm^3, preserve_surface: false"}});
  std::filesystem::current_path(folder / "experiments");
  const PredictionStudy study = ReadPredictionStudy(Config::Load("bar.yaml"));
  SilentProgress progress;
  EXPECT_TRUE(RunCalibration(study, &progress).usable);
  EXPECT_NO_THROW(OpenRun(study.output));
  std::filesystem::current_path(before);
}

TEST(ExtendedExperiment, ALawTakesTheOthersPlaceAndAPlaneIsAdded) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBar(folder.Path());
  const FittedRun fitted = OpenRun(run);

  ScoredEffect law;
  law.candidate.type = "st_venant_kirchhoff";
  law.candidate.replaces_material = true;
  const Eigen::VectorXd moduli = fitted.study.effects.front()->Parameters();
  law.candidate.effect = FindEntry("st_venant_kirchhoff")->make(moduli);
  const PredictionStudy other =
      ReadPredictionStudy(Config::Load(WriteExtendedExperiment(fitted, run, law)));
  ASSERT_EQ(other.effects.size(), fitted.study.effects.size());
  EXPECT_EQ(other.effects.front()->Card().type, "st_venant_kirchhoff");
  EXPECT_EQ(other.effects.front()->Parameters(), moduli);
  ASSERT_EQ(other.fitted.size(), 1u);
  EXPECT_EQ(other.fitted[0].prior.name, "young_modulus");
  EXPECT_EQ(other.fitted[0].places[0].effect, 0u) << "the material";

  ScoredEffect contact;
  contact.candidate.type = "plane_contact";
  contact.candidate.effect = MakeEffect(
      "plane_contact", {{"stiffness", 1e8}, {"normal_y", 1}, {"normal_z", 0}, {"offset", -0.0123}});
  contact.candidate.refined = {{"offset", 1e-3}};
  contact.score.size = Eigen::VectorXd::Constant(1, 0.8);
  contact.candidate.prior_centre = contact.candidate.effect->Parameters();
  const int offset = ParameterIndex(contact.candidate.effect->Card(), "offset");
  contact.candidate.prior_centre[offset] = -0.012;  // where the refit started
  const PredictionStudy more =
      ReadPredictionStudy(Config::Load(WriteExtendedExperiment(fitted, run, contact)));
  ASSERT_EQ(more.effects.size(), fitted.study.effects.size() + 1);
  EXPECT_EQ(more.effects.back()->Parameters(), contact.candidate.effect->Parameters());
  // The modulus, and the place of the plane.
  ASSERT_EQ(more.fitted.size(), 2u);
  EXPECT_EQ(more.fitted[1].prior.name, "plane_contact.offset");
  EXPECT_EQ(more.fitted[1].prior.prior_mean, -0.012);
  EXPECT_EQ(more.fitted[1].prior.prior_deviation, 1e-3);
  // The modulus has no prior in the experiment: its start was the mean, and it stays so.
  const CalibratedParameter& modulus = fitted.study.fitted[0].prior;
  ASSERT_TRUE(std::isnan(modulus.prior_mean));
  ASSERT_NE(modulus.start, fitted.values[0]);
  EXPECT_EQ(more.fitted[0].prior.start, fitted.values[0]);
  EXPECT_EQ(more.fitted[0].prior.prior_mean, modulus.start);
  EXPECT_NEAR(more.fitted[0].prior.prior_deviation, modulus.prior_deviation,
              1e-12 * modulus.prior_deviation);
}

// What the program itself wrote into the file does not count as what the user says. Nothing is
// simulated: the markers stand still but for one frame.
TEST(ExtendedExperiment, AConflictWithADefaultPriorStaysOne) {
  const TemporaryFolder folder;
  std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
  frames[kFrames / 3].row(1).array() += 0.003;
  WriteBarRecording(folder.Path(), frames);
  std::ofstream(folder / "bar.yaml")
      << BarExperiment(folder.Path(), {{"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
                                       {", {name: mass_damping.alpha}", ""}});
  FittedRun fitted;
  fitted.study = ReadPredictionStudy(Config::Load(folder / "bar.yaml"));
  ScoredEffect damping;
  damping.candidate.type = "mass_damping";
  damping.candidate.effect = MakeEffect("mass_damping", {{"alpha", 2}});
  damping.candidate.amplitude = {0};
  damping.score.size = Eigen::VectorXd::Constant(1, 2);
  const PredictionStudy extended =
      ReadPredictionStudy(Config::Load(WriteExtendedExperiment(fitted, folder / "bar", damping)));
  ASSERT_EQ(extended.fitted.size(), 2u);

  const CalibrationProblem problem(extended, BarMesh({2, 1, 1}, 1));
  Eigen::VectorXd values = problem.Start();
  values[0] *= std::exp(4 * extended.fitted[0].prior.prior_deviation);
  values[1] = 4 * extended.fitted[1].prior.prior_deviation;
  RecordingMisfit misfit;
  misfit.has_own_places = false;  // no conflicts of markers
  const std::vector<PriorConflict> conflicts = FindPriorConflicts(problem, values, {misfit});
  ASSERT_EQ(conflicts.size(), 2u);
  for (const PriorConflict& conflict : conflicts)
    EXPECT_TRUE(std::get<ModelParameterConflict>(conflict).is_default);
}

// The sizes of a diagnosis count from the null value of a law, its parameters do not.
TEST(ExtendedExperiment, ALawThatVanishesElsewhereStartsWhereItsRefitEnded) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  FittedRun fitted;
  fitted.study = ReadBarStudy(
      folder.Path(),
      {{"name: bar\n",
        "name: bar\ncandidates: [{type: expression, name: push, per: mass, force: [a - 3, 0, 0], "
        "parameters: {a: {value: 4 m/s^2, plausible: [-6 m/s^2, 12 m/s^2], null_value: 3 "
        "m/s^2}}}]\n"}});
  std::filesystem::create_directory(folder / "diagnosis");
  std::ofstream(folder / "diagnosis/of_fit.json")
      << R"({"settings": {"push": {"values": [7], "start": [5], "model": [], "amplitude": [0],
             "refined": {}, "known": {}, "replaces_material": false,
             "body": {"young_modulus": 1e5, "density": 1000, "length": 0.1}}}})";
  RecordedEffect recorded;
  recorded.type = "push";
  recorded.sizes.resize(1);
  const ScoredEffect push = DiagnosedEffect(fitted, folder.Path(), recorded);
  EXPECT_EQ(push.score.size[0], 4);
  EXPECT_EQ(push.candidate.prior_centre[0], 5);
  const PredictionStudy with = WithEffect(fitted.study, push);
  EXPECT_EQ(with.effects.back()->Parameters()[0], 7);
  EXPECT_EQ(with.fitted.back().prior.prior_mean, 3);
  EXPECT_EQ(with.fitted.back().prior.prior_deviation, 9);
}

TEST(ExtendedExperiment, ExplainsWhyAnEffectCannotBeDetected) {
  ScoredEffect scored;
  scored.candidate.type = "drag";
  scored.candidate.effect = MakeEffect("drag", {{"coefficient", 0}});
  scored.candidate.amplitude = {0};
  const double largest = PlausibleScale(scored.candidate.effect->Card().parameters[0]);
  scored.score.detectable = Eigen::VectorXd::Constant(1, 0.5 * largest);
  EXPECT_EQ(WhyUnseen(scored), "");
  scored.score.detectable[0] = 2 * largest;
  EXPECT_THAT(WhyUnseen(scored), HasSubstr("larger than is plausible"));
  scored.score.detectable[0] = INFINITY;
  EXPECT_THAT(WhyUnseen(scored), HasSubstr("drag changes nothing in these recordings"));
  scored.candidate.amplitude.clear();  // a pilot
  scored.score.detectable[0] = 3;
  EXPECT_THAT(WhyUnseen(scored), HasSubstr("3 times as large"));
}

std::string MessageOnOpening(const std::filesystem::path& run) {
  try {
    OpenRun(run);
  } catch (const InputError& error) {
    return error.what();
  }
  return "was opened";
}

TEST(ExtendedExperiment, ARunWhoseExperimentOrRecordingHasChangedIsNotOpened) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBar(folder.Path());
  EXPECT_EQ(MessageOnOpening(run), "was opened");
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  markers.back()(0, 0) += 1e-3;
  WriteBarRecording(folder.Path(), markers);
  EXPECT_THAT(MessageOnOpening(run), HasSubstr("markers.csv has changed since"));
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  EXPECT_EQ(MessageOnOpening(run), "was opened");
  std::ofstream(folder / "bar.yaml", std::ios::app) << "seed_of_doubt: 1\n";
  EXPECT_THROW(OpenRun(run), InputError);
  std::ofstream(folder / "bar.yaml") << BarExperiment(folder.Path(), {{"0.15 MPa", "0.16 MPa"}});
  EXPECT_THAT(MessageOnOpening(run), HasSubstr("bar.yaml has changed since"));
}

}  // namespace
}  // namespace lacuna
