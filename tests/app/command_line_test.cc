// The program as a user meets it: what it prints, and how it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "core/config.h"
#include "effects/catalogue.h"
#include "scan/recording_writer.h"
#include "support/ended_program.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

Ending Lacuna(const std::string& arguments) {
  return EndingOf(std::string(LACUNA_PROGRAM) + " " + arguments);
}

std::string Experiment(const std::string& name) {
  return std::string(LACUNA_SOURCE_DIR) + "/experiments/" + name;
}

// A bar of few elements that is bent in two frames and scanned.
std::string WriteSmallScene(const TemporaryFolder& folder) {
  const std::filesystem::path file = folder / "scene.yaml";
  std::ofstream(file) << R"(schema_version: 1
name: small
bar: {size: [100 mm, 30 mm, 30 mm], edge_radius: 5 mm, edge_length: 10 mm}
mesh: {max_volume: 500 mm^3}
density: 1000 kg/m^3
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
grips: [{region: {name: clamp, half_space: {point: [-40 mm, 0 mm, 0 mm], normal: [-1, 0, 0]}}}]
loads: [{region: {half_space: {point: [40 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}, force: [0 N, 0 N, -0.3 N]}]
motion: {frame_rate: 20 Hz, frames: 3, steps_per_frame: 1}
scanner: {cameras: 2, look_at: [0 m, 0 m, 0 m], distance: 0.4 m, field_of_view: 24 deg, noise: 0.3 mm}
)";
  return file;
}

TEST(CommandLine, HelpNamesEveryCommand) {
  const Ending help = Lacuna("--help");
  EXPECT_EQ(help.status, 0);
  for (const char* command :
       {"reconstruct", "fit", "compare", "diagnose", "add", "sweep", "simulate", "info", "validate",
        "effects", "explain", "export", "import"})
    EXPECT_THAT(help.said, HasSubstr(command));
  EXPECT_EQ(Lacuna("--version").status, 0);
}

TEST(CommandLine, TellsAnUnknownCommandAndWhatWasMeant) {
  const Ending ending = Lacuna("recontruct x.yaml");
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("did you mean \"reconstruct\"?"));
  EXPECT_THAT(Lacuna("info --bogus " + Experiment("bend.yaml")).said, HasSubstr("\"--bogus\""));
}

TEST(CommandLine, RefusesWhatDoesNotFitIntoTheMemoryLimit) {
  const TemporaryFolder folder;
  std::ofstream(folder / "e.yaml")
      << "use: " << Experiment("hidden_effect.yaml") << "\noutput: run\n";
  const Ending ending = Lacuna("--memory-limit 1MB fit " + (folder / "e.yaml").string());
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("more than the limit of 1 MB"));
  EXPECT_EQ(Lacuna("--memory-limit 0 effects").status, 2);
}

TEST(CommandLine, AnAbsentFileIsNamed) {
  for (const char* command : {"reconstruct", "fit", "compare", "simulate", "info", "validate"}) {
    const Ending ending = Lacuna(std::string(command) + " /nowhere/e.yaml");
    EXPECT_EQ(ending.status, 2) << command;
    EXPECT_THAT(ending.said, HasSubstr("/nowhere/e.yaml")) << command;
  }
}

TEST(CommandLine, ValidatesTheBundledExperimentsAndScenes) {
  for (const char* file : {"bend.yaml", "hidden_effect.yaml", "scenes/bend.yaml",
                           "scenes/twist.yaml", "recordings/bend"})
    EXPECT_EQ(Lacuna("validate " + Experiment(file)).status, 0) << file;
  EXPECT_THAT(Lacuna("validate " + Experiment("bend.yaml") + " --show").said,
              HasSubstr("young_modulus"));
}

