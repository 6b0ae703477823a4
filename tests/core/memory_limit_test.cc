#include "core/memory_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>
#include <string>
#include <vector>

#include "core/error.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(MemoryLimit, IsTheMachinesMemoryUnlessItIsSet) {
  EXPECT_GT(MemoryInUse(), 1e6);
  EXPECT_LT(MemoryInUse(), MemoryLimit());
  RequireMemory(1e6, "a small thing", "");
  EXPECT_THAT([] { RequireMemory(1e15, "the factor", "take larger elements"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("the factor needs 1e+06 GB"),
                                              HasSubstr("more than the limit of"),
                                              HasSubstr("take larger elements"))));
}

// In a process of its own, whose limit cannot be raised again.
TEST(MemoryLimitDeathTest, RefusesWhatIsAnnouncedAndWhatIsNot) {
  EXPECT_EXIT(
      {
        SetMemoryLimit(MemoryInUse() + 200'000'000);
        int refused = 0;
        refused += !MemoryShortage(3e8, "the factor", "take larger elements").empty();
        RequireMemory(1e7, "a small thing", "");
        try {
          std::vector<char> large(2'000'000'000, 1);
          refused += large[7] - 1;
        } catch (const std::bad_alloc&) {
          ++refused;
        }
        _exit(refused);
      },
      ::testing::ExitedWithCode(2), "");
}

}  // namespace
}  // namespace lacuna
