#include "core/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "core/error.h"

namespace lacuna {
namespace {

std::string Hexadecimal(XXH128_hash_t hash) {
  XXH128_canonical_t canonical;  // independent of the machine's byte order
  XXH128_canonicalFromHash(&canonical, hash);
  std::string text;
  for (const unsigned char byte : canonical.digest) text += fmt::format("{:02x}", byte);
  return text;
}

}  // namespace

std::string HashBytes(std::string_view bytes) {
  return Hexadecimal(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string HashFile(const std::filesystem::path& file) {
  const auto fail = [&file] {
    throw InputError({file.string()}, std::string("cannot be read: ") + std::strerror(errno));
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) fail();
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              &XXH3_freeState);
  XXH3_128bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), stream.get())) {
    XXH3_128bits_update(state.get(), buffer.data(), count);
  }
  if (std::ferror(stream.get())) fail();
  return Hexadecimal(XXH3_128bits_digest(state.get()));
}

}  // namespace lacuna
