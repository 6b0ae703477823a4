// The content of a folder, so that two runs can be compared.
#ifndef LACUNA_TESTS_FAULTS_FOLDER_CONTENT_H_
#define LACUNA_TESTS_FAULTS_FOLDER_CONTENT_H_

#include <filesystem>
#include <map>
#include <string>

namespace lacuna {

// The hash of each file by its relative path. Left out are locks, which belong to a process, and
// log.txt, where a sweep's case writes how long it takes; numbers of seconds count as equal.
std::map<std::string, std::string> ContentOf(const std::filesystem::path& folder);

// The first difference in words; empty: there is none.
std::string Difference(const std::map<std::string, std::string>& expected,
                       const std::map<std::string, std::string>& found);

// How many hidden files and folders there are which are no locks: what a killed process has left.
int CountHidden(const std::filesystem::path& folder);

// The text of `file` without the numbers that depend on how fast the computer is: those of JSON
// keys that end in "seconds", and the last column of the table if the file is called table1.txt.
std::string WithoutTimes(std::string text, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FAULTS_FOLDER_CONTENT_H_
