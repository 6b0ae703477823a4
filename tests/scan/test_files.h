// Helpers for tests that write files.
#ifndef LACUNA_TESTS_SCAN_TEST_FILES_H_
#define LACUNA_TESTS_SCAN_TEST_FILES_H_

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {

// A temporary folder in which the test writes files.
class TestFolder : public TemporaryFolder {
 public:
  std::filesystem::path Write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = Path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
};

// The message of the InputError that `action` throws; "no error" when it throws none.
inline std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SCAN_TEST_FILES_H_
