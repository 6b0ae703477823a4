// Ctrl-C, obeyed at places where nothing is half-done.
//
// The first SIGINT or SIGTERM only sets a flag, which long loops look at; a second one ends the
// program at once. Results are written atomically, so that both leave a sound run folder.
#ifndef LACUNA_CORE_INTERRUPT_H_
#define LACUNA_CORE_INTERRUPT_H_

#include <stdexcept>

namespace lacuna {

// Thrown by ThrowIfInterrupted; main catches it and ends with ExitCode().
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal) : std::runtime_error("interrupted"), signal_(signal) {}
  int ExitCode() const { return 128 + signal_; }  // 130 for Ctrl-C, as a shell expects

 private:
  int signal_;
};

// Handles SIGINT and SIGTERM from now on, except one that the parent process had set to be ignored.
void InstallInterruptHandler();

bool InterruptRequested();

// Call where the work so far may be thrown away.
void ThrowIfInterrupted();

// Forgets a request, for a program that goes on with something else.
void ClearInterrupt();

}  // namespace lacuna

#endif  // LACUNA_CORE_INTERRUPT_H_
