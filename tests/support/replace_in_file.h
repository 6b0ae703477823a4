// Changes of a text file that a test has written.
#ifndef LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_
#define LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"

namespace lacuna {

// Replaces the first occurrence of `from`. A file without it is a failure of the test.
inline void ReplaceInFile(const std::filesystem::path& file, const std::string& from,
                          const std::string& to) {
  std::string text = FileContent(file);
  const size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from << " is not in:\n" << text;
  text.replace(at, from.size(), to);
  std::ofstream(file) << text;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_
