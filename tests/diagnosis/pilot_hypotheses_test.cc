#include "diagnosis/pilot_hypotheses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "diagnosis/diagnosed_bar.h"
#include "diagnosis/model_change.h"
#include "diagnosis/plane_proposals.h"
#include "diagnosis/recorded_diagnosis.h"
#include "effects/catalogue.h"
#include "report/verdict_text.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;

// The truth has a finer mesh and shorter steps; the error of the model is about 1.5 to 2 σ.
constexpr double kDiscretisationError = 2;  // σ
// The bar, 20 mm wide, is released at y > 0 and swings to y < 0, where it meets this plane.
constexpr double kPlane = -0.0125;  // m

HeldBarTruth BesideAPlane() {
  HeldBarTruth truth;
  truth.hidden = {MakeEffect(
      "plane_contact",
      {{"stiffness", 3e7}, {"normal_x", 0}, {"normal_y", 1}, {"normal_z", 0}, {"offset", kPlane}})};
  return truth;
}

const RankedEffect* Find(const Diagnosis& diagnosis, const std::string& type) {
  for (const RankedEffect& effect : diagnosis.ranking)
    if (effect.scored.candidate.type == type) return &effect;
  return nullptr;
}

bool IsUntried(const std::vector<UntriedEffect>& untried, const std::string& type) {
  for (const UntriedEffect& effect : untried)
    if (effect.type == type) return true;
  return false;
}

// The pilots of the bar's model with the true parameters.
struct PilotsOfBar {
  TemporaryFolder folder;
  PredictionStudy study;
  std::vector<ProposedPlane> planes;
  LinearisedMisfit misfit;
  PilotHypotheses pilots;
  Eigen::VectorXd moduli;  // of the material, as the problem has them

  explicit PilotsOfBar(const HeldBarTruth& truth) {
    WriteBarRecording(folder.Path(), FilmHeldBar(truth));
    study = ReadBarStudy(folder.Path());
    const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
    Eigen::VectorXd values = problem.Start();
    values[0] = truth.young_modulus;
    values[1] = truth.alpha;
    values.segment<3>(2) = truth.hold_force;
    values[5] = truth.clock;
    moduli = problem.StudyAt(values).effects.front()->Parameters();
    misfit = problem.Linearise(values);
    planes = ProposePlanes(problem, values, misfit);
    pilots = RunPilots(problem, values, misfit, {"corotational"});
  }
};

TEST(PilotHypotheses, TryThePlaneThatThePredictedBodyCrosses) {
  const PilotsOfBar bar(BesideAPlane());
  ASSERT_FALSE(bar.planes.empty());
  EXPECT_GT(bar.planes.front().normal.y(), 0.9);
  // m: the edge penetrates the plane by some tenths of a millimetre, and the nearest marker is as
  // far away from the edge.
  EXPECT_NEAR(bar.planes.front().offset, kPlane, 1.2e-3);
  EXPECT_GT(bar.planes.front().crossing, 1e-3);
  EXPECT_FALSE(IsUntried(bar.pilots.untried, "plane_contact"));
  for (const PilotHypothesis& pilot : bar.pilots.tried) {
    ASSERT_EQ(pilot.change.size(), bar.misfit.residual.size());
    if (pilot.candidate.type != "plane_contact") continue;
    // With the true parameters the most deeply crossed plane explains most of the residual.
    EXPECT_LT((bar.misfit.residual + pilot.change).norm(), 0.5 * bar.misfit.residual.norm());
    break;
  }
}

TEST(PilotHypotheses, TryNoPlaneIfThePredictedBodyCrossesNone) {
  const PilotsOfBar bar({});
  EXPECT_TRUE(bar.planes.empty());
  EXPECT_TRUE(IsUntried(bar.pilots.untried, "plane_contact"));
  std::vector<std::string> tried;
  for (const PilotHypothesis& pilot : bar.pilots.tried) {
    tried.push_back(pilot.candidate.type);
    EXPECT_TRUE(pilot.candidate.replaces_material);
    // Another law with the same moduli changes the motion, though not by much.
    EXPECT_GT(pilot.change.norm(), 0);
    EXPECT_EQ(pilot.candidate.effect->Parameters(), bar.moduli);
  }
  EXPECT_THAT(tried, testing::ElementsAre("linear", "st_venant_kirchhoff"));
}

