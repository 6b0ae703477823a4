// Changes of texts and text files of a test.
#ifndef LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_
#define LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "support/temporary_folder.h"

namespace lacuna {

// The text with the first occurrence of each key replaced by its value. A text without one of them
// is a failure of the test.
inline std::string WithReplacements(std::string text,
                                    const std::map<std::string, std::string>& replaced) {
  for (const auto& [from, to] : replaced) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from << " is not in:\n" << text;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return text;
}

// The same for the content of a file.
inline void ReplaceInFile(const std::filesystem::path& file,
                          const std::map<std::string, std::string>& replaced) {
  const std::string text = WithReplacements(FileContent(file), replaced);
  std::ofstream(file) << text;
}
inline void ReplaceInFile(const std::filesystem::path& file, const std::string& from,
                          const std::string& to) {
  ReplaceInFile(file, {{from, to}});
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_REPLACE_IN_FILE_H_
