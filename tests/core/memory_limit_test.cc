#include "core/memory_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class MemoryLimitTest : public ::testing::Test {
 protected:
  ~MemoryLimitTest() override { SetMemoryLimit(0); }
};

TEST_F(MemoryLimitTest, IsThatOfTheMachineOrItsControlGroupUnlessItIsSet) {
  EXPECT_GT(MemoryInUse(), 1e6);
  EXPECT_LT(MemoryInUse(), MemoryLimit().bytes);
  RequireMemory(1e6, "a small thing", "");
  ThrowIfOverMemoryLimit();
  EXPECT_THAT([] { RequireMemory(1e13, "the factor", "take larger elements"); },
              ThrowsMessage<OutOfMemory>(AllOf(HasSubstr("the factor needs 10000.0 GB beside the "),
                                               HasSubstr(" MB in use, more than the limit of "),
                                               HasSubstr(", " + MemoryLimit().origin),
                                               HasSubstr("; take larger elements"))));
}

TEST_F(MemoryLimitTest, RefusesWhatIsAnnouncedAndWatchesWhatIsNot) {
  SetMemoryLimit(MemoryInUse() + 100'000'000);
  RequireMemory(1e7, "a small thing", "");
  EXPECT_THAT([] { RequireMemory(3e8, "the factor", ""); },
              ThrowsMessage<OutOfMemory>(AllOf(HasSubstr("the factor needs 300 MB"),
                                               HasSubstr(", set with --memory-limit; "))));
  ThrowIfOverMemoryLimit();
  const std::vector<char> large(300'000'000, 1);
  EXPECT_THAT([] { ThrowIfOverMemoryLimit(); },
              ThrowsMessage<OutOfMemory>(HasSubstr("of memory are in use, more than the limit")));
  EXPECT_EQ(large.back(), 1);
}

// Control groups that the test writes as files, on a machine with 8 GB.
class ControlGroupTest : public ::testing::Test {
 protected:
  static constexpr uint64_t kMachine = 8'000'000'000;

  void Write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << content << "\n";
  }
  MemoryBound Limit() const {
    return DefaultMemoryLimit(kMachine, folder_ / "membership", folder_ / "groups");
  }
  void ExpectLimit(uint64_t bytes, const std::string& file) const {
    EXPECT_EQ(Limit().bytes, bytes);
    EXPECT_EQ(Limit().origin, "set by the control group in " + (folder_ / file).string());
  }
  void ExpectMachine() const {
    EXPECT_EQ(Limit().bytes, kMachine);
    EXPECT_EQ(Limit().origin, "the machine's memory");
  }

  const TemporaryFolder folder_;
};

TEST_F(ControlGroupTest, TheLowestLimitOfTheGroupAndThoseAroundItCounts) {
  Write("membership", "0::/user.slice/job.scope");
  Write("groups/user.slice/job.scope/memory.max", "max");
  Write("groups/user.slice/other.scope/memory.max", "1000000");
  ExpectMachine();
  Write("groups/user.slice/memory.max", "3000000000");
  ExpectLimit(3'000'000'000, "groups/user.slice/memory.max");
  Write("groups/user.slice/job.scope/memory.max", "2000000000");
  ExpectLimit(2'000'000'000, "groups/user.slice/job.scope/memory.max");
  Write("groups/memory.max", "1000000000");
  ExpectLimit(1'000'000'000, "groups/memory.max");
}

TEST_F(ControlGroupTest, VersionOneHasAHierarchyOfItsOwnForMemory) {
  Write("membership", "5:cpuset:/\n4:cpu,memory:/batch/job:7\n1:name=systemd:/\n0::/");
  Write("groups/memory/memory.limit_in_bytes", "9223372036854771712");  // no limit
  ExpectMachine();
  Write("groups/memory/batch/job:7/memory.limit_in_bytes", "2000000000");
  ExpectLimit(2'000'000'000, "groups/memory/batch/job:7/memory.limit_in_bytes");
  Write("groups/memory/batch/memory.limit_in_bytes", "1000000000");
  ExpectLimit(1'000'000'000, "groups/memory/batch/memory.limit_in_bytes");
}

// /proc names the container's group as seen from outside, /sys has the group itself as its root.
TEST_F(ControlGroupTest, InsideAContainerTheRootIsItsGroup) {
  Write("membership", "4:memory:/docker/0123");
  Write("groups/memory/memory.limit_in_bytes", "2000000000");
  ExpectLimit(2'000'000'000, "groups/memory/memory.limit_in_bytes");
  Write("membership", "0::/docker/0123");
  Write("groups/memory.max", "1000000000");
  ExpectLimit(1'000'000'000, "groups/memory.max");
}

TEST_F(ControlGroupTest, WhatIsAbsentUnreadableOrAboveTheMachinesMemoryIsNoLimit) {
  ExpectMachine();  // there are no files
  Write("groups/memory.max", "1000000000");
  ExpectMachine();  // it is unknown which group the process belongs to
  Write("membership", "nonsense\n0:\n0::/job");
  Write("groups/memory.max", "");
  ExpectMachine();
  Write("groups/memory.max", "16000000000");
  ExpectMachine();
  Write("groups/job/memory.max/a_folder", "");
  ExpectMachine();
  Write("groups/memory.max", "2000000000");
  ExpectLimit(2'000'000'000, "groups/memory.max");
}

}  // namespace
}  // namespace lacuna
