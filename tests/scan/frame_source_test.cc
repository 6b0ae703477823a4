#include "scan/frame_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(FrameSource, AnUnknownKindIsAnsweredWithTheKindsThatExist) {
  const auto read = [] {
    std::vector<std::string> warnings;
    ReadFrameSource(Config::Parse("{kind: clouds}", "recording.yaml"), {".", "mm"}, &warnings);
  };
  EXPECT_THAT(ErrorOf(read), AllOf(HasSubstr("kind: got \"clouds\""), HasSubstr("points"),
                                   HasSubstr("mesh"), HasSubstr("depth"), HasSubstr("markers")));
}

}  // namespace
}  // namespace lacuna
