// Reads the includes of src/ and holds the modules to their layers: a module includes only what
// stands below it, siblings never include each other, and headers speak Eigen and our own structs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
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

// docs and README draw the same order. "record" holds the plain data of a run, "report" the text
// that is made from it.
const std::map<std::string, int> kLayers = {
    {"core", 1},       {"geometry", 2},     {"search", 2}, {"scan", 3},       {"surface", 3},
    {"meshing", 3},    {"registration", 3}, {"record", 3}, {"fem", 4},        {"analysis", 4},
    {"effects", 5},    {"fit", 5},          {"report", 5}, {"experiment", 6}, {"reconstruction", 7},
    {"prediction", 7}, {"calibration", 8},  {"paper", 8},  {"comparison", 9}, {"diagnosis", 9},
    {"exchange", 9},   {"plan", 10},        {"sweep", 10}, {"trials", 11},    {"app", 12},
    {"python", 12},
};

// A run of yesterday can be explained without running it again.
const std::map<std::string, std::set<std::string>> kForbidden = {
    {"analysis", {"fem"}},
    {"report", {"fem"}},
};

// A header may show these libraries to whoever includes it, the standard library, and POSIX where
// it has the types of a call.
const std::regex kOpenLibraries("Eigen/.*|nlohmann/.*|glog/logging\\.h|spawn\\.h|[a-z_0-9]+");

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

// The files of src/<module>, by module, then by name without the ending: a header and its source
// are one unit.
using Units = std::map<std::string, std::map<std::string, std::string>>;

Units ReadUnits() {
  Units units;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(LACUNA_SOURCE_DIR) / "src")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cc") continue;
    std::ifstream file(entry.path());
    std::stringstream text;
    text << file.rdbuf();
    units[entry.path().parent_path().filename()][entry.path().stem()] += text.str();
  }
  return units;
}

// A circle of includes between the units of one module, as "a -> b -> a"; empty: there is none.
std::string FindCircle(const std::string& module, const std::map<std::string, std::string>& units) {
  static const std::regex include(R"re(#\s*include\s*"(\w+)/(\w+)\.h")re");
  std::map<std::string, std::set<std::string>> includes;
  for (const auto& [unit, text] : units)
    for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
      if ((*match)[1] == module && (*match)[2] != unit && units.contains((*match)[2]))
        includes[unit].insert((*match)[2]);
  std::set<std::string> done;
  std::vector<std::string> way;
  std::string circle;
  const std::function<bool(const std::string&)> visit = [&](const std::string& unit) {
    const auto begin = std::find(way.begin(), way.end(), unit);
    if (begin != way.end()) {
      for (auto at = begin; at != way.end(); ++at) circle += *at + " -> ";
      circle += unit;
      return true;
    }
    if (done.contains(unit)) return false;
    way.push_back(unit);
    for (const std::string& other : includes[unit])
      if (visit(other)) return true;
    way.pop_back();
    done.insert(unit);
    return false;
  };
  for (const auto& [unit, text] : units)
    if (visit(unit)) return circle;
  return "";
}

// Without what stands in anonymous namespaces and belongs to its file alone. (A regular expression
// of the standard library that matches a long text overflows the stack.)
std::string WithoutAnonymousNamespaces(std::string text) {
  const std::string open = "\nnamespace {\n", close = "\n}  // namespace\n";
  for (size_t begin = text.find(open); begin != std::string::npos; begin = text.find(open, begin)) {
    const size_t end = text.find(close, begin);
    if (end == std::string::npos) break;
    text.erase(begin, end + close.size() - 1 - begin);
  }
  return text;
}

// Classes and structs that headers define at the level of the namespace, with the units that do.
std::map<std::string, std::vector<std::string>> DefinedNames(const Units& units) {
  static const std::regex definition(
      R"re((?:^|\n)(?:class|struct|enum class|enum) (\w+)(?: final)?(?: :[^;{]*)? \{)re");
  std::map<std::string, std::vector<std::string>> names;
  for (const auto& [module, of_module] : units)
    for (const auto& [unit, text] : of_module) {
      const std::string open = WithoutAnonymousNamespaces(text);
      for (std::sregex_iterator match(open.begin(), open.end(), definition), end; match != end;
           ++match)
        names[(*match)[1]].push_back(module + "/" + unit);
    }
  return names;
}

std::vector<std::string> FindRepeatedNames(const Units& units) {
  std::vector<std::string> repeated;
  for (const auto& [name, places] : DefinedNames(units))
    if (places.size() > 1) repeated.push_back(name + ": " + places[0] + ", " + places[1]);
  return repeated;
}

TEST(LayersTest, NoModuleIncludesItsFilesInACircle) {
  const Units units = ReadUnits();
  EXPECT_GT(units.size(), 10u) << "the sources have not been found";
  for (const auto& [module, of_module] : units)
    EXPECT_EQ(FindCircle(module, of_module), "") << "in src/" << module;
}

TEST(LayersTest, ACircleIsSeen) {
  const std::string to_b = "#include \"fem/b.h\"\n", to_c = "#include \"fem/c.h\"\n";
  EXPECT_EQ(FindCircle("fem", {{"a", to_b}, {"b", to_c}, {"c", "#include \"fem/a.h\"\n"}}),
            "a -> b -> c -> a");
  EXPECT_EQ(FindCircle("fem", {{"a", to_b + to_c}, {"b", to_c}, {"c", "#include \"fit/a.h\"\n"}}),
            "");
}

// Two definitions of one name are undefined behaviour that the linker does not report.
TEST(LayersTest, NoTypeIsDefinedTwice) { EXPECT_THAT(FindRepeatedNames(ReadUnits()), IsEmpty()); }

TEST(LayersTest, ATypeThatIsDefinedTwiceIsSeen) {
  const std::string open = "namespace lacuna {\n\nclass Model {\n};\n}\n";
  const std::string hidden =
      "namespace lacuna {\nnamespace {\nstruct Model {\n};\n\n}  // namespace\n";
  EXPECT_THAT(FindRepeatedNames({{"fem", {{"a", open}}}, {"fit", {{"b", open}}}}),
              ElementsAre("Model: fem/a, fit/b"));
  EXPECT_THAT(FindRepeatedNames({{"fem", {{"a", open}}}, {"fit", {{"b", hidden}}}}), IsEmpty());
}

}  // namespace
}  // namespace lacuna
