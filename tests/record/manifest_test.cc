#include "record/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Manifest Example() {
  Manifest manifest;
  manifest.program_version = "0.1.0";
  manifest.library_versions = {{"Eigen", "3.4.0"}};
  manifest.configuration = {{"density", 1070.0}, {"steps", 3}};
  manifest.inputs = {{"frames/000.ply", "00ff"}};
  manifest.seed = 18446744073709551615u;
  manifest.stages["fit"] = {"key", {{"forces/000.npy", 17, "abcd"}}};
  manifest.finished = true;
  return manifest;
}

TEST(ManifestTest, IsReadBackCompletely) {
  const TemporaryFolder folder;
  const Manifest written = Example();
  WriteManifest(written, folder / "manifest.json");
  const Manifest read = ReadManifest(folder / "manifest.json");
  EXPECT_EQ(read.schema_version, kManifestSchemaVersion);
  EXPECT_EQ(read.program_version, written.program_version);
  EXPECT_EQ(read.library_versions, written.library_versions);
  EXPECT_EQ(read.configuration, written.configuration);
  EXPECT_EQ(read.inputs, written.inputs);
  EXPECT_EQ(read.seed, written.seed);
  ASSERT_EQ(read.stages.size(), 1u);
  EXPECT_EQ(read.stages.at("fit").key, "key");
  ASSERT_EQ(read.stages.at("fit").files.size(), 1u);
  EXPECT_EQ(read.stages.at("fit").files[0].name, "forces/000.npy");
  EXPECT_EQ(read.stages.at("fit").files[0].size, 17u);
  EXPECT_EQ(read.stages.at("fit").files[0].hash, "abcd");
  EXPECT_TRUE(read.finished);
}

// An experiment is read by a relative path in one command and by an absolute one in another.
TEST(InputNameTest, DoesNotDependOnHowThePathIsSpelled) {
  const std::filesystem::path absolute = std::filesystem::current_path();
  EXPECT_EQ(InputName("recordings/a/frames/1.ply", "recordings/a"), "frames/1.ply");
  EXPECT_EQ(InputName(absolute / "recordings/a/frames/1.ply", "recordings/a"), "frames/1.ply");
  EXPECT_EQ(InputName("recordings/b/../a/1.ply", absolute / "recordings/a"), "1.ply");
  EXPECT_EQ(InputName("/data/markers.csv", "recordings/a"), "markers.csv");
  EXPECT_EQ(InputName("../data/markers.csv", absolute / "recordings/a"), "markers.csv");
}

TEST(ManifestTest, DamagedOrNewerFilesAreRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "manifest.json";
  WriteManifest(Example(), file);
  const std::string whole = FileContent(file);
  const auto expect = [&](const std::string& text, const std::string& cause) {
    std::ofstream(file) << text;
    EXPECT_THAT([&] { ReadManifest(file); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr(cause))));
  };
  expect(whole.substr(0, whole.size() / 2), "is not a valid manifest");
  expect("{}", "schema_version");
  expect("[]", "is not a valid manifest");
  expect("{\"schema_version\": 99}", "from a later version of Lacuna");
  EXPECT_THAT([&] { ReadManifest(folder / "absent.json"); },
              ThrowsMessage<InputError>(HasSubstr("no such file")));
}

TEST(StageKeyTest, DependsOnEveryPartOfTheIdentity) {
  const StageIdentity base{"fit", 1, {{"tolerance", 1e-6}}, {{"mesh", "00"}}};
  std::set<std::string> keys{StageKey(base)};
  StageIdentity other = base;
  other.stage = "simulate";
  keys.insert(StageKey(other));
  other = base;
  other.code_version = 2;
  keys.insert(StageKey(other));
  other = base;
  other.inputs["mesh"] = "01";
  keys.insert(StageKey(other));
  // A change of one bit, and values that JSON text cannot distinguish.
  for (const double tolerance :
       {std::nextafter(1e-6, 1.0), std::nan(""), std::numeric_limits<double>::infinity()}) {
    other = base;
    other.options["tolerance"] = tolerance;
    keys.insert(StageKey(other));
  }
  EXPECT_EQ(keys.size(), 7u);
  EXPECT_TRUE(keys.contains(StageKey(base)));
}

}  // namespace
}  // namespace lacuna
