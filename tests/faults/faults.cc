#include "faults/faults.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "core/error.h"
#include "core/hash.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr rlim_t kNoLimit = RLIM_INFINITY;
constexpr int kUnusableInput = 2;  // exit status

// The content of a folder: hash by relative path. What a lock file holds belongs to a process.
std::map<std::string, std::string> ContentOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  if (!fs::exists(folder)) return content;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().filename() != ".lock")
      content[entry.path().lexically_relative(folder).generic_string()] = HashFile(entry.path());
  return content;
}

// The first difference; empty: there is none.
std::string Difference(const std::map<std::string, std::string>& expected,
                       const std::map<std::string, std::string>& found) {
  for (const auto& [name, hash] : expected) {
    const auto other = found.find(name);
    if (other == found.end()) return name + " is missing";
    if (other->second != hash) return name + " differs";
  }
  for (const auto& [name, hash] : found)
    if (!expected.contains(name)) return name + " is left over";
  return "";
}

// A process of the program under test, with its output in a file.
class Process {
 public:
  Process(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& where,
          const fs::path& log, rlim_t largest_file = kNoLimit) {
    pid_ = fork();
    if (pid_ < 0) throw InputError("no process can be started");
    if (pid_ > 0) return;
    const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (chdir(where.c_str()) != 0) _exit(126);
    if (largest_file != kNoLimit) {
      const rlimit limit{largest_file, largest_file};
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_IGN);  // the write fails, as on a full disk
    }
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments)
      words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  ~Process() { Kill(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // The exit status; −1: it was killed by a signal.
  int Wait() {
    int status = 0;
    if (pid_ > 0) waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  // Whether it has ended within this time.
  bool EndsWithin(Seconds time) {
    const auto end = Clock::now() + time;
    while (Clock::now() < end) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        pid_ = 0;
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }
  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    Wait();
  }

 private:
  pid_t pid_ = 0;
};

// One subject in a folder of its own.
class Trial {
 public:
  Trial(const Subject& subject, const FaultOptions& options)
      : subject_(subject),
        options_(options),
        folder_(fs::absolute(options.folder) / subject.name),
        log_(folder_ / "log.txt"),
        results_(folder_ / subject.results),
        random_(options.seed) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "experiments/recordings");
    constexpr auto kAll = fs::copy_options::recursive;
    for (const char* name : {"bend", "hidden_effect"}) {
      const fs::path experiments = options.sources / "experiments";
      fs::copy_file(experiments / (std::string(name) + ".yaml"),
                    folder_ / "experiments" / (std::string(name) + ".yaml"));
      if (fs::exists(experiments / "recordings" / name))
        fs::copy(experiments / "recordings" / name, folder_ / "experiments/recordings" / name,
                 kAll);
    }
    if (!subject.preparation.empty()) Require(subject.preparation);
    fs::copy(folder_, Prepared(), kAll);
    const auto start = Clock::now();
    Require(subject.arguments);
    duration_ = Clock::now() - start;
    expected_ = ContentOf(results_);
    fs::copy(results_, Finished(), kAll);
  }

  std::vector<FaultResult> Run() {
    std::vector<FaultResult> all{Killed(), DiskFull(), TwoProcesses(), ClockJump(), Damaged()};
    if (!subject_.input.empty()) all.push_back(ChangedInput());
    // Where nothing had to run before, the subject is an experiment, which says where to write.
    if (subject_.preparation.empty()) {
      all.push_back(UnwritableOutput());
      if (!subject_.input.empty()) all.push_back(InputChangedMeanwhile());
    }
    return all;
  }

 private:
  fs::path Prepared() const { return folder_.string() + "_prepared"; }
  fs::path Finished() const { return folder_.string() + "_finished"; }
  fs::path Input() const { return folder_ / subject_.input; }

  int Execute(const std::vector<std::string>& arguments, rlim_t largest_file = kNoLimit) {
    return Process(options_.program, arguments, folder_, log_, largest_file).Wait();
  }
  void Require(const std::vector<std::string>& arguments) {
    if (Execute(arguments) != 0)
      throw InputError(fmt::format("lacuna {} fails without any fault: {}",
                                   fmt::join(arguments, " "), FileContent(log_)));
  }
  double Random(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }

  // Sets the results back to those before the command, or to the finished ones.
  void Reset(const fs::path& from) {
    fs::remove_all(results_);
    fs::create_directories(results_.parent_path());
    if (fs::exists(from)) fs::copy(from, results_, fs::copy_options::recursive);
  }
  void StartOver() { Reset(Prepared() / subject_.results); }

  void Count(const std::string& failure, FaultResult* result) {
    ++result->trials;
    if (failure.empty())
      ++result->survived;
    else if (result->first_failure.empty())
      result->first_failure = failure;
  }
  // Runs the command to its end; what is wrong afterwards.
  std::string Finish() {
    if (const int status = Execute(subject_.arguments); status != 0)
      return fmt::format("exit status {}: {}", status, FileContent(log_));
    return Difference(expected_, ContentOf(results_));
  }

  FaultResult Killed() {
    FaultResult result{"killed at a random moment", subject_.name};
    StartOver();
    for (int kill = 0; kill < options_.kills;) {
      Process process(options_.program, subject_.arguments, folder_, log_);
      if (process.EndsWithin(Random(0, 1) * duration_)) {
        StartOver();  // it has finished from what the kills before had left
        continue;
      }
      process.Kill();
      ++kill;
      // Each kill is judged from a copy, so that the next one finds what this one has left.
      const fs::path left = folder_.string() + "_left";
      fs::remove_all(left);
      if (fs::exists(results_)) fs::copy(results_, left, fs::copy_options::recursive);
      Count(Finish(), &result);
      Reset(left);
    }
    return result;
  }

  // Every file may have so many bytes only; then the limit is gone.
  FaultResult DiskFull() {
    FaultResult result{"no space left", subject_.name};
    for (const rlim_t largest : {rlim_t{0}, rlim_t{1000}, rlim_t{20'000}}) {
      StartOver();
      const int status = Execute(subject_.arguments, largest);
      // The log of the run is a file, too, and stays empty where nothing can be written.
      if (!(status > 0) || (largest > 0 && FileContent(log_).empty()))
        Count(fmt::format("exit status {} with files of at most {} bytes", status, largest),
              &result);
      else
        Count(Finish(), &result);
    }
    return result;
  }

  FaultResult TwoProcesses() {
    FaultResult result{"two processes at once", subject_.name};
    StartOver();
    Process first(options_.program, subject_.arguments, folder_, log_);
    Process second(options_.program, subject_.arguments, folder_, folder_ / "log_2.txt");
    const int one = first.Wait(), other = second.Wait();
    std::string failure = Difference(expected_, ContentOf(results_));
    if (one != 0 && other != 0) failure = "neither has finished: " + FileContent(log_);
    Count(failure, &result);
    return result;
  }

  // All files are from the future, or from long ago.
  FaultResult ClockJump() {
    FaultResult result{"the clock jumps", subject_.name};
    for (const int days : {400, -400}) {
      Reset(Finished());
      for (const auto& entry : fs::recursive_directory_iterator(folder_))
        fs::last_write_time(entry, fs::file_time_type::clock::now() + std::chrono::days(days));
      Count(Finish(), &result);
    }
    return result;
  }

  // A file of the finished result is cut in half, or one of its bits is flipped.
  FaultResult Damaged() {
    FaultResult result{"a damaged file of the result", subject_.name};
    std::vector<std::string> names;
    for (const auto& [name, hash] : expected_) names.push_back(name);
    std::shuffle(names.begin(), names.end(), random_);
    names.resize(std::min(names.size(), static_cast<size_t>(options_.damaged_files)));
    for (const std::string& name : names)
      for (const bool cut : {true, false}) {
        Reset(Finished());
        std::string bytes = FileContent(results_ / name);
        if (bytes.empty()) continue;
        const size_t middle = bytes.size() / 2;
        if (cut)
          bytes.resize(middle);
        else
          bytes[middle] = static_cast<char>(bytes[middle] ^ 4);
        std::ofstream(results_ / name, std::ios::binary) << bytes;
        std::string failure = Finish();
        // A command does not mend the results of another one, but names what is damaged.
        if (!failure.empty() && !subject_.preparation.empty() &&
            FileContent(log_).find(fs::path(name).filename().string()) != std::string::npos) {
          Execute(subject_.preparation);
          failure = Finish();
        }
        Count(
            failure.empty() ? "" : fmt::format("{} {}: {}", name, cut ? "cut" : "flipped", failure),
            &result);
      }
    return result;
  }

  // Changes the last byte of the input that is a digit. Returns the content before.
  std::string ChangeInput() {
    const std::string before = FileContent(Input());
    std::string bytes = before;
    const size_t digit = bytes.find_last_of("0123456789");
    bytes[digit] = bytes[digit] == '1' ? '2' : '1';
    WriteInput(bytes);
    return before;
  }
  // At one stroke: whoever reads it meanwhile gets the old file or the new one.
  void WriteInput(const std::string& bytes) {
    const fs::path other = folder_ / "input";
    std::ofstream(other, std::ios::binary) << bytes;
    fs::rename(other, Input());
  }
  bool LogHas(const std::string& text) { return FileContent(log_).find(text) != std::string::npos; }

  // A measurement changes after the run; the results of before must not pass for those of the new
  // input.
  FaultResult ChangedInput() {
    FaultResult result{"an input that changes afterwards", subject_.name};
    Reset(Finished());
    const std::string before = ChangeInput();
    const int status = Execute(subject_.arguments);
    const bool is_refused = status > 0 && LogHas("changed");
    // The manifest differs in any case: it has the hashes of the inputs.
    std::map<std::string, std::string> expected = expected_, found = ContentOf(results_);
    expected.erase("manifest.json");
    found.erase("manifest.json");
    const bool is_remade = status == 0 && !Difference(expected, found).empty();
    Count(is_refused || is_remade
              ? ""
              : fmt::format("exit status {}, and the results are those of the old input", status),
          &result);
    WriteInput(before);
    return result;
  }

  // A measurement changes while the command runs, after it has hashed its inputs: nothing may be
  // finished from a mixture of old and new data.
  FaultResult InputChangedMeanwhile() {
    FaultResult result{"an input that changes meanwhile", subject_.name};
    StartOver();
    const fs::path manifest = results_ / "manifest.json";
    Process process(options_.program, subject_.arguments, folder_, log_);
    while (!fs::exists(manifest) && !process.EndsWithin(std::chrono::milliseconds(10))) continue;
    const std::string before = ChangeInput();
    const int status = process.Wait();
    const bool is_refused = status == kUnusableInput && LogHas("has changed") &&
                            LogHas(subject_.input.filename().string()) &&
                            FileContent(manifest).find("\"finished\": true") == std::string::npos;
    WriteInput(before);
    Count(is_refused
              ? Finish()
              : fmt::format("exit status {}, and nothing was said: {}", status, FileContent(log_)),
          &result);
    return result;
  }

  // The experiment names a folder below a file, and one that the kernel refuses to anybody.
  FaultResult UnwritableOutput() {
    FaultResult result{"an output that cannot be written", subject_.name};
    StartOver();
    const auto content = [this] {
      std::map<std::string, std::string> files = ContentOf(folder_);
      files.erase(log_.filename().string());
      return files;
    };
    const std::map<std::string, std::string> before = content();
    const std::string experiment = FileContent(folder_ / subject_.arguments.back());
    const size_t begin = experiment.find("\noutput:") + 1, end = experiment.find('\n', begin);
    const fs::path changed = folder_ / "experiments/unwritable.yaml";
    for (const fs::path& output : {folder_ / "experiments/bend.yaml/run", fs::path("/proc/run")}) {
      std::string text = experiment;
      std::ofstream(changed) << text.replace(begin, end - begin, "output: " + output.string());
      std::vector<std::string> arguments = subject_.arguments;
      arguments.back() = changed.string();
      const int status = Execute(arguments);
      const std::string said = FileContent(log_);
      fs::remove(changed);
      std::string failure = Difference(before, content());
      if (status != kUnusableInput || said.find(output.string()) == std::string::npos)
        failure = fmt::format("exit status {} for {}: {}", status, output.string(), said);
      Count(failure, &result);
    }
    return result;
  }

  const Subject& subject_;
  const FaultOptions& options_;
  const fs::path folder_, log_, results_;
  std::mt19937_64 random_;
  Seconds duration_{};
  std::map<std::string, std::string> expected_;
};

}  // namespace

