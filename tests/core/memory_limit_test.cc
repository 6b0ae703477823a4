#include "core/memory_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class MemoryLimitTest : public ::testing::Test {
 protected:
  ~MemoryLimitTest() override { SetMemoryLimit(0); }
};

TEST_F(MemoryLimitTest, IsTheMachinesMemoryUnlessItIsSet) {
  EXPECT_GT(MemoryInUse(), 1e6);
  EXPECT_LT(MemoryInUse(), MemoryLimit());
  RequireMemory(1e6, "a small thing", "");
  ThrowIfOverMemoryLimit();
  EXPECT_THAT([] { RequireMemory(1e13, "the factor", "take larger elements"); },
              ThrowsMessage<OutOfMemory>(AllOf(HasSubstr("the factor needs 10000.0 GB beside the "),
                                               HasSubstr(" MB in use, more than the limit of "),
                                               HasSubstr("; take larger elements"))));
}

TEST_F(MemoryLimitTest, RefusesWhatIsAnnouncedAndWatchesWhatIsNot) {
  SetMemoryLimit(MemoryInUse() + 100'000'000);
  RequireMemory(1e7, "a small thing", "");
  EXPECT_THAT([] { RequireMemory(3e8, "the factor", ""); },
              ThrowsMessage<OutOfMemory>(HasSubstr("the factor needs 300 MB")));
  ThrowIfOverMemoryLimit();
  const std::vector<char> large(300'000'000, 1);
  EXPECT_THAT([] { ThrowIfOverMemoryLimit(); },
              ThrowsMessage<OutOfMemory>(HasSubstr("of memory are in use, more than the limit")));
  EXPECT_EQ(large.back(), 1);
}

}  // namespace
}  // namespace lacuna
