// The effects of a prediction study and their parameters: what is shared, fitted and known before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "prediction/prediction_study.h"
#include "prediction/reading_a_prediction_study.h"
#include "record/effect_card.h"

namespace lacuna {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

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
  for (const ModelParameter& parameter : ModelParameters(own.effects, ScaleOf(own)))
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
  EXPECT_FALSE(fitted[1].prior.has_default_prior);
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", "{name: young_modulus, mean: 0.2 MPa}"}}),
              HasSubstr("parameters[0].mean: needs a `deviation` beside it"));
}

TEST_F(ReadingAPredictionStudy, KnowsWhichPriorsNobodyHasGiven) {
  WriteBarRecording(folder_.Path(), Moving(0.001));
  const auto is_default = [&](const std::string& entry) {
    return ReadBarStudy(folder_.Path(), {{"{name: young_modulus}", entry}})
        .fitted[0]
        .prior.has_default_prior;
  };
  const std::string stated = "{name: young_modulus, mean: 140 kPa, deviation: 7 kPa";
  EXPECT_TRUE(is_default("{name: young_modulus}"));
  EXPECT_FALSE(is_default(stated + "}"));
  EXPECT_FALSE(is_default(stated + ", prior: given}"));
  EXPECT_TRUE(is_default(stated + ", prior: default}"));
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", stated + ", prior: measured}"}}),
              HasSubstr("parameters[0].prior: got \"measured\"; expected one of: given, default"));
  EXPECT_THAT(MessageAfter({{"{name: young_modulus}", "{name: young_modulus, prior: default}"}}),
              HasSubstr("parameters[0].prior: needs a `deviation` beside it"));
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
    EXPECT_NEAR(modulus.min, 0.5e-6, 1e-12) << "an open bound, on a logarithmic scale";
  }
  EXPECT_THAT(MessageAfter({{"young_modulus: 0.15 MPa", "young_modulus: 0 Pa"}}),
              ContainsRegex("material.young_modulus: got \"0 Pa\""));
}

// How stiff a branch of a body may be is a question of how stiff the body is, and which force acts
// on it and which mass it carries, of its size, too.
TEST(ModelParameters, HaveRangesThatArePlausibleInTheirBody) {
  const auto typical = [](const BodyScale& body, const std::string& name) {
    const EffectList effects = {
        MakeEffect("neo_hookean", {{"young_modulus", body.young_modulus}, {"poisson_ratio", 0.4}}),
        MakeEffect("viscoelastic_branch",
                   {{"modulus", 1e4}, {"relaxation_time", 1}, {"poisson_ratio", 0.4}}),
        MakeEffect("mass_damping", {{"alpha", 1}}),
        MakeEffect("point_force", {{"force_x", 1},
                                   {"force_y", 0},
                                   {"force_z", 0},
                                   {"centre_x", 0},
                                   {"centre_y", 0},
                                   {"centre_z", 0}}),
        MakeEffect("attached_mass", {{"mass", 0.01},
                                     {"centre_x", 0},
                                     {"centre_y", 0},
                                     {"centre_z", 0},
                                     {"gravity_x", 0},
                                     {"gravity_y", 0},
                                     {"gravity_z", 0}}),
        MakeEffect("drag", {{"coefficient", 1}})};
    for (const ModelParameter& parameter : ModelParameters(effects, body))
      if (parameter.prior.name == name) return parameter.prior.typical;
    return 0.0;
  };
  const BodyScale stiff = {1e7, 1000, 0.1}, large = {1e5, 1000, 1}, dense = {1e5, 4000, 0.1};
  const auto ratio = [&](const BodyScale& body, const std::string& name) {
    return typical(body, name) / typical(kReferenceBody, name);
  };
  EXPECT_DOUBLE_EQ(typical(kReferenceBody, "viscoelastic_branch.modulus"), 1.5e5);
  EXPECT_DOUBLE_EQ(ratio(stiff, "viscoelastic_branch.modulus"), 100);
  EXPECT_DOUBLE_EQ(ratio(large, "viscoelastic_branch.modulus"), 1);
  EXPECT_DOUBLE_EQ(ratio(stiff, "point_force.force_x"), 100);
  EXPECT_DOUBLE_EQ(ratio(large, "point_force.force_x"), 100) << "stress times area";
  EXPECT_DOUBLE_EQ(ratio(stiff, "attached_mass.mass"), 1);
  EXPECT_DOUBLE_EQ(ratio(large, "attached_mass.mass"), 1000);
  EXPECT_DOUBLE_EQ(ratio(dense, "attached_mass.mass"), 4);
  EXPECT_DOUBLE_EQ(ratio(stiff, "mass_damping.alpha"), 10) << "as the natural frequencies";
  EXPECT_DOUBLE_EQ(ratio(large, "mass_damping.alpha"), 0.1);
  EXPECT_DOUBLE_EQ(ratio(dense, "mass_damping.alpha"), 0.5);
  EXPECT_DOUBLE_EQ(ratio(large, "attached_mass.centre_x"), 10);
  for (const BodyScale& body : {stiff, large, dense}) {
    EXPECT_DOUBLE_EQ(ratio(body, "drag.coefficient"), 1) << "a property of the medium";
    EXPECT_DOUBLE_EQ(ratio(body, "young_modulus"), 1);
  }
}

TEST(BodyUnitText, NamesTheProductOfModulusDensityAndLength) {
  EXPECT_EQ(BodyUnitText(kPressure), "E");
  EXPECT_EQ(BodyUnitText(kForce), "E L^2");
  EXPECT_EQ(BodyUnitText(kMass), "ρ L^3");
  EXPECT_EQ(BodyUnitText(kRate), "E^0.5 ρ^-0.5 L^-1");
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
  EXPECT_THAT(
      message(gravity),
      HasSubstr("recordings[0].effects[0].type: gravity is already listed among the effects "
                "of the experiment"));
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

}  // namespace
}  // namespace lacuna
