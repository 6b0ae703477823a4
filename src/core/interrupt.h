// Handling of Ctrl-C: long computations stop at points where no incomplete result is left behind.
//
// The first SIGINT or SIGTERM sets a flag that long loops poll; a second signal terminates the
// program at once. Results are written atomically, so the run folder remains valid in both cases.
#ifndef LACUNA_CORE_INTERRUPT_H_
#define LACUNA_CORE_INTERRUPT_H_

#include <stdexcept>

namespace lacuna {

// Thrown by ThrowIfInterrupted; main catches it and exits with ExitCode().
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal) : std::runtime_error("interrupted"), signal_(signal) {}
  int ExitCode() const { return 128 + signal_; }  // 130 for Ctrl-C, by the shells' convention

 private:
  int signal_;
};

// Installs the handler of SIGINT and SIGTERM. A signal that the parent process has set to be
// ignored remains ignored.
void InstallInterruptHandler();

// Whether a signal has arrived. May be called from any thread.
bool InterruptRequested();

// Throws Interrupted if a signal has arrived. Call it only where unfinished work may be discarded.
void ThrowIfInterrupted();

// Resets the flag, for a program that continues with another task.
void ClearInterrupt();

}  // namespace lacuna

#endif  // LACUNA_CORE_INTERRUPT_H_
