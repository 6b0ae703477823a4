#include "search/evaluation_log.h"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "core/hash.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

constexpr int kHashDigits = 16;
constexpr char kRemedy[] = "remove this file, and the search starts again";

std::string WithChecksum(const std::string& content) {
  return HashBytes(content).substr(0, kHashDigits) + " " + content + "\n";
}

std::string ContentOf(const SearchStep& step) {
  std::string content;
  for (int i = 0; i < step.x.size(); ++i) content += fmt::format("{:a} ", step.x[i]);
  if (!step.outcome.value) return content + "failed " + step.outcome.failure;
  content += fmt::format("value {:a}", *step.outcome.value);
  for (int i = 0; i < step.outcome.constraints.size(); ++i) {
    content += fmt::format(" {:a}", step.outcome.constraints[i]);
  }
  return content;
}

// Returns false if `content` does not have the format of ContentOf for these sizes.
bool ParseContent(const std::string& content, int variable_count, int constraint_count,
                  SearchStep* step) {
  std::istringstream stream(content);
  std::string word;
  const auto read_number = [&](double* number) {
    if (!(stream >> word)) return false;
    char* end = nullptr;
    *number = std::strtod(word.c_str(), &end);
    return *end == '\0';
  };
  step->from_log = true;
  step->x.resize(variable_count);
  for (int i = 0; i < variable_count; ++i) {
    if (!read_number(&step->x[i])) return false;
  }
  if (!(stream >> word)) return false;
  if (word == "failed") {
    stream.get();
    std::getline(stream, step->outcome.failure);
    return true;
  }
  step->outcome.value.emplace();
  if (word != "value" || !read_number(&*step->outcome.value)) return false;
  step->outcome.constraints.resize(constraint_count);
  for (int i = 0; i < constraint_count; ++i) {
    if (!read_number(&step->outcome.constraints[i])) return false;
  }
  return !(stream >> word);
}

}  // namespace

EvaluationLog::EvaluationLog(const std::filesystem::path& file, const std::string& key,
                             int variable_count, int constraint_count)
    : file_(file) {
  std::string text;
  if (std::filesystem::exists(file)) text = ReadWholeFile(file);
  const std::string header =
      WithChecksum("lacuna search log 1, " +
                   HashBytes(fmt::format("{} {} {}", key, variable_count, constraint_count)));
  size_t sound = 0;
  for (int line = 1; sound < text.size(); ++line) {
    const size_t end = text.find('\n', sound);
    if (end == std::string::npos) break;  // incomplete last line
    const std::string whole = text.substr(sound, end + 1 - sound);
    if (whole.size() <= kHashDigits + 2 ||
        WithChecksum(whole.substr(kHashDigits + 1, whole.size() - kHashDigits - 2)) != whole) {
      if (end + 1 == text.size()) break;
      throw InputError({file.string(), line}, fmt::format("the line is damaged; {}", kRemedy));
    }
    if (line == 1) {
      if (whole != header)
        throw InputError({file.string(), 1},
                         fmt::format("is the log of another search; {}", kRemedy));
    } else {
      const std::string content = whole.substr(kHashDigits + 1, whole.size() - kHashDigits - 2);
      if (!ParseContent(content, variable_count, constraint_count, &steps_.emplace_back())) {
        throw InputError({file.string(), line},
                         fmt::format("is not an evaluation of this search; {}", kRemedy));
      }
    }
    sound = end + 1;
  }
  if (sound < text.size()) {
    std::error_code error;
    std::filesystem::resize_file(file, sound, error);
    if (error) throw InputError({file.string()}, "cannot be written: " + error.message());
  }
  stream_.open(file, std::ios::binary | std::ios::app);
  if (sound == 0) stream_ << header << std::flush;
  if (!stream_) throw InputError({file.string()}, "cannot be written");
}

void EvaluationLog::Append(const SearchStep& step) {
  stream_ << WithChecksum(ContentOf(step)) << std::flush;
  if (!stream_) throw InputError({file_.string()}, "cannot be written");
}

}  // namespace lacuna
