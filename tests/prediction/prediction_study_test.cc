// What a user gets wrong in a prediction study, and what the program says.
#include "prediction/prediction_study.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <random>

#include "effects/gravity.h"
#include "prediction/prediction_study_reader.h"
#include "prediction/recorded_motion.h"
#include "record/effect_card.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

using Replacements = std::map<std::string, std::string>;

// Markers that rest and then all go one way, by `speed` m per frame.
std::vector<Eigen::Matrix3Xd> Moving(double speed, int rests = 5) {
  std::vector<Eigen::Matrix3Xd> markers;
  for (int frame = 0; frame < kFrames; ++frame)
    markers.emplace_back(BarMarkerPlaces().array() + speed * std::max(0, frame - rests));
  return markers;
}

class ReadingAPredictionStudy : public testing::Test {
 protected:
  ReadingAPredictionStudy() { WriteBarRecording(folder_.Path(), Moving(0.001)); }

  std::string MessageAfter(const Replacements& replaced) const {
    return MessageOf(BarExperiment(folder_.Path(), replaced));
  }
  std::string MessageOf(const std::string& experiment) const {
    try {
      ReadPredictionStudy(Config::Parse(experiment, (folder_ / "study.yaml").string()));
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "nothing was refused";
  }
  std::string MessageAfterInRecording(const Replacements& replaced,
                                      const Replacements& in_study = {}) const {
    WriteBarRecording(folder_.Path(), Moving(0.001));
    ReplaceInFile(folder_ / "recording.yaml", replaced);
    return MessageAfter(in_study);
  }

  TemporaryFolder folder_;
};

// Removes the hold, so that the recording has to start at rest.
const Replacements kNoHold{
    {"    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n",
     ""},
    {"      release: 0.0437 s\n", ""}};

TEST_F(ReadingAPredictionStudy, TakesWhatIsThere) {
  const PredictionStudy study = ReadBarStudy(folder_.Path());
  EXPECT_TRUE(IsPredictionStudy(Config::Parse(BarExperiment(folder_.Path()), "e.yaml")));
  ASSERT_EQ(study.recordings.size(), 1u);
  const PredictedRecording& item = study.recordings[0];
  EXPECT_EQ(item.frames.size(), static_cast<size_t>(kFrames));
  ASSERT_TRUE(item.hold.has_value());
  EXPECT_EQ(item.hold->release, kRelease);
  EXPECT_EQ(item.fit_until, kFitUntil);
  EXPECT_EQ(study.density, 1000);
  EXPECT_EQ(study.scheme, TimeScheme::kTwoStep);
  ASSERT_EQ(study.fitted.size(), 2u);
  EXPECT_EQ(study.fitted[0].prior.name, "young_modulus");
  EXPECT_EQ(study.fitted[1].prior.name, "mass_damping.alpha");
  const PredictionStudy some = ReadBarStudy(
      folder_.Path(),
      {{"    fit_until", "    from: 0.04 s\n    to: 0.2 s\n    every: 5\n    fit_until"}});
  EXPECT_THAT(some.recordings[0].frames, ElementsAre(4, 9, 14, 19));
}

TEST_F(ReadingAPredictionStudy, FitsTheMaterialWhenItIsNotTold) {
  const PredictionStudy study = ReadBarStudy(
      folder_.Path(),
      {{"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}\n", ""}});
  ASSERT_EQ(study.fitted.size(), 2u);
  EXPECT_EQ(study.fitted[0].prior.name, "young_modulus");
  EXPECT_EQ(study.fitted[1].prior.name, "poisson_ratio");
}

// A damping that takes its moduli from the material keeps them the material's.
TEST_F(ReadingAPredictionStudy, SharesTheMaterialsParameters) {
  const PredictionStudy study =
      ReadBarStudy(folder_.Path(),
                   {{"{type: mass_damping, alpha: 1 1/s}", "{type: stiffness_damping, beta: 3 ms}"},
                    {"mass_damping.alpha", "stiffness_damping.beta"}});
  ASSERT_EQ(study.fitted[0].places.size(), 2u);
  const double before = study.effects[0]->Parameters()[0];
  const EffectList changed = WithValues(study.effects, study.fitted, Eigen::Vector2d(123456, 0.01));
  EXPECT_EQ(changed[0]->Parameters()[0], 123456);
  EXPECT_EQ(changed[2]->Parameters()[1], 123456);
  EXPECT_EQ(study.effects[0]->Parameters()[0], before) << "an effect does not change";
}

// So does a setting that is omitted; one with a value of its own keeps it.
TEST_F(ReadingAPredictionStudy, SharesSettingsThatFollowTheMaterial) {
  const auto fitted = [&](const std::string& ratio) {
    return ReadBarStudy(folder_.Path(),
                        {{"  - {type: mass_damping, alpha: 1 1/s}\n",
                          "  - {type: mass_damping, alpha: 1 1/s}\n  - {type: viscoelastic_branch, "
                          "modulus: 20 kPa, relaxation_time: 20 ms" +
                              ratio + "}\n"},
                         {"{name: young_modulus}", "{name: poisson_ratio}"}});
  };
  const auto ratio_with = [](const PredictionStudy& study, double ratio) {
    const EffectList changed = WithValues(study.effects, study.fitted, Eigen::Vector2d(ratio, 1));
    const Effect& branch = *changed.back();
    return branch.Parameters()[ParameterIndex(branch.Card(), "poisson_ratio")];
  };
  const PredictionStudy follows = fitted("");
  ASSERT_EQ(follows.fitted[0].places.size(), 2u);
  EXPECT_EQ(ratio_with(follows, 0.3), 0.3);
  const PredictionStudy own = fitted(", poisson_ratio: 0.2");
  EXPECT_EQ(own.fitted[0].places.size(), 1u);
  EXPECT_EQ(ratio_with(own, 0.3), 0.2);
  for (const ModelParameter& parameter : ModelParameters(own.effects))
    EXPECT_NE(parameter.prior.name, "viscoelastic_branch.poisson_ratio") << "it is a setting";
}

// The weight of a mass follows a gravity that is fitted.
TEST_F(ReadingAPredictionStudy, SharesGravityWithMassesThatHaveIt) {
  const PredictionStudy study =
      ReadBarStudy(folder_.Path(), {{"  - {type: mass_damping, alpha: 1 1/s}\n",
                                     "  - {type: mass_damping, alpha: 1 1/s}\n  - {type: "
                                     "attached_mass, mass: 1 g, centre: [0.08 m, 0 m, 0 m], "
                                     "gravity: [0, 0, -9.80665 m/s^2]}\n"},
                                    {"{name: young_modulus}", "{name: gravity.acceleration_z}"}});
  ASSERT_EQ(study.fitted[0].prior.name, "gravity.acceleration_z");
  ASSERT_EQ(study.fitted[0].places.size(), 2u);
  const EffectList changed = WithValues(study.effects, study.fitted, Eigen::Vector2d(-9.7, 1));
  EXPECT_EQ(GravityOf(changed), Eigen::Vector3d(0, 0, -9.7));
  const Effect& mass = *changed.back();
  EXPECT_EQ(mass.Parameters()[ParameterIndex(mass.Card(), "gravity_z")], -9.7);
}

TEST_F(ReadingAPredictionStudy, RefusesTooFewFrames) {
  EXPECT_THAT(MessageAfter({{"    fit_until", "    from: 0.1 s\n    to: 0.115 s\n    fit_until"}}),
              ContainsRegex("study.yaml:[0-9]+:[0-9]+: recordings.0..recording: 2 frames lie "
                            "between 0.1 s and 0.115 s; at least 3 are needed"));
  EXPECT_THAT(MessageAfter({{"fit_until: 0.1501 s", "fit_until: 0.015 s"}}),
              HasSubstr("recordings[0].fit_until: leaves fewer than 3 frames to fit"));
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersWithoutAShape) {
  EXPECT_THAT(MessageAfterInRecording({{"reference: {from: mesh, file: box.off}\n", ""}}),
              HasSubstr("reference: the frames do not show the surface"));
  EXPECT_THAT(
      MessageAfterInRecording({{"    - {name: m3,", "    #- {name: m3,"}}),
      ContainsRegex("recordings\\[0\\].recording: the place of m3 on the undeformed object is "
                    "not known: .*`marker_places` for it, or `markers: \\[m0, m1, m2, m4"));
}

TEST_F(ReadingAPredictionStudy, NamesTheEntryOfAnAbsentRecording) {
  EXPECT_THAT(MessageAfter({{"recording.yaml", "recordin.yaml"}}),
              ContainsRegex("study.yaml:[0-9]+:[0-9]+: recordings\\[0\\].recording: there is no "
                            "file or folder .*recordin.yaml"));
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(MessageAfter({{"recording.yaml", "empty"}}),
              HasSubstr("empty contains no recording.yaml"));
}

TEST_F(ReadingAPredictionStudy, TakesScansButNoHeldOneForTheShape) {
  Replacements scans{{(folder_ / "recording.yaml").string(),
                      std::string(LACUNA_SOURCE_DIR) + "/experiments/recordings/bend"}};
  EXPECT_THAT(MessageAfter(scans), HasSubstr("recordings[0].hold: the recording's reference shape "
                                             "is its first frame, in which the object is held"));
  scans.insert(kNoHold.begin(), kNoHold.end());
  const PredictionStudy study = ReadBarStudy(folder_.Path(), scans);
  ASSERT_NE(study.recordings[0].scans, nullptr);
  EXPECT_EQ(study.recordings[0].frames.size(), 16u);
  EXPECT_EQ(study.scan.patches, 150);
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersWhoseGripFollowsAScan) {
  EXPECT_THAT(
      MessageAfterInRecording(
          {{"reference",
            "gripped: [{name: tool, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, "
            "0]}}]\nreference"}}),
      HasSubstr("tool is to follow the scan, but there are only markers"));
}

TEST_F(ReadingAPredictionStudy, RefusesAnObjectThatNothingHolds) {
  const std::string clamp =
      "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n";
  EXPECT_THAT(
      MessageAfterInRecording({{clamp, ""}}),
      AllOf(HasSubstr("recordings[0].recording: nothing holds the object after its release"),
            HasSubstr("a plane on which it lies does not suffice")));
  const std::string damping = "  - {type: mass_damping, alpha: 1 1/s}\n";
  EXPECT_EQ(
      MessageAfterInRecording(
          {{clamp, ""}}, {{damping, damping + "  - {type: elastic_support, modulus: 1 MPa/m}\n"}}),
      "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesAReleaseAfterTheEnd) {
  EXPECT_THAT(MessageAfter({{"release: 0.0437 s", "release: 0.3 s"}}),
              HasSubstr("recordings[0].hold.release: lies after the last frame that is used, at "
                        "0.25 s"));
  const auto message = [&](const std::string& to) {
    return MessageAfter({{"release: 0.0437 s", "release: 0.1237 s"},
                         {"    fit_until", "    to: " + to + "\n    fit_until"}});
  };
  EXPECT_THAT(message("0.12 s"),
              HasSubstr("hold.release: lies after the last frame that is used, at 0.12 s: the "
                        "object is never released"));
  EXPECT_EQ(message("0.13 s"), "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesALoadThatDoesNotCoverTheFrames) {
  const std::string load =
      "forces: [{name: pull, file: load.csv, time: t, x: x, y: y, z: z, region: {half_space: "
      "{point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}}]\nreference";
  EXPECT_THAT(MessageAfterInRecording({{"reference", load}}),
              ContainsRegex("load.csv covers 0.05 s to 0.2 s, the frames 0 s to 0.25 s"));
  EXPECT_EQ(MessageAfterInRecording(
                {{"reference", load}},
                {{"release: 0.0437 s", "release: 0.0537 s"},
                 {"    fit_until", "    from: 0.05 s\n    to: 0.2 s\n    fit_until"}}),
            "nothing was refused");
  EXPECT_THAT(MessageAfterInRecording({{"reference",
                                        "forces: [{name: pull, constant: [0 N, 0 N, 1 N]}]\n"
                                        "reference"}}),
              HasSubstr("does not say where pull acts"));
}

TEST_F(ReadingAPredictionStudy, RefusesAGripWhosePathDoesNotCoverTheFrames) {
  const std::string grip =
      "gripped: [{name: tool, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}, path: "
      "{file: load.csv, time: t, x: x, y: y, z: z}}]\nreference";
  EXPECT_THAT(MessageAfterInRecording({{"reference", grip}}),
              ContainsRegex("load.csv covers 0.05 s to 0.2 s, the frames 0 s to 0.25 s"));
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersThatRestWhereTheySitAnyway) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1e-4);  // m
  auto markers = Moving(0);
  for (auto& frame : markers)
    for (double& coordinate : frame.reshaped()) coordinate += noise(random);
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter({}),
              HasSubstr("recordings: nothing moves in the frames that are fitted"));

