// A folder of the test's (or the test suite's) own, gone when the object is.
#ifndef LACUNA_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
#define LACUNA_TESTS_SUPPORT_TEMPORARY_FOLDER_H_

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace lacuna {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> count = 0;  // a test may have several
    const auto* all = ::testing::UnitTest::GetInstance();
    const auto* test = all->current_test_info();  // none while a suite is set up
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("lacuna_" + std::string(all->current_test_suite()->name()) + "_" +
             (test ? test->name() : "suite") + "_" + std::to_string(getpid()) + "_" +
             std::to_string(count++));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& Path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline std::string FileContent(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
