// Inputs that change after the run, or while it lasts.
#include <fmt/format.h>

#include <chrono>
#include <fstream>

#include "faults/folder_content.h"
#include "faults/trial.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// The input while it has another content; afterwards it has the old one again.
class ChangedFile {
 public:
  // Changes the last byte that is a digit.
  explicit ChangedFile(const fs::path& file) : file_(file), before_(FileContent(file)) {
    std::string bytes = before_;
    const size_t digit = bytes.find_last_of("0123456789");
    bytes[digit] = bytes[digit] == '1' ? '2' : '1';
    Write(bytes);
  }
  ~ChangedFile() { Write(before_); }
  ChangedFile(const ChangedFile&) = delete;
  ChangedFile& operator=(const ChangedFile&) = delete;

 private:
  // At one stroke: whoever reads it meanwhile gets the old file or the new one.
  void Write(const std::string& bytes) const {
    const fs::path other = file_.string() + ".new";
    std::ofstream(other, std::ios::binary) << bytes;
    fs::rename(other, file_);
  }
  const fs::path file_;
  const std::string before_;
};

int Manifests(const fs::path& folder) {
  int count = 0;
  std::error_code ignored;  // folders come and go
  for (auto entry = fs::recursive_directory_iterator(folder, ignored);
       !ignored && entry != fs::recursive_directory_iterator(); entry.increment(ignored))
    count += entry->path().filename() == "manifest.json";
  return count;
}

}  // namespace

// A measurement changes after the run; the results of before must not pass for those of the new
// input.
FaultResult ChangedInput(Trial* trial) {
  FaultResult result{"an input that changes afterwards", trial->subject().name};
  trial->Try(&result, trial->subject().input.filename().string(), [&]() -> std::string {
    trial->ResetToFinished();
    const ChangedFile changed(trial->Folder() / trial->subject().input);
    const int status = trial->Run();
    const bool is_refused =
        status > 0 && (trial->HasSaid("changed") || trial->HasSaid("made with other settings"));
    // The manifests differ in any case: they have the hashes of the inputs.
    Trial::Content expected = trial->Expected(), found = ContentOf(trial->Results());
    for (Trial::Content* content : {&expected, &found})
      std::erase_if(*content, [](const auto& one) {
        return fs::path(one.first).filename() == "manifest.json";
      });
    const bool is_remade = status == 0 && !Difference(expected, found).empty();
    if (is_refused || is_remade) return "";
    return fmt::format("exit status {}, and the results are those of the old input", status);
  });
  return result;
}

// A measurement changes while the command runs, after it has hashed its inputs: nothing may be
// finished from a mixture of old and new data.
FaultResult InputChangedMeanwhile(Trial* trial) {
  const Subject& subject = trial->subject();
  FaultResult result{"an input that changes meanwhile", subject.name};
  trial->Try(&result, subject.input.filename().string(), [&]() -> std::string {
    trial->StartOver();
    int status = 0;
    {
      Process process = trial->Start();
      while (Manifests(trial->Results()) < subject.manifests &&
             !process.EndsWithin(std::chrono::milliseconds(10)))
        continue;
      const ChangedFile changed(trial->Folder() / subject.input);
      status = process.Wait();
    }
    bool is_finished = false;
    for (const auto& entry : fs::recursive_directory_iterator(trial->Results()))
      is_finished |= entry.path().filename() == "manifest.json" &&
                     FileContent(entry.path()).find("\"finished\": true") != std::string::npos;
    std::string said = trial->Said();
    for (const auto& entry : fs::recursive_directory_iterator(trial->Results()))
      if (entry.path().filename() == subject.mark) said += FileContent(entry.path());
    const auto has_said = [&](const std::string& text) {
      return said.find(text) != std::string::npos;
    };
    if (status != subject.refusal || is_finished || !has_said("has changed") ||
        !has_said(subject.input.filename().string()))
      return fmt::format("exit status {}, and nothing was said: {}", status, said);
    return trial->Finish();
  });
  return result;
}

}  // namespace lacuna
