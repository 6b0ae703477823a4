#include "core/file_name.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace lacuna {
namespace {

const std::string kHostile[] = {"",     ".",          "..",     ".hidden", "../../ESC",
                                "a/b",  "/etc/hosts", "..\\up", "a\nb",    std::string("a\0b", 3),
                                "a\x7f"};

TEST(FileName, ANameThatLeadsElsewhereIsNone) {
  for (const std::string& name : kHostile) EXPECT_FALSE(IsFileName(name)) << name;
  for (const char* name :
       {"bend", "silicone beam, 52 g", "a..b", "a.", "-1", "größer", "hidden+drag"})
    EXPECT_TRUE(IsFileName(name)) << name;
}

TEST(FileName, EveryNameIsMappedToOne) {
  for (const std::string& name : kHostile) {
    const std::string file = FileNameFor(name);
    EXPECT_TRUE(IsFileName(file)) << file;
    EXPECT_EQ((std::filesystem::path("results") / file).lexically_normal().parent_path(), "results")
        << file;
  }
  EXPECT_EQ(FileNameFor(".."), "_.");
  EXPECT_EQ(FileNameFor("../../ESC"), "_._.._ESC");
  EXPECT_EQ(FileNameFor("silicone beam, 52 g"), "silicone_beam__52_g");
  EXPECT_EQ(FileNameFor("hidden_effect+drag-2.5"), "hidden_effect+drag-2.5");
}

}  // namespace
}  // namespace lacuna
