// Clocks that jump.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "faults/folder_content.h"
#include "faults/trial.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// What libfaketime needs to fake the time of day, and nothing else: a jump of the clock neither
// moves the monotonic clock nor the times of files.
ProcessOptions Faked(const fs::path& library) {
  return {.environment = {{"LD_PRELOAD", library.string()},
                          {"FAKETIME_DONT_FAKE_MONOTONIC", "1"},
                          {"DONT_FAKE_MONOTONIC", "1"},  // its name in older versions
                          {"NO_FAKE_STAT", "1"}}};
}

// At one stroke: libfaketime gets the old text or the new one.
void WriteOffset(const fs::path& file, const std::string& offset) {
  const fs::path other = file.string() + ".new";
  std::ofstream(other) << offset << "\n";
  fs::rename(other, file);
}

}  // namespace

fs::path FindFaketime() {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/usr/lib", ignored))
    for (const char* name : {"faketime/libfaketimeMT.so.1", "libfaketimeMT.so.1"})
      if (fs::exists(entry.path() / name, ignored)) return entry.path() / name;
  for (const char* folder : {"/usr/lib", "/usr/local/lib"}) {
    const fs::path file = fs::path(folder) / "faketime/libfaketimeMT.so.1";
    if (fs::exists(file, ignored)) return file;
  }
  return "";
}

// All files are from the future, or from long ago.
FaultResult FileTimes(Trial* trial) {
  FaultResult result{"files from another time", trial->subject().name};
  for (const int days : {400, -400})
    trial->Try(&result, fmt::format("{:+} days", days), [&] {
      trial->ResetToFinished();
      for (const auto& entry : fs::recursive_directory_iterator(trial->Folder()))
        fs::last_write_time(entry, fs::file_time_type::clock::now() + std::chrono::days(days));
      return trial->Finish();
    });
  return result;
}

// The command sees a wrong clock, or one that is set back by a day in the middle of the run.
FaultResult FakedClock(Trial* trial) {
  FaultResult result{"the clock jumps", trial->subject().name};
  const fs::path& library = trial->options().faketime;
  if (library.empty()) {
    result.note = "skipped: faketime is not installed";
    return result;
  }
  for (const char* offset : {"+400d", "-400d"})
    trial->Try(&result, offset, [&] {
      trial->StartOver();
      ProcessOptions options = Faked(library);
      options.environment["FAKETIME"] = offset;
      return trial->Finish(options);
    });
  trial->Try(&result, "a day back in the middle", [&]() -> std::string {
    const fs::path offset = trial->Folder() / "offset";
    ProcessOptions options = Faked(library);
    options.environment["FAKETIME_TIMESTAMP_FILE"] = offset.string();
    options.environment["FAKETIME_NO_CACHE"] = "1";  // the file is read whenever the time is
    // A command may run faster than it usually does; the clock is then set earlier in another run.
    bool was_set = false;
    for (int part = 2; part <= 64 && !was_set; part *= 2) {
      trial->StartOver();
      WriteOffset(offset, "+0d");
      Process process = trial->Start(options);
      was_set = !process.EndsWithin(trial->Duration() / part);
      WriteOffset(offset, "-1d");
      if (const int status = process.Wait(); status != 0)
        return fmt::format("exit status {}: {}", status, trial->Said());
    }
    fs::remove(offset);
    if (!was_set) return "the command ends before the clock can be set: " + trial->Said();
    return Difference(trial->Expected(), ContentOf(trial->Results()));
  });
  return result;
}

}  // namespace lacuna
