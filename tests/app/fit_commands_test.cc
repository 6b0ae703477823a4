// `lacuna fit`, and the commands that work on its run: compare, diagnose, add and export.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "app/command_line.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

TEST(CommandLine, CompareWantsARunOfFit) {
  const TemporaryFolder folder;
  const Ending ending = Lacuna("compare " + folder.Path().string());
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("is not a run"));
  EXPECT_THAT(ending.said, HasSubstr("lacuna fit"));
  EXPECT_EQ(Lacuna("compare").status, 2);
}

TEST(CommandLine, DiagnoseIsToldHowFarToGo) {
  EXPECT_THAT(Lacuna("diagnose --help").said, HasSubstr("--until-done"));
  // What only makes sense with --until-done.
  EXPECT_EQ(Lacuna("diagnose /nowhere --follow-best").status, 2);
  EXPECT_EQ(Lacuna("diagnose /nowhere --most 2").status, 2);
  const Ending ending = Lacuna("diagnose /nowhere --until-done");
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("/nowhere"));
}

// The bundled recording of a hidden effect, with a coarse model.
TEST(CommandLine, DiagnosesTheBundledRecordingAndKeepsALedger) {
  const TemporaryFolder folder;
  std::ofstream(folder / "coarse.yaml")
      << "use: " << Experiment("hidden_effect.yaml") << "\noutput: run\n"
      << "mesh: {max_volume: 4000 mm^3, order: 2, preserve_surface: false}\n"
      << "motion: {time_step: 6 ms}\n";
  const Ending fit = Lacuna("fit " + (folder / "coarse.yaml").string());
  ASSERT_EQ(fit.status, 0) << fit.said;
  const std::string command =
      "diagnose " + (folder / "run").string() + " --refits 1 --until-done --most 0 --verbose";
  const Ending first = Lacuna(command);
  ASSERT_EQ(first.status, 0) << first.said;
  EXPECT_THAT(first.said, HasSubstr("held-out error before"));
  EXPECT_THAT(first.said, HasSubstr("tried  viscoelastic_branch"));
  EXPECT_TRUE(std::filesystem::exists(folder / "run/ledger.json"));
  EXPECT_THAT(Lacuna(command).said, HasSubstr("read back"));
  const Ending info = Lacuna("info " + (folder / "run").string());
  EXPECT_EQ(info.status, 0) << info.said;
  EXPECT_THAT(info.said, HasSubstr("young_modulus"));
}

// So far off that a whole step towards it overshoots.
TEST(CommandLine, FitTellsWhatFinerElementsWouldBeFittedWith) {
  const TemporaryFolder folder;
  std::ofstream(folder / "near.yaml")
      << "use: " << Experiment("hidden_effect.yaml") << "\noutput: run\n"
      << "material: {law: neo_hookean, young_modulus: 64 kPa, poisson_ratio: 0.411}\n"
      << "effects:\n"
      << "  - {type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}\n"
      << "  - {type: viscoelastic_branch, modulus: 11 kPa, relaxation_time: 50 ms, "
         "poisson_ratio: 0.411}\n"
      << "fit: {parameters: [{name: young_modulus}, {name: poisson_ratio}, "
         "{name: viscoelastic_branch.modulus}, {name: viscoelastic_branch.relaxation_time}]}\n";
  const Ending fit = Lacuna("fit --verbose " + (folder / "near.yaml").string());
  ASSERT_EQ(fit.status, 0) << fit.said;
  EXPECT_THAT(fit.said, HasSubstr("with finer elements"));
}

