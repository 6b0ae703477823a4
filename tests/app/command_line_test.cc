// The program as a user meets it: what it prints, and how it ends.
#include "app/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "core/config.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

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

TEST(CommandLine, AnAbsentFileIsNamed) {
  for (const char* command : {"reconstruct", "fit", "compare", "simulate", "info", "validate"}) {
    const Ending ending = Lacuna(std::string(command) + " /nowhere/e.yaml");
    EXPECT_EQ(ending.status, 2) << command;
    EXPECT_THAT(ending.said, HasSubstr("/nowhere/e.yaml")) << command;
  }
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