TEST(CommandLine, ValidateRefusesWhatAFitWould) {
  const TemporaryFolder folder;
  std::string text = FileContent(Experiment("hidden_effect.yaml"));
  const auto replace = [&text](const std::string& from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  };
  replace("recording: recordings", "recording: " + Experiment("recordings"));
  const std::string file = folder / "experiment.yaml";
  std::ofstream(file) << text;
  EXPECT_EQ(Lacuna("validate " + file).status, 0);
  replace("71.4274 mm", "714 mm");  // beside the bar
  std::ofstream(file) << text;
  const Ending ending = Lacuna("validate " + file);
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("hold of "));
}

TEST(CommandLine, ListsTheEffects) {
  const Ending list = Lacuna("effects");
  EXPECT_EQ(list.status, 0);
  for (const CatalogueEntry& entry : Catalogue())
    EXPECT_THAT(list.said, HasSubstr(entry.card->type));
  EXPECT_THAT(Lacuna("explain gravity").said, HasSubstr("f_i = m_i g"));
  EXPECT_THAT(Lacuna("explain gravty").said, HasSubstr("did you mean \"gravity\"?"));
  const std::string jitter = Lacuna("explain time_jitter").said;
  EXPECT_THAT(jitter, HasSubstr("check the camera's clock"));
  EXPECT_THAT(jitter, HasSubstr("`every`"));  // reduces the number of frames
  EXPECT_EQ(Lacuna("explain").status, 2);
}

// The YAML that `explain` ends with can be pasted as it is.
void ExpectUnderstood(const std::string& yaml, const CatalogueEntry& entry) {
  const auto material = MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}});
  const Config config = Config::Parse(yaml, "pasted.yaml");
  std::shared_ptr<const Effect> effect;
  if (entry.kind == CatalogueEntry::Kind::kMaterial) {
    ASSERT_NO_THROW(effect = MakeMaterial(config.Child("material")));
  } else {
    ASSERT_NO_THROW(effect = MakeEffect(config.Items("effects").at(0), material.get(),
                                        Eigen::Vector3d(0, 0, -9.80665)));
  }
  EXPECT_NO_THROW(config.RefuseUnknownKeys());
  EXPECT_EQ(effect->Card().type, entry.card->type);
}

TEST(CommandLine, EveryEffectTellsOfItself) {
  for (const CatalogueEntry& entry : Catalogue()) {
    const Ending told = Lacuna("explain " + entry.card->type);
    SCOPED_TRACE(told.said);
    EXPECT_EQ(told.status, 0);
    EXPECT_THAT(told.said, HasSubstr(entry.card->title));
    for (const char* section :
         {"Equation", "Source", "Parameters", "When it is missing", "How to distinguish it"})
      EXPECT_THAT(told.said, HasSubstr("\n" + std::string(section) + "\n  "));
    for (const std::string& other : entry.card->look_alikes)
      EXPECT_THAT(told.said, HasSubstr(FindEntry(other)->card->title));
    const size_t paste = told.said.find("\nExample (");
    ASSERT_NE(paste, std::string::npos);
    ExpectUnderstood(told.said.substr(told.said.find('\n', paste + 1) + 1), entry);
  }
  const std::string own_law = Lacuna("explain expression").said;
  EXPECT_THAT(own_law, HasSubstr("docs/expression.md"));
  EXPECT_THAT(own_law, HasSubstr("Tried if the experiment lists the law among its candidates."));
  EXPECT_THAT(Lacuna("explain swelling_field").said, HasSubstr("Not tried"));
}

TEST(CommandLine, WhatIsSimulatedIsAnOrdinaryRecording) {
  const TemporaryFolder folder;
  const std::string scan = (folder / "scan").string();
  const std::string simulate = "simulate " + WriteSmallScene(folder) + " -o " +
                               (folder / "run").string() + " --recording " + scan;
  const Ending made = Lacuna(simulate);
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_TRUE(std::filesystem::exists(folder / "run/body.pvd"));
  EXPECT_EQ(Lacuna("validate " + scan).status, 0);
  const Ending info = Lacuna("info " + scan);
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.said, HasSubstr("3 point clouds"));
  EXPECT_EQ(Lacuna(simulate).status, 0) << "what was simulated may be simulated again";

  // What an interruption leaves while the recording is written.
  std::ofstream(scan + "/recording.yaml") << "# " << kSimulated << "\n";
  std::filesystem::remove_all(scan + "/truth");
  const Ending again = Lacuna(simulate);
  EXPECT_EQ(again.status, 0) << again.said;
  EXPECT_EQ(Lacuna("validate " + scan).status, 0);
}

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

