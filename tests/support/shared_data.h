// The published data sets, which are not part of this repository.
#ifndef LACUNA_TESTS_SUPPORT_SHARED_DATA_H_
#define LACUNA_TESTS_SUPPORT_SHARED_DATA_H_

#include <cstdlib>
#include <filesystem>

namespace lacuna {

// The folder that the environment variable LACUNA_DATA names, or else one beside the source. It may
// not exist.
inline std::filesystem::path SharedData() {
  const char* named = std::getenv("LACUNA_DATA");
  return named != nullptr ? std::filesystem::path(named)
                          : std::filesystem::path(LACUNA_SOURCE_DIR) / "../shared/data";
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_SHARED_DATA_H_