  // At rest elsewhere they tell at least what statics can, but no more.
  for (auto& frame : markers) frame.array() += 0.01;
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_EQ(MessageAfter({}), "nothing was refused");
  EXPECT_THAT(RestWarning(ReadBarStudy(folder_.Path())), HasSubstr("anything else that needs"));
  WriteBarRecording(folder_.Path(), Moving(0.001));
  EXPECT_EQ(RestWarning(ReadBarStudy(folder_.Path())), "");
}

TEST_F(ReadingAPredictionStudy, RefusesParametersThatTheModelDoesNotHave) {
  EXPECT_THAT(MessageAfter({{"name: bar\n", "name: ../bar\n"}}),
              ContainsRegex("study.yaml:[0-9]+:[0-9]+: name: names a folder"));
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", "{name: young_modulos}"}}),
              ContainsRegex("fit.parameters.0..name: got \"young_modulos\".*did you mean "
                            "\"young_modulus\""));
  EXPECT_THAT(MessageAfter({{"{name: mass_damping.alpha}", "{name: young_modulus}"}}),
              HasSubstr("is listed twice"));
  EXPECT_THAT(MessageAfter(
                  {{"{name: young_modulus}", "{name: young_modulus, min: 0.2 MPa, max: 0.1 MPa}"}}),
              HasSubstr("fit.parameters[0].min: is above max"));
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", "{name: young_modulus, min: 0.2 MPa}"}}),
              HasSubstr("starts at 150000 Pa, outside 200000 to"));
}

