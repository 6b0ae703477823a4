#include "core/text_file.h"

#include <fstream>
#include <iterator>

#include "core/error.h"

namespace lacuna {

std::string ReadWholeFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw InputError({file.string()}, "cannot be opened for reading");
  std::string content(std::istreambuf_iterator<char>(stream), {});
  if (stream.bad()) throw InputError({file.string()}, "cannot be read completely");
  return content;
}

}  // namespace lacuna