TEST(PilotHypotheses, AnElasticityLawTakesOverTheFittedModuli) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  CandidateEffect law;
  law.type = "linear";
  law.replaces_material = true;
  law.effect = FindEntry("linear")->make(study.effects.front()->Parameters());
  const PredictionStudy with = WithCandidate(study, law);
  EXPECT_EQ(with.effects.size(), study.effects.size());
  EXPECT_EQ(with.effects.front(), law.effect);
  ASSERT_EQ(with.fitted.size(), study.fitted.size());
  EXPECT_EQ(with.fitted[0].places[0].effect, 0u) << "the material";
  EXPECT_EQ(with.fitted[1].places, study.fitted[1].places);  // of the damping
}

TEST(Diagnosis, PrefersAPlaneThatTheBarMeets) {
  const Diagnosis diagnosis = DiagnoseBar(BesideAPlane(), {});
  EXPECT_GT(diagnosis.errors.rms_over_sigma, kDiscretisationError);
  const RankedEffect* contact = Find(diagnosis, "plane_contact");
  ASSERT_NE(contact, nullptr);
  ASSERT_TRUE(contact->refitted);
  EXPECT_LT(contact->errors.rms_over_sigma, 0.55 * diagnosis.errors.rms_over_sigma);
  for (const RankedEffect& other : diagnosis.ranking) {
    if (other.refitted && &other != contact) {
      EXPECT_LT(other.evidence, contact->evidence);
    }
  }
  for (const std::string& named : diagnosis.effects)
    EXPECT_EQ(named, "plane_contact") << ExplainVerdict(RecordOf(diagnosis));
}

TEST(Diagnosis, HasNothingForContactWhereNothingIsMet) {
  const Diagnosis diagnosis = DiagnoseBar({}, {});
  const RankedEffect* contact = Find(diagnosis, "plane_contact");
  EXPECT_EQ(contact == nullptr, IsUntried(diagnosis.untried, "plane_contact"));
  // Such a plane would come from the error of the mesh, which the nuisance explains.
  if (contact != nullptr) {
    EXPECT_LT(contact->scored.score.evidence, 3);
  }
  // At such small strains the laws differ by less than the noise, so none has evidence.
  for (const char* law : {"linear", "corotational", "st_venant_kirchhoff"}) {
    ASSERT_NE(Find(diagnosis, law), nullptr) << law;
    EXPECT_LT(Find(diagnosis, law)->scored.score.evidence, 3) << law;
  }
}

TEST(Diagnosis, NamesNoWrongEffectWhereAnotherLawIsMissing) {
  HeldBarTruth truth;
  truth.law = "st_venant_kirchhoff";
  truth.hold_force = {0, 0.25, 0.1};  // bends the bar by a third of its length
  const Diagnosis diagnosis = DiagnoseBar(truth, {});
  ASSERT_FALSE(diagnosis.ranking.empty());
  EXPECT_THAT(diagnosis.ranking.front().scored.candidate.type,
              AnyOf("st_venant_kirchhoff", "strain_stiffening"));
  // The error of the coarse mesh is so large that the verdict may name nothing.
  if (diagnosis.verdict == Verdict::kMissing) {
    EXPECT_EQ(diagnosis.effects.front(), "st_venant_kirchhoff")
        << ExplainVerdict(RecordOf(diagnosis));
  }
  if (diagnosis.verdict == Verdict::kAmbiguous) {
    EXPECT_THAT(diagnosis.effects, Contains("st_venant_kirchhoff"));
  }
}

}  // namespace
}  // namespace lacuna