TEST_F(ReadingAPredictionStudy, RefusesCandidatesThatCouldNotBeAddedByName) {
  const auto message = [&](const std::string& name, const std::string& more = "") {
    return MessageAfter(
        {{"name: bar\n",
          "name: bar\ncandidates:\n  - {type: expression, name: " + name +
              ", per: mass, force: [a, 0, 0], parameters: {a: {value: 1 m/s^2, plausible: "
              "[-9 m/s^2, 9 m/s^2]}}}\n" +
              more}});
  };
  EXPECT_EQ(message("push"), "nothing was refused");
  EXPECT_THAT(message("a push"), HasSubstr("candidates[0].name: must consist of letters"));
  EXPECT_THAT(message("drag"),
              HasSubstr("candidates[0].name: is the name of an effect of the cat"));
  EXPECT_THAT(message("push", "  - {type: drag, coefficient: 1}\n"),
              HasSubstr("candidates[1].type: a diagnosis tries drag anyway"));
}

TEST_F(ReadingAPredictionStudy, RefusesAReleaseThatNoFrameComesBefore) {
  EXPECT_THAT(MessageAfter({{"release: 0.0437 s", "release: -1 s"}}),
              HasSubstr("hold.release: lies before the first frame that is used, at 0 s"));
  const auto message = [&](const std::string& from) {
    return MessageAfter({{"    fit_until", "    from: " + from + "\n    fit_until"}});
  };
  EXPECT_THAT(message("0.05 s"),
              HasSubstr("hold.release: lies before the first frame that is used, at 0.05 s: no "
                        "frame shows the object while it is held"));
  EXPECT_EQ(message("0.04 s"), "nothing was refused");
  EXPECT_THAT(MessageAfter({{"    fit_until", "    fit_untl"}}),
              HasSubstr("did you mean \"fit_until\""));
}