std::vector<Subject> BundledSubjects() {
  const std::vector<std::string> fit{"fit", "experiments/hidden_effect.yaml"};
  return {{"reconstruct",
           {"reconstruct", "experiments/bend.yaml"},
           "results/bend",
           {},
           "experiments/recordings/bend/frames/points_015.ply"},
          {"fit",
           fit,
           "results/hidden_effect",
           {},
           "experiments/recordings/hidden_effect/recording_1/markers.csv"},
          {"diagnose",
           {"diagnose", "results/hidden_effect"},
           "results/hidden_effect",
           fit,
           "experiments/recordings/hidden_effect/recording_1/markers.csv"}};
}

std::vector<FaultResult> TryFaults(const Subject& subject, const FaultOptions& options) {
  for (const char* suffix : {"_prepared", "_finished", "_left"})
    fs::remove_all((fs::absolute(options.folder) / subject.name).string() + suffix);
  return Trial(subject, options).Run();
}

std::string FaultTable(const std::vector<FaultResult>& results) {
  std::string text =
      "| fault | command | trials | survived | first failure |\n|---|---|---|---|---|\n";
  for (const FaultResult& one : results)
    text += fmt::format("| {} | `{}` | {} | {} | {} |\n", one.fault, one.subject, one.trials,
                        one.survived, one.first_failure.empty() ? "–" : one.first_failure);
  return text;
}

}  // namespace lacuna
