// Handling of Ctrl-C: long computations stop at points where no work is half-done.
//
// The first SIGINT or SIGTERM sets a flag that long loops poll; a second one terminates the program
// at once. Results are written atomically, so the run folder stays valid in both cases.
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

// Handles SIGINT and SIGTERM from now on. A signal that the parent process has set to be ignored
// stays ignored.
void InstallInterruptHandler();

// Whether a signal has arrived. May be called from any thread.
bool InterruptRequested();

// Throws Interrupted if a signal has arrived. Call it where unfinished work may be discarded.
void ThrowIfInterrupted();

// Resets the flag, for a program that continues with another task.
void ClearInterrupt();

}  // namespace lacuna

#endif  // LACUNA_CORE_INTERRUPT_H_