TEST_F(ReadingAPredictionStudy, TakesWhatIsKnownBeforeOfAParameter) {
  WriteBarRecording(folder_.Path(), Moving(0.001));
  const std::vector<ModelParameter> fitted =
      ReadBarStudy(
          folder_.Path(),
          {{"{name: mass_damping.alpha}", "{name: mass_damping.alpha, deviation: 0.5 1/s}"},
           {"{name: young_modulus}", "{name: young_modulus, mean: 140 kPa, deviation: 7 kPa}"}})
          .fitted;
  EXPECT_EQ(fitted[0].prior.prior_mean, 1.4e5);
  ASSERT_TRUE(fitted[0].prior.log_scale);
  EXPECT_NEAR(fitted[0].prior.prior_deviation, 0.05, 1e-12);
  EXPECT_EQ(fitted[1].prior.prior_mean, 1) << "where it starts";
  EXPECT_NEAR(fitted[1].prior.prior_deviation, 0.5, 1e-12);
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", "{name: young_modulus, mean: 0.2 MPa}"}}),
              HasSubstr("parameters[0].mean: needs a `deviation` beside it"));
}

// Far outside of what is plausible, but possible.
TEST_F(ReadingAPredictionStudy, StartsFromAnyValueThatTheCardAllows) {
  for (const char* fit : {"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}",
                          "fit: {parameters: [{name: young_modulus}]}", ""}) {
    const PredictionStudy study = ReadBarStudy(
        folder_.Path(),
        {{"young_modulus: 0.15 MPa", "young_modulus: 0.5 Pa"},
         {"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}", fit}});
    const CalibratedParameter& modulus = study.fitted[0].prior;
    ASSERT_EQ(modulus.name, "young_modulus");
    EXPECT_EQ(modulus.start, 0.5);
    EXPECT_LT(modulus.min, modulus.start) << fit;
    EXPECT_GT(modulus.min, 0) << "an open bound";
  }
  EXPECT_THAT(MessageAfter({{"young_modulus: 0.15 MPa", "young_modulus: 0 Pa"}}),
              ContainsRegex("material.young_modulus: got \"0 Pa\""));
}

