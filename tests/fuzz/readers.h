// The readers of files that users bring, behind one name each: for fuzzers, and for a test that
// reads the files which the fuzzers start from.
#ifndef LACUNA_TESTS_FUZZ_READERS_H_
#define LACUNA_TESTS_FUZZ_READERS_H_

#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct FuzzedReader {
  std::string name;       // that of the corpus folder and of the program fuzz_<name>
  std::string extension;  // of its files, on which some readers depend
  void (*read)(const std::filesystem::path& file);
};

const std::vector<FuzzedReader>& FuzzedReaders();
// Throws std::out_of_range.
const FuzzedReader& FuzzedReaderNamed(const std::string& name);

// Reads a file with a reader. What the reader says about it, empty if it was read. Every exception
// but InputError, which tells a user what is wrong, passes through.
std::string ReadWith(const FuzzedReader& reader, const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_TESTS_FUZZ_READERS_H_
