#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "comparison/comparison.h"
#include "prediction/prediction_study_reader.h"
#include "record/csv_table.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

ProgressOptions Silent() {
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  return silent;
}

TEST(ComparedMotion, TellsStrainAndHeightAndWritesFieldsAndTheForce) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 8;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const std::filesystem::path experiment = folder / "study.yaml";
  const std::string text =
      BarExperiment(folder.Path(), {{"name: bar\nmesh", "name: bar\noutput: run\nmesh"},
                                    {"{name: young_modulus}, {name: mass_damping.alpha}", ""},
                                    {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"}});
  std::ofstream(experiment) << text;
  Progress progress(Silent());
  ASSERT_TRUE(RunCalibration(ReadPredictionStudy(Config::Load(experiment)), &progress).usable);

  const std::filesystem::path run = folder / "run";
  Comparison comparison = CompareRun(run);
  CompareMotion(run, &progress, &comparison);
  EXPECT_THAT(comparison.notes, testing::IsEmpty());
  const ComparedRecording& bar = comparison.recordings.at(0);
  EXPECT_TRUE(bar.height_by_gravity);
  for (const ComparedPart& part : bar.parts) {
    std::vector<std::string> quantities;
    for (const ErrorAgainst& against : part.against) quantities.push_back(against.quantity);
    EXPECT_THAT(quantities, testing::IsSupersetOf({"strain", "strain_rate_per_s", "height_m"}));
  }
  // A soft bar of 80 mm that hangs by some 10 mm: its surface strains by a few percent.
  const std::vector<ResidualBin>& strain = (bar.parts[0].against.end() - 3)->bins;
  EXPECT_GT(strain.back().mean, 0.005);
  EXPECT_LT(strain.back().mean, 0.2);
  ASSERT_TRUE(bar.force && bar.force->usable);
  EXPECT_THAT(ComparisonInWords(comparison), Contains(HasSubstr("it drains the motion")));

  SaveComparison(comparison, run);
  const CsvTable force = LoadCsv(run / "comparison/unexplained_force.csv");
  EXPECT_EQ(force[0].values.size(), bar.force->times.size());
  std::ifstream stream(run / "comparison/comparison.json");
  const nlohmann::json record = nlohmann::json::parse(stream);
  EXPECT_TRUE(record.at("recordings").at(0).at("unexplained_force").at("stands_out"));
  EXPECT_EQ(record.at("recordings").at(0).at("height_along"), "against gravity");
  // 21 of the 26 frames lie after the release, and in the five before the bar rests.
  EXPECT_EQ(bar.field_frames, 22);
  for (const char* file :
       {"body.pvd", "markers.pvd", "fields/body_00004.vtu", "fields/body_00025.vtu"})
    EXPECT_TRUE(std::filesystem::exists(run / "comparison/0" / file)) << file;

  // With another experiment it is not that model any more.
  std::ofstream(experiment) << text << "density: 900 kg/m^3\n";
  Comparison changed = CompareRun(run);
  CompareMotion(run, &progress, &changed);
  EXPECT_THAT(changed.notes, Contains(HasSubstr("has changed since")));
  EXPECT_FALSE(changed.recordings.at(0).force);
}

}  // namespace
}  // namespace lacuna