// A fit stays away from a bound at which the model degenerates, not from one well before it.
TEST_F(ReadingAPredictionStudy, ClosesABoundThatLiesInsideAnOpenOne) {
  const auto ratio = [&](const std::string& bounds) {
    return ReadBarStudy(folder_.Path(),
                        {{"{name: young_modulus}", "{name: poisson_ratio" + bounds + "}"}})
        .fitted[0]
        .prior;
  };
  const CalibratedParameter limited = ratio(", max: 0.45");
  EXPECT_EQ(limited.max, 0.45);
  EXPECT_FALSE(limited.open_max);
  EXPECT_FALSE(ratio(", min: 0").open_min);
  EXPECT_EQ(ratio(", max: 0.49999").max, 0.49999);
  EXPECT_TRUE(ratio(", max: 0.49999").open_max);

  // Near 0.5 predictions take long, so that the ratio ends well before unless the user says so.
  const CalibratedParameter as_on_card = ratio("");
  EXPECT_FALSE(as_on_card.open_max);
  EXPECT_GT(as_on_card.max, 0.49);
  EXPECT_LT(as_on_card.max, 0.4995);
}

TEST_F(ReadingAPredictionStudy, TakesAnUncertainDensityWhereItsWeightIsKnown) {
  const PredictionStudy study =
      ReadBarStudy(folder_.Path(), {{"noise: 0.05 mm", "density_deviation: 0.02\nnoise: 0.05 mm"}});
  ASSERT_EQ(study.fitted.size(), 3u);
  EXPECT_TRUE(IsDensity(study.fitted[2], study.effects));
  EXPECT_FALSE(IsDensity(study.fitted[0], study.effects));
  EXPECT_EQ(study.fitted[2].prior.prior_mean, 1000);
  EXPECT_EQ(study.fitted[2].prior.prior_deviation, 0.02);
  EXPECT_EQ(study.effects[3]->Parameters()[3], -9.80665);
  EXPECT_EQ(ReadBarStudy(folder_.Path()).effects.size(), 3u);
  EXPECT_THAT(MessageAfter({{"noise: 0.05 mm", "density_deviation: 0.02\nnoise: 0.05 mm"},
                            {"{name: mass_damping.alpha}", "{name: gravity.acceleration_z}"}}),
              HasSubstr("density_deviation: cannot be combined with a fitted "
                        "gravity.acceleration_z"));
  EXPECT_THAT(MessageAfter({{"noise: 0.05 mm", "density_deviation: 0.02\nnoise: 0.05 mm"},
                            {"  - {type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}\n", ""},
                            {"    fit_until",
                             "    effects: [{type: gravity, acceleration: [0, 0, "
                             "-9.8 m/s^2]}]\n    fit_until"}}),
              HasSubstr("density_deviation: needs gravity in the list `effects` of the "
                        "experiment, not in that of bar"));
}

