// What the program is doing, how far it is and how long it will take.
//
// On a terminal: one line that is rewritten in place. Elsewhere: JSON lines on the same stream,
//   {"event":"progress","stage":"fit","done":3,"total":20,"residual":0.0012,"elapsed_s":4.1,
//    "remaining_s":23.2}
// with the event "begin" at the start of a stage and "end" at its end. A residual or a remaining
// time that is not known is null.
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
  ProgressStyle style = ProgressStyle::kAutomatic;  // by whether standard error is a terminal
  // Shortest time between two reports, s; raise for shorter logs. The begin and the end of a
  // stage are always told.
  double live_interval = 0.1;
  double json_interval = 1.0;
  std::function<double()> clock;   // s; empty: the steady clock
  std::ostream* stream = nullptr;  // not owned; null: standard error
};

// One run's progress. May be called from several threads.
class Progress {
 public:
  explicit Progress(const ProgressOptions& options = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Starts a stage of `total` frames, steps or levels (0: not known beforehand). A stage that is
  // still open ends.
  void Begin(const std::string& stage, int64_t total);
  // `done` of the total stand; `residual` in whatever measure the stage minimises.
  void Report(int64_t done, double residual = std::numeric_limits<double>::quiet_NaN());
  // The stage has ended; `note` is a few words on how ("resumed", "3 frames not converged").
  void End(const std::string& note = "");

 private:
  struct State;
  void Emit(const char* event, const std::string& note);
  void CloseStage(const std::string& note);
  const std::unique_ptr<State> state_;
};

// Writes a whole line to standard error without tearing the live line of a Progress: the live line
// is erased, and comes back with the next report.
void WriteLineToStandardError(std::string_view line);

}  // namespace lacuna

#endif  // LACUNA_CORE_PROGRESS_H_
