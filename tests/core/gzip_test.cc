#include "core/gzip.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "core/base64.h"
#include "core/error.h"

namespace lacuna {
namespace {

std::string RandomBytes(size_t count) {
  std::mt19937 random(3);
  std::string bytes;
  for (size_t k = 0; k < count; ++k) bytes += static_cast<char>(random() & 255U);
  return bytes;
}

TEST(Base64, EncodesTheExamplesOfItsSpecification) {
  EXPECT_EQ(EncodeBase64(""), "");
  EXPECT_EQ(EncodeBase64("f"), "Zg==");
  EXPECT_EQ(EncodeBase64("fo"), "Zm8=");
  EXPECT_EQ(EncodeBase64("foobar"), "Zm9vYmFy");
}

TEST(Base64, DecodesWhatItEncodes) {
  for (size_t count = 0; count < 300; ++count) {
    const std::string bytes = RandomBytes(count);
    ASSERT_EQ(DecodeBase64(EncodeBase64(bytes)), bytes) << count;
  }
}

TEST(Base64, RefusesOtherText) {
  for (const char* text : {"Zg=", "Z===", "====", "Zm9*", "Zg==Zg=="})
    EXPECT_THROW(DecodeBase64(text), InputError) << text;
}

TEST(Gzip, DecompressesWhatItCompresses) {
  for (const size_t count : {0, 1, 1000, 300000}) {
    const std::string bytes = RandomBytes(count) + std::string(count, 'a');
    EXPECT_EQ(Gunzip(Gzip(bytes)), bytes);
  }
  EXPECT_LT(Gzip(std::string(100000, 'a')).size(), 500u);
}

// Bytes 4 to 7 of the header are the time (RFC 1952, section 2.3), bit 3 of byte 3 announces a
// name.
TEST(Gzip, KeepsNeitherTimeNorName) {
  const std::string compressed = Gzip("measured");
  EXPECT_EQ(compressed.substr(3, 5), std::string(5, '\0'));
}

TEST(Gzip, RefusesWhatIsDamaged) {
  const std::string compressed = Gzip(RandomBytes(1000));
  std::string changed = compressed;
  changed[500] = static_cast<char>(changed[500] ^ 1);
  EXPECT_THROW(Gunzip(changed), InputError);
  EXPECT_THROW(Gunzip(compressed.substr(0, 900)), InputError);
  EXPECT_THROW(Gunzip(compressed + "more"), InputError);
  EXPECT_THROW(Gunzip("no gzip"), InputError);
}

}  // namespace
}  // namespace lacuna