// Both would act: gravity upside down in one recording would cancel that of the experiment.
TEST_F(ReadingAPredictionStudy, RefusesASecondGravityInARecording) {
  const std::string gravity = "{type: gravity, acceleration: [0, 0, 9.80665 m/s^2]}";
  const auto message = [&](const std::string& own, Replacements more = {}) {
    more.insert({"    fit_until", "    effects: [" + own + "]\n    fit_until"});
    return MessageAfter(more);
  };
  EXPECT_THAT(message(gravity),
              HasSubstr("recordings[0].effects[0].type: gravity is listed among the effects of the "
                        "experiment already"));
  const Replacements nowhere_else{
      {"  - {type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}\n", ""}};
  EXPECT_EQ(message(gravity, nowhere_else), "nothing was refused");
  EXPECT_THAT(message(gravity + ", " + gravity, nowhere_else),
              HasSubstr("recordings[0].effects[1].type: gravity is listed twice"));
  const std::string push = "{type: point_force, force: [0, 0, 1 mN], centre: [0.08 m, 0 m, 0 m]}";
  EXPECT_EQ(message(push + ", " + push), "nothing was refused") << "of these a model may have two";
}

TEST_F(ReadingAPredictionStudy, RefusesAMassInOneRecordingWhoseWeightIsNotKnown) {
  const auto message = [&](const std::string& more, const std::string& fitted) {
    return MessageAfter(
        {{"    fit_until", "    effects: [{type: attached_mass, mass: 2 g, centre: [80 mm, 0, 0]" +
                               more + "}]\n    fit_until"},
         {"{name: mass_damping.alpha}", fitted}});
  };
  const std::string alpha = "{name: mass_damping.alpha}",
                    gravity = "{name: gravity.acceleration_z}";
  EXPECT_EQ(message("", alpha), "nothing was refused");
  EXPECT_THAT(message(", gravity: [0, 0, -9.81 m/s^2]", alpha),
              HasSubstr("gravity: the gravity of the model is [0, 0, -9.80665] m/s^2"));
  EXPECT_THAT(message("", gravity),
              HasSubstr("fit: gravity.acceleration_z cannot be fitted: the weight of attached_mass "
                        "among the effects of bar would stay the same"));
  EXPECT_EQ(message(", gravity: [0, 0, 0]", gravity), "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesPlacementsThatSayNothing) {
  const auto message = [&](const std::string& more) {
    return MessageAfterInRecording({{"normal: [-1, 0, 0]}", "normal: [-1, 0, 0]}, " + more}});
  };
  EXPECT_EQ(message("placement: {shift_deviation: 1 mm}"), "nothing was refused");
  EXPECT_THAT(message("placement: {shift_deviation: 0 mm}"),
              ContainsRegex("recording.yaml.*placement: needs a shift_deviation or a "
                            "turn_deviation above 0"));
  EXPECT_THAT(message("placement: {turn_deviation: 1 deg}, directions: [x]"),
              HasSubstr("placement: cannot be combined with `directions`"));
}

TEST_F(ReadingAPredictionStudy, RefusesNothingToFit) {
  EXPECT_THAT(MessageAfter({{"    fit_until", "    fitted: false\n    fit_until"}}),
              HasSubstr("recordings: none of them is fitted"));
  std::string none = BarExperiment(folder_.Path());
  none.replace(none.find("recordings:"), std::string::npos, "recordings: []\n");
  EXPECT_THAT(MessageOf(none), HasSubstr("recordings: is empty"));
}

TEST_F(ReadingAPredictionStudy, TakesEquilibria) {
  const std::string statics = "motion: {scheme: quasi_static}";
  EXPECT_THAT(MessageAfter({{"motion: {time_step: 1.5 ms}", statics}}),
              HasSubstr("recordings[0].hold: a released object vibrates"));
  Replacements one{{"motion: {time_step: 1.5 ms}", statics},
                   {"    fit_until", "    from: 0.1 s\n    to: 0.115 s\n    fit_until"}};
  one.insert(kNoHold.begin(), kNoHold.end());
  EXPECT_EQ(MessageAfter(one), "nothing was refused");
  const PredictionStudy study = ReadBarStudy(folder_.Path(), one);
  EXPECT_EQ(study.recordings[0].frames.size(), 2u);
  EXPECT_NEAR(study.time_step, 0.01, 1e-12);  // a step a frame
  // Frames far from each other: no start in motion.
  WriteBarRecording(folder_.Path(), Moving(0.001, 0));
  EXPECT_EQ(MessageAfter(one), "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, TellsOfASlowRecording) {
  PredictionStudy study = ReadBarStudy(folder_.Path(), {{"motion: {time_step: 1.5 ms}\n", ""}});
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
  for (double& time : study.recordings[0].recording.times) time *= 1000;  // a frame in 10 s
  study.recordings[0].fit_until *= 1000;
  EXPECT_THAT(StudyWarnings(study),
              ElementsAre(HasSubstr("50000 steps of 5 ms for 26 frames: if the object is in "
                                    "equilibrium")));
  study.scheme = TimeScheme::kQuasiStatic;
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
}

TEST_F(ReadingAPredictionStudy, TellsOfGravityThatTheModelLacks) {
  PredictionStudy study = ReadBarStudy(folder_.Path());
  ASSERT_THAT(StudyWarnings(study), ElementsAre());
  study.recordings[0].recording.object.gravity = Eigen::Vector3d(0, 0, -9.81);
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
  std::erase_if(study.effects, [](const auto& effect) { return effect->Card().type == "gravity"; });
  EXPECT_THAT(StudyWarnings(study),
              ElementsAre(HasSubstr("was recorded under gravity, but the model "
                                    "has none")));
  study.recordings[0].effects.push_back(MakeGravity(Eigen::Vector3d(0, 0, -9.81)));
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
}

TEST_F(ReadingAPredictionStudy, WarnsWhereNoFrameIsHeldOut) {
  EXPECT_THAT(StudyWarnings(ReadBarStudy(folder_.Path())),
              testing::Not(testing::Contains(HasSubstr("fit_until"))));
  const std::string until = fmt::format("fit_until: {} s", kFitUntil);
  const PredictionStudy late = ReadBarStudy(folder_.Path(), {{until, "fit_until: 9 s"}});
  EXPECT_THAT(StudyWarnings(late),
              testing::Contains(HasSubstr("bar: `fit_until: 9 s` does not lie before the last "
                                          "frame that is used, at 0.25 s")));
  EXPECT_EQ(late.recordings[0].FittedFrames(), late.recordings[0].frames);
}

TEST_F(ReadingAPredictionStudy, WarnsOfSettingsOfScansWithoutAScan) {
  const auto warnings = [&](const std::string& scan) {
    return StudyWarnings(
        ReadBarStudy(folder_.Path(), {{"noise: 0.05 mm\n", "noise: 0.05 mm\n" + scan}}));
  };
  const auto warned = testing::Contains(HasSubstr("`scan` has no effect"));
  EXPECT_THAT(warnings(""), testing::Not(warned));
  EXPECT_THAT(warnings("scan: {noise: 1 mm}\n"), warned);
}

TEST_F(ReadingAPredictionStudy, TellsOfFramesWithoutMarkers) {
  std::vector<Eigen::Matrix3Xd> markers = Moving(0.001);
  for (const int frame : {12, 13})
    markers[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  markers[14].col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(StudyWarnings(ReadBarStudy(folder_.Path())),
              ElementsAre("bar: 2 of 26 frames show no marker, the first is frame 12; they are not "
                          "compared"));
}

TEST_F(ReadingAPredictionStudy, RefusesStepsThatFollowNoMotion) {
  EXPECT_THAT(MessageAfter({{"time_step: 1.5 ms", "time_step: 0.1 s"}}),
              HasSubstr("motion.time_step: makes 2.5 steps"));
  EXPECT_THAT(MessageAfter({{"time_step: 1.5 ms", "time_step: 1e-12 s"}}),
              HasSubstr("motion.time_step: makes 2.5e+11 steps"));
}

TEST_F(ReadingAPredictionStudy, RefusesTwoRecordingsOfOneName) {
  std::string text = BarExperiment(folder_.Path());
  const std::string entry = text.substr(text.find("  - recording: "));
  const std::string message = MessageOf(text + entry);
  EXPECT_THAT(message, HasSubstr("recordings[1].name: \""));
  EXPECT_THAT(message, HasSubstr("is already the name of another recording"));
}

TEST_F(ReadingAPredictionStudy, TakesTheNoiseOfRestForNoMotion) {
  // Moved in the middle, and at rest in the end where it was in the beginning.
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1e-4);
  for (const double far : {0.0, 0.01}) {
    std::vector<Eigen::Matrix3Xd> markers;
    for (int frame = 0; frame < kFrames; ++frame) {
      const double away = frame > 8 && frame < 18 ? far : 0;
      markers.emplace_back(BarMarkerPlaces().array() + away + 2e-3);
      for (double& value : markers.back().reshaped()) value += normal(random);
    }
    WriteBarRecording(folder_.Path(), markers);
    EXPECT_EQ(MessageAfter(kNoHold), "nothing was refused");
  }
}

TEST_F(ReadingAPredictionStudy, RefusesAStartInMotion) {
  WriteBarRecording(folder_.Path(), Moving(0.001, 0));
  EXPECT_EQ(MessageAfter({}), "nothing was refused");  // held until 0.04 s
  auto markers = Moving(0, 0);
  for (size_t frame = 1; frame < markers.size(); ++frame) markers[frame].array() += 0.001;
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter(kNoHold), HasSubstr("the object already moves between its first two"));
  // The first marker is not seen at first: the others tell.
  markers[0].col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter(kNoHold), HasSubstr("the object already moves between its first two"));
  WriteBarRecording(folder_.Path(), Moving(0.001));
  EXPECT_EQ(MessageAfter(kNoHold), "nothing was refused");
}

