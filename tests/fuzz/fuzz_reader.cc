// The fuzzer of one reader, LACUNA_FUZZED_READER: any bytes must be read or refused with an
// InputError. https://llvm.org/docs/LibFuzzer.html; how to run it: docs/recording.md.
#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "fuzz/readers.h"

namespace {

// A file in memory that is written anew for each input.
class InputFile {
 public:
  explicit InputFile(const std::string& extension)
      : path_("/dev/shm/lacuna_fuzz_" + std::to_string(getpid()) + extension),
        descriptor_(open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600)) {
    if (descriptor_ < 0) abort();
    std::atexit([] {
      for (const auto& reader : lacuna::FuzzedReaders())
        unlink(("/dev/shm/lacuna_fuzz_" + std::to_string(getpid()) + reader.extension).c_str());
    });
  }
  void Write(const uint8_t* data, size_t size) const {
    const auto length = static_cast<ssize_t>(size);
    if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, data, size, 0) != length) abort();
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const lacuna::FuzzedReader& reader = lacuna::FuzzedReaderNamed(LACUNA_FUZZED_READER);
  static const InputFile file(reader.extension);
  file.Write(data, size);
  lacuna::ReadWith(reader, file.path());
  return 0;
}
