// Handling of Ctrl-C: long computations stop at points where no incomplete result is left behind.
//
// The first SIGINT or SIGTERM sets a flag that long loops poll. Where none of them does within
// kStopGrace, inside a library for instance, the program is ended; the same signal once more ends
// it at once.
// Results are written atomically, so the run folder remains valid in all cases.
//
// The signals are blocked in all threads and taken by one that waits for them. Libraries that set
// handlers of their own (METIS takes every SIGTERM for an error in its memory) never see one.
#ifndef LACUNA_CORE_INTERRUPT_H_
#define LACUNA_CORE_INTERRUPT_H_

#include <chrono>
#include <csignal>
#include <stdexcept>

namespace lacuna {

// How long a computation may take to stop by itself. With a longer time less work is thrown away,
// but Ctrl-C seems not to work.
inline constexpr std::chrono::milliseconds kStopGrace{1500};

// Thrown by ThrowIfInterrupted; main catches it, prints kStoppedMessage and exits with ExitCode().
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal) : std::runtime_error("interrupted"), signal_(signal) {}
  int ExitCode() const { return 128 + signal_; }  // 130 for Ctrl-C, by the shells' convention

 private:
  int signal_;
};

inline constexpr char kStoppedMessage[] = "stopped; run the same command again to resume";

// Blocks SIGINT and SIGTERM in this thread and in those that it starts from now on, but not a
// signal that the parent process has set to be ignored. A second call does nothing. The programs
// call it before their libraries are initialised, since OpenBLAS starts threads then; a signal
// could otherwise reach one of these.
void BlockInterruptSignals();

// Blocks the signals, if they are not blocked yet, and starts to wait for them.
void InstallInterruptHandler();

// To be called first in a process that was forked from one with the handler, whose thread the new
// process does not have. Does nothing if there was none.
void RestartInterruptHandler();

// The signals that were blocked before BlockInterruptSignals(): a program that this one starts
// should have this mask. Empty if nothing was blocked.
sigset_t SignalMaskOfStartedPrograms();

// Whether a signal has arrived. May be called from any thread.
bool InterruptRequested();

// Throws Interrupted if a signal has arrived. Call it only where unfinished work may be discarded.
void ThrowIfInterrupted();

}  // namespace lacuna

#endif  // LACUNA_CORE_INTERRUPT_H_
