#include "core/hash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"

namespace lacuna {
namespace {

TEST(Hash, OfNoBytesIsThePublishedValue) {
  // XXH3_128bits of no bytes with seed 0, as `xxhsum -H128 /dev/null` prints it.
  EXPECT_EQ(HashBytes(""), "99aa06d3014798d86001c324468d497f");
}

TEST(Hash, OfALargeFileIsThatOfItsBytes) {
  std::string bytes(3 * (1 << 20) + 17, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
  const auto file = std::filesystem::path(::testing::TempDir()) / "lacuna_hash_test.bin";
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_EQ(HashFile(file), HashBytes(bytes));
  bytes.back() ^= 1;
  EXPECT_NE(HashFile(file), HashBytes(bytes));
  std::filesystem::remove(file);
}

TEST(Hash, ErrorNamesTheUnreadableFile) {
  for (const char* file : {"/absent/file", "/proc"}) {
    EXPECT_THAT([&] { HashFile(file); },
                ::testing::ThrowsMessage<InputError>(::testing::AllOf(
                    ::testing::HasSubstr(file), ::testing::HasSubstr("cannot be read"))));
  }
}

}  // namespace
}  // namespace lacuna
