// An effect is known by name to its own card alone. Code outside src/effects asks the card, the
// catalogue or a typed header such as effects/gravity.h, so that a new effect needs no change
// there. This test reads the sources and finds string literals that are the name of an effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/text_file.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Modules below the physical model, which cannot include an effect (tests/layers_test.cc).
// "gravity" is a key of recording.yaml there.
const std::set<std::string> kBelowEffects = {"core",    "geometry",     "search", "scan",
                                             "surface", "registration", "meshing"};

// Literals outside src/effects that are an ordinary word and not the name of an effect: file, word.
const std::set<std::pair<std::string, std::string>> kOrdinaryWords = {
    {"drop_figure.cc", "linear"},  // the order of an element
};

// The contents of the string literals of C++ source, without those in comments.
std::vector<std::string> StringLiterals(const std::string& source) {
  std::vector<std::string> literals;
  const auto starts = [&](size_t at, const char* text) {
    return source.compare(at, std::string(text).size(), text) == 0;
  };
  for (size_t at = 0; at < source.size();) {
    if (starts(at, "//")) {
      at = std::min(source.find('\n', at), source.size());
    } else if (starts(at, "/*")) {
      at = std::min(source.find("*/", at + 2), source.size() - 2) + 2;
    } else if (starts(at, "R\"")) {
      const size_t open = source.find('(', at);
      const std::string close = ")" + source.substr(at + 2, open - at - 2) + "\"";
      const size_t end = source.find(close, open);
      literals.push_back(source.substr(open + 1, end - open - 1));
      at = end + close.size();
    } else if (source[at] == '"' || source[at] == '\'') {
      // A quote between digits separates them: 1'000.
      const char quote = source[at];
      const bool separates =
          quote == '\'' && at > 0 && std::isalnum(static_cast<unsigned char>(source[at - 1])) != 0;
      size_t end = at + 1;
      while (!separates && end < source.size() && source[end] != quote)
        end += source[end] == '\\' ? 2 : 1;
      if (quote == '"') literals.push_back(source.substr(at + 1, end - at - 1));
      at = separates ? at + 1 : end + 1;
    } else {
      ++at;
    }
  }
  return literals;
}

std::vector<std::string> NamedEffects(const std::string& file, const std::string& source) {
  std::vector<std::string> named;
  for (const std::string& literal : StringLiterals(source))
    if (FindEntry(literal) != nullptr && !kOrdinaryWords.contains({file, literal}))
      named.push_back(file + " names " + literal);
  return named;
}

TEST(EffectNames, StandInTheCodeOfTheirEffectAlone) {
  int files = 0;
  for (const auto& folder : fs::directory_iterator(fs::path(LACUNA_SOURCE_DIR) / "src")) {
    const std::string module = folder.path().filename();
    if (!folder.is_directory() || module == "effects" || kBelowEffects.contains(module)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cc") continue;
      ++files;
      EXPECT_THAT(NamedEffects(entry.path().filename(), ReadWholeFile(entry.path())), IsEmpty());
    }
  }
  EXPECT_GT(files, 20) << "the sources were not found";
}

TEST(EffectNames, AreFoundWhereTheyArePlanted) {
  EXPECT_THAT(NamedEffects("a.cc", "if (card.type == \"drag\") return;  // \"gravity\"\n"),
              ElementsAre("a.cc names drag"));
  EXPECT_THAT(NamedEffects("a.cc", "Eigen::Index n = 1'000; const char* x = R\"(gravity)\";\n"),
              ElementsAre("a.cc names gravity"));
  EXPECT_THAT(NamedEffects("a.cc", "f('\"', \"pressure\", \"a \\\"drag\\\"\");\n"),
              ElementsAre("a.cc names pressure"));
  EXPECT_THAT(NamedEffects("a.cc", "/* \"drag\" */ Fail(\"drag of the medium\"); // \"drag\"\n"),
              IsEmpty());
  EXPECT_THAT(NamedEffects("drop_figure.cc", "return \"linear\";\n"), IsEmpty());
  EXPECT_THAT(NamedEffects("other.cc", "return \"linear\";\n"),
              ElementsAre("other.cc names linear"));
}

}  // namespace
}  // namespace lacuna
