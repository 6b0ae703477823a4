// Reads the includes of src/ and holds the modules to their layers: a module includes only what
// stands below it, siblings never include each other, and headers speak Eigen and our own structs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::map<std::string, int> kLayers = {
    {"core", 1},       {"geometry", 2},     {"search", 2}, {"scan", 3},       {"surface", 3},
    {"meshing", 3},    {"registration", 3}, {"record", 3}, {"fem", 4},        {"analysis", 4},
    {"effects", 5},    {"fit", 5},          {"report", 5}, {"experiment", 6}, {"reconstruction", 7},
    {"prediction", 7}, {"calibration", 8},  {"paper", 8},  {"diagnosis", 9},  {"comparison", 9},
    {"sweep", 10},     {"trials", 10},      {"app", 11},
};

// Yesterday's run can be explained without running it again.
const std::map<std::string, std::set<std::string>> kForbidden = {
    {"analysis", {"fem"}},
    {"report", {"fem"}},
};

// A header may show these libraries to whoever includes it, and the standard library.
const std::regex kOpenLibraries("Eigen/.*|nlohmann/.*|glog/logging\\.h|[a-z_0-9]+");

// What is wrong with the includes of src/<module>/<file>.
std::vector<std::string> FindViolations(const std::string& module, const std::string& file,
                                        std::istream& text) {
  std::vector<std::string> violations;
  const std::string place = module + "/" + file + ": ";
  static const std::regex include(R"re(^\s*#\s*include\s*(["<])([^">]+)[">].*$)re");
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, include)) continue;
    const std::string name = match[2];
    if (match[1] == "<") {
      if (fs::path(file).extension() == ".h" && !std::regex_match(name, kOpenLibraries)) {
        violations.push_back(place + "the header shows the foreign " + name);
      }
      continue;
    }
    const std::string other = name.substr(0, name.find('/'));
    if (other == module) continue;
    if (!kLayers.contains(other) || name.find('/') == std::string::npos) {
      violations.push_back(place + name + " belongs to no module");
    } else if (kLayers.at(other) > kLayers.at(module)) {
      violations.push_back(place + name + " stands above");
    } else if (kLayers.at(other) == kLayers.at(module)) {
      violations.push_back(place + name + " belongs to a sibling");
    } else if (kForbidden.contains(module) && kForbidden.at(module).contains(other)) {
      violations.push_back(place + name + " is not for " + module);
    }
  }
  return violations;
}

std::vector<std::string> ViolationsOf(const std::string& module, const std::string& file,
                                      const std::string& text) {
  std::istringstream stream(text);
  return FindViolations(module, file, stream);
}

TEST(LayersTest, ModulesIncludeOnlyWhatStandsBelow) {
  int files = 0;
  for (const auto& folder : fs::directory_iterator(fs::path(LACUNA_SOURCE_DIR) / "src")) {
    if (!folder.is_directory()) continue;
    const std::string module = folder.path().filename();
    ASSERT_TRUE(kLayers.contains(module)) << "src/" << module << " has no layer";
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cc") continue;
      ++files;
      std::ifstream text(entry.path());
      EXPECT_THAT(FindViolations(module, entry.path().filename(), text), IsEmpty());
    }
  }
  EXPECT_GT(files, 20) << "the sources have not been found";
}

TEST(LayersTest, EachKindOfViolationIsSeen) {
  EXPECT_THAT(ViolationsOf("scan", "a.cc", "#include \"core/error.h\"\n#include <pcl/x.h>\n"),
              IsEmpty());
  EXPECT_THAT(ViolationsOf("scan", "a.h", "#include <Eigen/Core>\n#include <vector>\n"), IsEmpty());
  EXPECT_THAT(ViolationsOf("core", "a.cc", "#include \"fem/effect.h\"\n"),
              ElementsAre("core/a.cc: fem/effect.h stands above"));
  EXPECT_THAT(ViolationsOf("scan", "a.cc", "  # include \"record/a.h\"  // why\n"),
              ElementsAre(HasSubstr("sibling")));
  EXPECT_THAT(ViolationsOf("report", "a.cc", "#include \"fem/effect.h\"\n"),
              ElementsAre(HasSubstr("is not for report")));
  EXPECT_THAT(ViolationsOf("scan", "a.cc", "#include \"utils/a.h\"\n#include \"b.h\"\n"),
              ElementsAre(HasSubstr("no module"), HasSubstr("no module")));
  for (const char* foreign : {"pcl/x.h", "vtkNew.h", "CGAL/x.h", "tetgen.h", "ceres/ceres.h",
                              "nanoflann.hpp", "suitesparse/cholmod.h", "yaml-cpp/yaml.h"}) {
    EXPECT_THAT(ViolationsOf("scan", "a.h", "#include <" + std::string(foreign) + ">\n"),
                ElementsAre(HasSubstr("foreign")))
        << foreign;
  }
}

}  // namespace
}  // namespace lacuna