// Names that lead upwards: of an experiment, and of the recordings of one.
TEST(CommandLine, WhatIsWrittenStaysInItsFolder) {
  const TemporaryFolder folder;
  std::string text = FileContent(WriteSmallScene(folder));
  text.replace(text.find("name: small"), 11, "name: ../../ESC");
  std::ofstream(folder / "scene.yaml") << text;
  const Ending scene = Lacuna("simulate " + (folder / "scene.yaml").string());
  EXPECT_EQ(scene.status, 2);
  EXPECT_THAT(scene.said, HasSubstr("scene.yaml:2:7: name: names a folder"));

  const auto recording = [](const std::string& name) {
    return "  - {name: \"" + name +
           "\", recording: " + Experiment("recordings/hidden_effect/recording_1") +
           ", to: 0.12 s, hold: {release: 0.1037 s, force: [0 N, 0 N, 0.05 N], region: "
           "{half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}\n";
  };
  const std::string begin = "use: " + Experiment("hidden_effect.yaml") +
                            "\nmesh: {max_volume: 8000 mm^3, order: 2, preserve_surface: false}\n"
                            "motion: {time_step: 10 ms}\nrecordings:\n";
  std::filesystem::create_directories(folder / "a");
  std::ofstream(folder / "a/e.yaml") << begin << recording("..") << recording("../../ESC");
  const std::string simulate = "simulate " + (folder / "a/e.yaml").string() + " -o " +
                               (folder / "a/out").string() + " --recording " +
                               (folder / "a/played").string();
  const Ending played = Lacuna(simulate);
  EXPECT_EQ(played.status, 0) << played.said;
  EXPECT_THAT(played.said, HasSubstr("its markers have no errors")) << "noise is not given";
  EXPECT_TRUE(std::filesystem::exists(folder / "a/out/_./body.pvd"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a/played/_._.._ESC/recording.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a/body.pvd"));
  EXPECT_FALSE(std::filesystem::exists(folder / "ESC"));

  std::ofstream(folder / "a/e.yaml") << begin << recording("a b") << recording("a/b");
  const Ending same = Lacuna(simulate);
  EXPECT_EQ(same.status, 2);
  EXPECT_THAT(same.said, HasSubstr("recording a/b would have the same folder, a_b, as another"));
}

// The errors of two synthetic data sets are independent, unless one is a repetition of the other.
TEST(CommandLine, SimulatedExperimentsHaveErrorsOfTheirOwn) {
  const TemporaryFolder folder;
  const auto markers = [&](const std::string& name, const std::string& options) {
    std::ofstream(folder / "e.yaml")
        << "use: " << Experiment("hidden_effect.yaml") << "\nname: " << name
        << "\nnoise: 0.1 mm\n"
           "mesh: {max_volume: 8000 mm^3, order: 2, preserve_surface: false}\n"
           "motion: {time_step: 10 ms}\nrecordings:\n  - {name: pull, recording: "
        << Experiment("recordings/hidden_effect/recording_1")
        << ", to: 0.12 s, hold: {release: 0.1037 s, force: [0 N, 0 N, 0.05 N], region: "
           "{half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}\n";
    const Ending ending =
        Lacuna("simulate " + (folder / "e.yaml").string() + " -o " + (folder / "out").string() +
               " --recording " + (folder / "played").string() + options);
    EXPECT_EQ(ending.status, 0) << ending.said;
    return FileContent(folder / "played/markers.csv");
  };
  const std::string first = markers("one", "");
  EXPECT_EQ(markers("one", ""), first);
  EXPECT_NE(markers("two", ""), first);
  EXPECT_NE(markers("one", " --seed 1"), first);
}

TEST(CommandLine, AnUnwritableOutputIsToldBeforeTheComputation) {
  const TemporaryFolder folder;
  std::ofstream(folder / "occupied") << "a file";
  const Ending ending =
      Lacuna("simulate " + WriteSmallScene(folder) + " -o " + (folder / "occupied/run").string());
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("occupied"));
  EXPECT_THAT(ending.said, Not(HasSubstr("largest displacement")));
}

// A reconstruction of a few frames, in two sizes of its mesh and one that cannot be.
TEST(CommandLine, ASweepIsPlannedRunAndCollected) {
  const TemporaryFolder folder;
  const std::string scan = (folder / "scan").string();
  ASSERT_EQ(Lacuna("simulate " + WriteSmallScene(folder) + " -o " + (folder / "motion").string() +
                   " --recording " + scan)
                .status,
            0);
  std::ofstream(folder / "small.yaml") << R"(schema_version: 1
name: small
recording: scan
surface: {edge_length: 12 mm}
mesh: {max_volume: 2000 mm^3}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
forces: {model: none}
)";
  std::ofstream(folder / "sweep.yaml") << R"(schema_version: 1
name: sizes
command: reconstruct
experiments: small.yaml
vary: {mesh.max_volume: [1500 mm^3, 3000 mm^3]}
cases: [{frames.last: 3}]
)";
  const std::string cases = (folder / "cases").string();
  const std::string plan = "sweep plan " + (folder / "sweep.yaml").string() + " " + cases;
  const Ending refused = Lacuna(plan);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("sweep.yaml:6:"));  // there are three frames, from 0
  std::string text = FileContent(folder / "sweep.yaml");
  text.erase(text.find("cases:"));
  std::ofstream(folder / "sweep.yaml") << text;
  ASSERT_EQ(Lacuna(plan).status, 0);
  EXPECT_THAT(Lacuna("sweep collect " + cases).said, HasSubstr("2 planned"));
  const Ending run = Lacuna("sweep run " + cases);
  EXPECT_EQ(run.status, 0) << run.said;
  const Ending table = Lacuna("sweep collect " + cases);
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.said, HasSubstr("2 cases of sizes: 2 done"));
  EXPECT_THAT(table.said, HasSubstr("animation_residual_m"));
  EXPECT_EQ(Lacuna("sweep collect " + cases).said, table.said);
  EXPECT_EQ(Lacuna("sweep run " + cases + " --wait").status, 2);
}

TEST(CommandLine, CtrlCStopsAndLeavesNothingThatLooksFinished) {
  const TemporaryFolder folder;
  std::string text = FileContent(Experiment("bend.yaml"));
  const auto replace = [&text](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace("recording: recordings/bend", "recording: " + Experiment("recordings/bend"));
  replace("validation: {true_surfaces: recordings/bend/truth}", "");
  replace("output: ../results/bend", "output: " + (folder / "run").string());
  std::ofstream(folder / "bend.yaml") << text;
  const pid_t child = fork();
  if (child == 0) {
    (void)!freopen("/dev/null", "w", stdout);
    (void)!freopen("/dev/null", "w", stderr);
    execl(LACUNA_PROGRAM, LACUNA_PROGRAM, "reconstruct", (folder / "bend.yaml").c_str(), nullptr);
    _exit(127);
  }
  // From the manifest on, the run is in its first stage: all of them take half a minute.
  while (!std::filesystem::exists(folder / "run/manifest.json") &&
         waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_FALSE(std::filesystem::exists(folder / "run/results"));
  EXPECT_THAT(Lacuna("info " + (folder / "run").string()).said, HasSubstr("not finished"));
}

}  // namespace
}  // namespace lacuna
