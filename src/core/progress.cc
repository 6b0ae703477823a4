#include "core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "core/json_number.h"

namespace lacuna {
namespace {

constexpr std::string_view kEraseLine = "\r\x1b[2K";

// Progress reports and log messages share standard error; the mutex prevents their lines from
// mixing.
std::mutex standard_error_mutex;
bool live_line_shown = false;

double SteadySeconds() {
  using std::chrono::steady_clock;
  return std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
}

std::string Duration(double seconds) {
  const auto whole = static_cast<int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

double Rounded(double seconds) { return std::round(seconds * 1e3) / 1e3; }

}  // namespace

struct Progress::State {
  ProgressOptions options;
  std::mutex mutex;
  std::string stage;  // empty if no stage is open
  int64_t total = 0;
  int64_t done = 0;
  double residual = std::numeric_limits<double>::quiet_NaN();
  double begin = 0;
  double last_report = -std::numeric_limits<double>::infinity();

  double Elapsed() const { return options.clock() - begin; }

  // Assumes that the remaining steps take as long on average as those done so far.
  double Remaining() const {
    if (total <= 0 || done <= 0) return std::numeric_limits<double>::quiet_NaN();
    return Elapsed() * static_cast<double>(std::max<int64_t>(0, total - done)) /
           static_cast<double>(done);
  }

  std::string JsonLine(const char* event, const std::string& note) const {
    nlohmann::ordered_json line{{"event", event}, {"stage", stage}, {"done", done}};
    line["total"] = total > 0 ? nlohmann::json(total) : nlohmann::json();
    line["residual"] = NumberOrNull(residual);
    line["elapsed_s"] = Rounded(Elapsed());
    line["remaining_s"] = NumberOrNull(Rounded(Remaining()));
    if (!note.empty()) line["note"] = note;
    using nlohmann::ordered_json;
    return line.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }

  std::string LiveLine() const {
    std::string line = fmt::format("{:<14}", stage);
    if (total > 0) line += fmt::format(" {:>5} / {:<5}", done, total);
    if (total <= 0 && done > 0) line += fmt::format(" {:>5}", done);
    if (std::isfinite(residual)) line += fmt::format("  residual {:.3g}", residual);
    line += "  " + Duration(Elapsed());
    if (std::isfinite(Remaining())) line += ", " + Duration(Remaining()) + " remaining";
    return line;
  }
};

Progress::Progress(const ProgressOptions& options) : state_(std::make_unique<State>()) {
  state_->options = options;
  if (!state_->options.clock) state_->options.clock = &SteadySeconds;
  if (!state_->options.stream) state_->options.stream = &std::cerr;
  if (options.style == ProgressStyle::kAutomatic) {
    state_->options.style =
        isatty(STDERR_FILENO) ? ProgressStyle::kLiveLine : ProgressStyle::kJsonLines;
  }
}

Progress::~Progress() {
  // If an exception has left a stage open, no "end" is reported; only the live line is terminated.
  if (!state_->stage.empty() && state_->options.style == ProgressStyle::kLiveLine) {
    const std::lock_guard lock(standard_error_mutex);
    *state_->options.stream << "\n" << std::flush;
    live_line_shown = false;
  }
}

void Progress::Begin(const std::string& stage, int64_t total) {
  const std::lock_guard lock(state_->mutex);
  CloseStage("");
  state_->stage = stage;
  state_->total = total;
  state_->done = 0;
  state_->residual = std::numeric_limits<double>::quiet_NaN();
  state_->begin = state_->last_report = state_->options.clock();
  Emit("begin", "");
}

void Progress::Report(int64_t done, double residual) {
  const std::lock_guard lock(state_->mutex);
  if (state_->stage.empty()) return;
  state_->done = done;
  state_->residual = residual;
  const double now = state_->options.clock();
  const double interval = state_->options.style == ProgressStyle::kLiveLine
                              ? state_->options.live_interval
                              : state_->options.json_interval;
  if (now - state_->last_report < interval) return;
  state_->last_report = now;
  Emit("progress", "");
}

void Progress::End(const std::string& note) {
  const std::lock_guard lock(state_->mutex);
  CloseStage(note);
}

void Progress::CloseStage(const std::string& note) {
  if (state_->stage.empty()) return;
  Emit("end", note);
  state_->stage.clear();
}

void Progress::Emit(const char* event, const std::string& note) {
  if (state_->options.style == ProgressStyle::kSilent) return;
  std::ostream& stream = *state_->options.stream;
  const std::lock_guard lock(standard_error_mutex);
  if (state_->options.style == ProgressStyle::kJsonLines) {
    stream << state_->JsonLine(event, note) << std::flush;
    return;
  }
  stream << kEraseLine << state_->LiveLine();
  if (!note.empty()) stream << "  " << note;
  live_line_shown = std::string_view(event) != "end";
  if (!live_line_shown) stream << "\n";
  stream << std::flush;
}

std::function<void()> StageCounter(Progress* progress) {
  struct Count {
    std::mutex mutex;
    int64_t done = 0;
  };
  return [progress, count = std::make_shared<Count>()] {
    const std::lock_guard lock(count->mutex);
    progress->Report(++count->done);
  };
}

void WriteLineToStandardError(std::string_view line) {
  const std::lock_guard lock(standard_error_mutex);
  if (live_line_shown) std::cerr << kEraseLine;
  live_line_shown = false;
  std::cerr << line << "\n" << std::flush;
}

}  // namespace lacuna
