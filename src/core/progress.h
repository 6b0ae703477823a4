// Progress reports: the current stage, the completed part of it and the estimated remaining time.
//
// A terminal gets one line that is rewritten in place. Any other stream gets JSON lines,
//   {"event":"progress","stage":"fit","done":3,"total":20,"residual":0.0012,"elapsed_s":4.1,
//    "remaining_s":23.2}
// with the event "begin" at the start of a stage and "end" at its end. An unknown residual or
// remaining time is null.
#ifndef LACUNA_CORE_PROGRESS_H_
#define LACUNA_CORE_PROGRESS_H_

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

namespace lacuna {

enum class ProgressStyle { kAutomatic, kLiveLine, kJsonLines, kSilent };

struct ProgressOptions {
  // kAutomatic chooses the live line if standard error is a terminal, and JSON lines otherwise.
  ProgressStyle style = ProgressStyle::kAutomatic;
  // Shortest time between two reports, s. Raising it shortens the log. The beginning and the end of
  // a stage are always reported.
  double live_interval = 0.1;
  double json_interval = 1.0;
  std::function<double()> clock = {};  // s; the steady clock if empty
  std::ostream* stream = nullptr;      // not owned; standard error if null
};

// The progress of one run. All functions may be called from several threads.
class Progress {
 public:
  explicit Progress(const ProgressOptions& options = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Starts a stage of `total` frames, steps or levels; 0 if the number is not known in advance.
  // Ends the current stage if there is one.
  void Begin(const std::string& stage, int64_t total);
  // Reports that `done` of the total are finished. `residual` is the quantity that the stage
  // minimises, in the unit of that quantity; NaN if it is unknown.
  void Report(int64_t done, double residual = std::numeric_limits<double>::quiet_NaN());
  // Ends the stage. `note` describes briefly how it ended ("resumed", "3 frames not converged").
  void End(const std::string& note = "");

 private:
  struct State;
  void Emit(const char* event, const std::string& note);
  void CloseStage(const std::string& note);
  const std::unique_ptr<State> state_;
};

// A function that adds 1 to what is done of the current stage and reports it. It counts from 0 and
// belongs to the stage during which it is made. Several threads may call it; the reported count
// never goes backwards. `progress` must outlive it.
std::function<void()> StageCounter(Progress* progress);

// Writes a line and a newline to standard error. The live line of a Progress is erased first and is
// written again with the next report.
void WriteLineToStandardError(std::string_view line);

}  // namespace lacuna

#endif  // LACUNA_CORE_PROGRESS_H_