// The same bar, held for as long as it is filmed.
TEST(CommandLine, WhatNeedsMotionIsNotAddedToABarAtRest) {
  const TemporaryFolder folder;
  std::filesystem::copy(Experiment("recordings/hidden_effect/recording_1"), folder / "held");
  std::ifstream moving(folder / "held/markers.csv");
  std::string header, row;
  std::getline(moving, header);
  std::getline(moving, row);
  moving.close();
  std::ofstream still(folder / "held/markers.csv");
  still << header << "\n";
  for (int frame = 0; frame < 10; ++frame)
    still << 0.01 * frame << row.substr(row.find(',')) << "\n";
  still.close();
  std::ofstream(folder / "rest.yaml")
      << "use: " << Experiment("hidden_effect.yaml") << "\noutput: run\nnoise: 0.1 mm\n"
      << "mesh: {max_volume: 4000 mm^3, order: 2, preserve_surface: false}\n"
      << "fit: {parameters: [{name: young_modulus}]}\n"
      << "recordings: [{recording: held, hold: {release: 0.09 s, region: {half_space: "
         "{point: [69.4374 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}]\n";
  const Ending fit = Lacuna("fit " + (folder / "rest.yaml").string());
  ASSERT_EQ(fit.status, 0) << fit.said;
  EXPECT_THAT(fit.said, HasSubstr("warning: nothing moves in the frames that are fitted"));
  const Ending add = Lacuna("add " + (folder / "run").string() + " drag");
  EXPECT_EQ(add.status, 2);
  EXPECT_THAT(add.said, HasSubstr("run: drag "));
  EXPECT_FALSE(std::filesystem::exists(folder / "hidden_effect+drag"));
  EXPECT_THAT(Lacuna("add " + (folder / "run").string() + " swelling_field").said,
              HasSubstr("cannot be added automatically: a part of it is an expression"));
}

// The first recording of a hidden effect with very few elements and one unknown.
std::string FitSmallModel(const TemporaryFolder& folder) {
  std::ofstream(folder / "small.yaml")
      << "use: " << Experiment("hidden_effect.yaml") << "\noutput: run\n"
      << "mesh: {max_volume: 8000 mm^3, order: 2, preserve_surface: false}\n"
      << "motion: {time_step: 10 ms}\nfit: {parameters: [{name: young_modulus}]}\n"
      << "recordings: [{recording: " << Experiment("recordings/hidden_effect/recording_1")
      << ", to: 0.2 s, hold: {release: 0.1037 s, region: {half_space: "
         "{point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}]\n";
  const Ending fit = Lacuna("fit " + (folder / "small.yaml").string());
  EXPECT_EQ(fit.status, 0) << fit.said;
  return folder / "run";
}

TEST(CommandLine, AFittedModelIsExportedAndWhatIsExportedIsImported) {
  const TemporaryFolder folder;
  const std::string run = FitSmallModel(folder);
  const Ending mesh = Lacuna("export " + run + " --to msh");
  ASSERT_EQ(mesh.status, 0) << mesh.said;
  EXPECT_THAT(FileContent(folder / "run/export/msh/model.msh"), HasSubstr("$MeshFormat"));
  EXPECT_THAT(FileContent(folder / "run/export/msh/model.json"), HasSubstr("stiffness_damping"));

  const std::string febio = "export " + run + " --to feb";
  const Ending refused = Lacuna(febio);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("stiffness_damping: none"));
  EXPECT_THAT(refused.said, HasSubstr("--allow-missing"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/export/feb"));
  const Ending allowed = Lacuna(febio + " --allow-missing");
  EXPECT_EQ(allowed.status, 0) << allowed.said;
  EXPECT_THAT(FileContent(folder / "run/export/feb/model.feb"), HasSubstr("<febio_spec"));

  ASSERT_EQ(Lacuna("export " + run + " --to inp --output " + (folder / "inp").string()).status, 0);
  const Ending imported = Lacuna("import " + (folder / "inp/model.inp").string() +
                                 " --unit m --output " + (folder / "study").string());
  EXPECT_EQ(imported.status, 0) << imported.said;
  EXPECT_THAT(imported.said, HasSubstr("tetrahedra of order 2"));
  for (const char* file : {"model.msh", "model.yaml", "recording.yaml", "nodes_CLAMP.txt"})
    EXPECT_TRUE(std::filesystem::exists(folder / "study" / file)) << file;
  EXPECT_THAT(Lacuna("export " + run + " --to imp").said, HasSubstr("did you mean \"inp\"?"));
  EXPECT_THAT(Lacuna("export " + run + " --to inp --until 0.05").said,
              HasSubstr("leaves nothing of the motion"));
}

}  // namespace
}  // namespace lacuna
