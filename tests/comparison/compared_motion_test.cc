// The comparison of a model with markers, for which it is run again.
#include "comparison/compared_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "comparison/coarse_bar.h"
#include "comparison/comparison_files.h"
#include "record/csv_table.h"
#include "record/motion_record.h"
#include "report/comparison_report.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(ComparedMotion, SaysThatForcesAreOfUnknownScaleWhereAModulusIsNotDetermined) {
  FittedParameter modulus, ratio;
  modulus.name = "young_modulus";
  modulus.unit = "Pa";
  ratio.name = "poisson_ratio";
  ratio.estimate.determination = Determination::kFlat;
  EXPECT_FALSE(NoteOnScale({modulus, ratio}));
  modulus.estimate.determination = Determination::kFlat;
  EXPECT_THAT(NoteOnScale({ratio, modulus}),
              testing::Optional(HasSubstr("do not determine young_modulus")));
}

TEST(ComparedMotion, AddsStrainAndHeightAndWritesFieldsAndTheForce) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 8;  // 1/s; the model has 1
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  ASSERT_TRUE(RunBarWithLittleDamping(folder.Path(), "1.5 ms"));
  const std::filesystem::path run = folder / "run";
  const Comparison comparison = CompareWithMotion(run);
  EXPECT_THAT(comparison.record.notes, testing::IsEmpty());
  const ComparedRecording& bar = comparison.record.recordings.at(0);
  EXPECT_TRUE(bar.height_by_gravity);
  // The number that the fit has printed.
  EXPECT_NEAR(bar.parts[0].error.rms_over_sigma,
              ReadCalibration(run).recordings[0].in_fit.rms_over_sigma, 1e-9);
  ExpectTrendsOfTheMotion(bar);
  ASSERT_TRUE(bar.force && bar.force->usable);
  EXPECT_THAT(DescribeComparison(comparison.record),
              Contains(HasSubstr("it removes energy from the motion")));

  WriteComparison(comparison, run);
  const CsvTable force = ReadCsv(run / "comparison/unexplained_force.csv");
  EXPECT_EQ(force[0].values.size(), comparison.forces.at(0)->history.times.size());
  std::ifstream stream(run / "comparison/comparison.json");
  const nlohmann::json record = nlohmann::json::parse(stream);
  EXPECT_TRUE(record.at("recordings").at(0).at("unexplained_force").at("is_significant"));
  EXPECT_EQ(record.at("recordings").at(0).at("height_along"), "against gravity");
  // 21 of the 26 frames lie after the release; in the five before it the bar rests.
  EXPECT_EQ(bar.field_frames, 22);
  for (const char* file :
       {"body.pvd", "markers.pvd", "fields/body_00004.vtu", "fields/body_00025.vtu"})
    EXPECT_TRUE(std::filesystem::exists(run / "comparison/0" / file)) << file;

  const StoredMotion motion = ReadMotionFile(MotionFile(run, 0));
  EXPECT_EQ(motion.times.size(), 26u);
  ExpectForceInMotion(motion, comparison.record.fit);

  // With a changed experiment the model is no longer the one that was fitted.
  std::ofstream(folder / "study.yaml", std::ios::app) << "density: 900 kg/m^3\n";
  const Comparison changed = CompareWithMotion(run);
  EXPECT_THAT(changed.record.notes, Contains(HasSubstr("has changed since")));
  EXPECT_FALSE(changed.record.recordings.at(0).force);
}

}  // namespace
}  // namespace lacuna
