// What is planned for a bar whose model lacks a damping, so that drag and mass damping are rivals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/recording_power.h"
#include "plan/plan_run.h"
#include "plan/planner.h"
#include "plan/rivals.h"
#include "prediction/played_recording.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "report/plan_report.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

// A recording that is too noisy for its rivals: mass damping and drag act alike.
class PlanOfABar : public ::testing::Test {
 protected:
  void SetUp() override {
    HeldBarTruth truth;
    truth.alpha = 3;
    truth.noise = 4e-4;
    WriteBarRecording(folder_.Path(), FilmHeldBar(truth));
    std::ofstream(folder_ / "bar.yaml") << BarExperiment(
        folder_.Path(),
        {{"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
         {", {name: mass_damping.alpha}", ""},
         {"noise: 0.05 mm", "noise: 0.4 mm"},
         {"max_volume: 1000 mm^3", "max_volume: 2000 mm^3, preserve_surface: false"},
         {"name: bar\n", "name: bar\noutput: run\n"}});
    SilentProgress silent;
    RunCalibration(ReadPredictionStudy(Config::Load(folder_ / "bar.yaml")), &silent);
    const FittedRun fitted = OpenRun(Run());
    RunDiagnosis(fitted, Run(), {}, &silent);
  }
  std::filesystem::path Run() const { return folder_ / "run"; }
  PlanRecord Plan(const std::vector<Protocol>& protocols) const {
    const FittedRun fitted = OpenRun(Run());
    const KeptDiagnosis kept = *FindDiagnosis(Run());
    SilentProgress silent;
    return MakePlan({fitted, kept.record, kept.decision}, protocols, &silent);
  }
  Protocol Named(const std::string& name) const {
    Protocol protocol;
    protocol.name = name;
    protocol.recording = OpenRun(Run()).study.recordings.front().name;
    return protocol;
  }

  // The files of the best recording: it can be played, and the fit takes it once it is there.
  void ExpectPlayable(const PlanRecord& plan) const {
    const std::filesystem::path experiment =
        PlanFile(Run()).parent_path() / plan.outcomes.front().experiment;
    const std::filesystem::path folder = experiment.parent_path();
    const PredictionStudy protocol = ReadPredictionStudy(Config::Load(folder / "protocol.yaml"));
    ASSERT_EQ(protocol.recordings.size(), 1u);
    const PredictedRecording& item = protocol.recordings.front();
    const TetMesh mesh = MakeReferenceBody(protocol).mesh;
    EXPECT_EQ(mesh.nodes, OpenRun(Run()).mesh.nodes);
    const auto body = std::make_shared<const Body>(MakeBody(mesh, protocol.density));
    const RecordingModel model(protocol, item, mesh, body, {});
    const PlayedRecording played = Play(model, PlayedNuisances(model));
    ASSERT_TRUE(played.summary.IsUsable());
    for (size_t f = 0; f < played.markers.size(); ++f)  // written with nine decimals
      EXPECT_LT((played.markers[f] - item.recording.markers.positions[f]).norm(), 1e-7) << f;

    EXPECT_THAT([&] { ReadPredictionStudy(Config::Load(experiment)); },
                ThrowsMessage<InputError>(HasSubstr("measured")));
    std::filesystem::copy(folder / "predicted", folder / "measured");
    const PredictionStudy joint = ReadPredictionStudy(Config::Load(experiment));
    ASSERT_EQ(joint.recordings.size(), 2u);
    EXPECT_EQ(joint.recordings[1].name, plan.outcomes.front().name);
    EXPECT_EQ(joint.name, "bar-with-" + plan.outcomes.front().name);
    EXPECT_EQ(std::filesystem::weakly_canonical(joint.output),
              std::filesystem::weakly_canonical(folder_ / joint.name));
    EXPECT_EQ(joint.recordings[0].name, OpenRun(Run()).study.recordings.front().name);
  }

  // With less noise, so that a rival is named.
  void ExpectWhatTheDiagnosisHasNotSimulatedIsSimulated() const {
    const FittedRun fitted = OpenRun(Run());
    KeptDiagnosis kept = *FindDiagnosis(Run());
    kept.decision.baseline.variance *= 1e-4;
    const std::string known = RivalsOf(kept.record).front().effect;
    kept.record.decision.power.assign(1, {});
    kept.record.decision.power[0].truth = {known};
    kept.record.decision.power[0].named = 0.125;
    SilentProgress silent;
    const PlanRecord plan = MakePlan({fitted, kept.record, kept.decision}, {}, &silent);
    double most = 0;
    for (const PlannedRival& rival : plan.rivals) {
      if (rival.effect == known) {
        EXPECT_EQ(rival.named_now, 0.125);
        continue;
      }
      const auto power = PowerToFind(kept.decision, rival.effect, true);
      EXPECT_EQ(rival.named_now, power ? power->named : 0) << rival.effect;
      most = std::max(most, rival.named_now);
    }
    EXPECT_GT(most, 0);
  }

  // As if the diagnosis had left the two best effects together as well.
  void ExpectAPairIsWeighed(const Protocol& protocol) const {
    const FittedRun fitted = OpenRun(Run());
    KeptDiagnosis kept = *FindDiagnosis(Run());
    std::vector<HypothesisProbability>& all = kept.record.decision.probabilities;
    std::vector<std::string> best;
    double evidence = 0;
    for (const HypothesisProbability& one : all) {
      if (one.kind != HypothesisProbability::Kind::kEffect || best.size() == 2) continue;
      if (best.empty()) evidence = one.evidence;
      best.push_back(one.names.front());
    }
    ASSERT_EQ(best.size(), 2u);
    HypothesisProbability& pair = all.emplace_back();
    pair.kind = HypothesisProbability::Kind::kPair;
    pair.names = {best[1], best[0]};
    pair.evidence = evidence + std::log(kPriorEffects / kPriorPairs);
    SetPosterior(&all);
    SilentProgress silent;
    const PlanRecord plan = MakePlan({fitted, kept.record, kept.decision}, {protocol}, &silent);
    EXPECT_THAT(plan.not_predicted, Not(Contains(HasSubstr(" with "))));
    const auto rival = std::find_if(plan.rivals.begin(), plan.rivals.end(),
                                    [](const PlannedRival& one) { return one.IsPair(); });
    ASSERT_NE(rival, plan.rivals.end());
    const std::string name = std::min(best[0], best[1]) + " with " + std::max(best[0], best[1]);
    EXPECT_EQ(rival->effect, name);
    EXPECT_GT(rival->probability, 0.1);
    const PlannedOutcome& outcome = plan.outcomes.at(0);
    ASSERT_TRUE(outcome.IsPlayable()) << outcome.message;
    ASSERT_EQ(outcome.named.size(), plan.rivals.size());
    const double named = outcome.named[static_cast<size_t>(rival - plan.rivals.begin())];
    EXPECT_GE(named, 0);
    EXPECT_LE(named, 1);
    double farthest = 0;  // λ is 0 from an effect beside which the pair has no amount of the other
    for (const PlannedPair& one : outcome.pairs) {
      if (one.first != name && one.second != name) continue;
      EXPECT_GE(one.lambda_then, one.lambda_now - 1e-6) << one.first << " " << one.second;
      farthest = std::max(farthest, one.lambda_now);
    }
    EXPECT_GT(farthest, 0);
    std::vector<std::string> sizes;
    for (const PlannedSize& size : outcome.sizes) {
      if (size.effect != name) continue;
      sizes.push_back(size.parameter);
      EXPECT_LT(size.half_width_then, size.half_width_now) << size.parameter;
    }
    EXPECT_THAT(sizes, Contains(testing::StartsWith(best[0] + ".")));
    EXPECT_THAT(sizes, Contains(testing::StartsWith(best[1] + ".")));
  }

  // A mass beside the object.
  void ExpectFailuresAreSaid() const {
    std::ofstream(folder_ / "bad.yaml")
        << "schema_version: 1\nstock: false\nprotocols:\n"
           "  - {name: away, weight: {mass: 1 g, place: [1 m, 0 m, 0 m], radius: 1 cm}}\n";
    SilentProgress silent;
    const PlanRecord plan = RunPlan(Run(), folder_ / "bad.yaml", &silent);
    ASSERT_EQ(plan.outcomes.size(), 1u);
    EXPECT_THAT(plan.outcomes[0].message, HasSubstr("bad.yaml:4:"));
    EXPECT_THAT(plan.outcomes[0].message, HasSubstr("away from the object"));
    EXPECT_EQ(plan.outcomes[0].experiment, "");
    EXPECT_THAT(PlanSummary(plan), HasSubstr("The model can play none of these recordings."));
    EXPECT_THAT(PlanSummary(plan), HasSubstr("away from the object"));
  }

  // A file stands where the folder of the experiment would be.
  void ExpectThePlanIsKeptWithoutItsExperiment() const {
    std::ofstream(folder_ / "blocked.yaml")
        << "schema_version: 1\nstock: false\nprotocols:\n  - {name: blocked, pull: 3}\n";
    std::ofstream(PlanFile(Run()).parent_path() / "blocked") << "in the way";
    SilentProgress silent;
    EXPECT_THROW(RunPlan(Run(), folder_ / "blocked.yaml", &silent), InputError);
    std::ifstream stream(PlanFile(Run()));
    const nlohmann::json outcome = nlohmann::json::parse(stream).at("outcomes").at(0);
    EXPECT_EQ(outcome.at("name"), "blocked");
    EXPECT_EQ(outcome.at("experiment"), "");
  }

  // A diagnosis that does not belong to the fit is not denied.
  void ExpectAnotherDiagnosisIsNotUsed() const {
    std::ofstream(Run() / "diagnosis/diagnosis.json", std::ios::app) << "\n";
    SilentProgress silent;
    EXPECT_THAT([&] { RunPlan(Run(), {}, &silent); },
                ThrowsMessage<InputError>(HasSubstr("is of an earlier fit")));
    std::filesystem::remove_all(Run() / "diagnosis");
    EXPECT_THAT([&] { RunPlan(Run(), {}, &silent); },
                ThrowsMessage<InputError>(HasSubstr("has not been diagnosed")));
  }

  TemporaryFolder folder_;
};

// One test, because the diagnosis that it starts from takes most of its time.
TEST_F(PlanOfABar, PrefersWhatPartsTheRivals) {
  Protocol again = Named("again"), stronger = Named("stronger"), away = Named("away");
  stronger.pull = 2;
  away.weight = Protocol::Weight{0.001, {1, 0, 0}, 0.01};
  const PlanRecord plan = Plan({away, again, stronger});
  ASSERT_GE(plan.rivals.size(), 2u) << plan.verdict;
  double sum = 0;
  for (const PlannedRival& rival : plan.rivals) sum += rival.probability;
  EXPECT_NEAR(sum, 1, 1e-9);
  ASSERT_EQ(plan.outcomes.size(), 3u);
  EXPECT_EQ(plan.outcomes[0].name, "stronger");
  EXPECT_EQ(plan.outcomes[1].name, "again");
  EXPECT_THAT(plan.outcomes[2].message, HasSubstr("away from the object"));  // the last
  const PlannedOutcome &best = plan.outcomes[0], &repeated = plan.outcomes[1];
  ASSERT_EQ(best.pairs.size(), repeated.pairs.size());
  ASSERT_FALSE(best.pairs.empty());
  for (size_t k = 0; k < best.pairs.size(); ++k) {
    const PlannedPair &a = repeated.pairs[k], &b = best.pairs[k];
    // The repetition has all frames of the recording, which the fit has not; its mesh and step
    // errors are taken to be new.
    EXPECT_GT(a.lambda_then, 1.4 * a.lambda_now) << a.first << " " << a.second;
    EXPECT_LT(a.lambda_then, 3 * a.lambda_now) << a.first << " " << a.second;
    EXPECT_GT(b.lambda_then, a.lambda_then) << a.first << " " << a.second;
  }
  for (const PlannedSize& size : best.sizes) {
    EXPECT_GT(size.half_width_then, 0) << size.effect;
    EXPECT_LT(size.half_width_then, size.half_width_now) << size.effect;
  }
  EXPECT_GE(best.probability, repeated.probability);

  // It does not depend on the number of threads.
  Protocol turned = Named("turned");
  turned.turn = Eigen::Vector3d::UnitY();
  const int threads = ThreadCount();
  const auto with = [&](int count) {
    SetThreadCount(count);
    const PlanRecord plan = Plan({again, turned});
    const std::filesystem::path file = folder_ / "plan.json";
    WritePlanFile(plan, file);
    std::ifstream stream(file);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string one = with(1);
  EXPECT_EQ(with(2), one);
  SetThreadCount(threads);

  // It is kept with the run and told in words.
  std::ofstream(folder_ / "protocols.yaml")
      << "schema_version: 1\nstock: false\nprotocols:\n  - {name: harder, pull: 3}\n";
  SilentProgress silent;
  const PlanRecord kept = RunPlan(Run(), folder_ / "protocols.yaml", &silent);
  std::ifstream stream(PlanFile(Run()));
  const nlohmann::json written = nlohmann::json::parse(stream);
  EXPECT_EQ(written.at("diagnosis"), HashFile(Run() / "diagnosis/diagnosis.json"));
  EXPECT_EQ(written.at("outcomes").size(), 1u);
  EXPECT_EQ(written.at("outcomes")[0].at("name"), "harder");
  const std::string text = PlanReport(kept);
  EXPECT_THAT(text, HasSubstr("The diagnosis cannot tell apart"));
  EXPECT_THAT(text, HasSubstr("3 times the pull"));
  EXPECT_THAT(text, HasSubstr("least λ"));

  ExpectWhatTheDiagnosisHasNotSimulatedIsSimulated();
  ExpectAPairIsWeighed(stronger);
  ExpectPlayable(kept);
  ExpectFailuresAreSaid();
  ExpectThePlanIsKeptWithoutItsExperiment();
  ExpectAnotherDiagnosisIsNotUsed();
}

}  // namespace
}  // namespace lacuna
