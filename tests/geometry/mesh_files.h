// Files of meshes that a test writes, and why they are refused.
#ifndef LACUNA_TESTS_GEOMETRY_MESH_FILES_H_
#define LACUNA_TESTS_GEOMETRY_MESH_FILES_H_

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

#include "core/error.h"

namespace lacuna {

// Writes the content and returns the file.
inline std::filesystem::path Write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

// The message of the InputError that `read` throws for this file.
template <typename Read>
std::string FailureOf(const Read& read, const std::filesystem::path& file) {
  try {
    read(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without complaint";
}

// A file of a parametrised test, and its content.
struct TextFile {
  const char* name;
  const char* content;
};
// Names the test case; GoogleTest's own printer would print the addresses of the strings.
inline void PrintTo(const TextFile& file, std::ostream* out) { *out << file.name; }

}  // namespace lacuna

#endif  // LACUNA_TESTS_GEOMETRY_MESH_FILES_H_