TEST(PredictedRecording, FitsItsUsedFramesUntilATime) {
  PredictedRecording item;
  item.recording.times = {0, 1, 2, 3, 4};
  item.frames = {0, 2, 4};
  item.fit_until = 2;
  EXPECT_THAT(item.FittedFrames(), ElementsAre(0, 2));
  EXPECT_FALSE(item.IsFitted(4));
  item.fitted = false;
  EXPECT_THAT(item.FittedFrames(), testing::IsEmpty());
  EXPECT_FALSE(item.IsFitted(0));
}

TEST(PredictedRecording, HasTheSameMarkersOnlyWithTheSameNamesAndPlaces) {
  PredictedRecording one;
  one.recording.markers.names = {"a", "b"};
  one.recording.markers.places = Eigen::Matrix3Xd::Identity(3, 2);
  PredictedRecording other = one;
  EXPECT_THAT(*SameMarkers(one, other), ElementsAre(0, 1));
  other.recording.markers.places(0, 1) = 1e-3;
  EXPECT_FALSE(SameMarkers(one, other));
  other = one;
  other.recording.markers.names = {"b", "a"};
  EXPECT_FALSE(SameMarkers(one, other));
  // In another order, as the columns of a file may be.
  other.recording.markers.places = one.recording.markers.places.rowwise().reverse().eval();
  EXPECT_THAT(*SameMarkers(one, other), ElementsAre(1, 0));
}

}  // namespace
}  // namespace lacuna
