#include "core/interrupt.h"

#include <atomic>
#include <csignal>

namespace lacuna {
namespace {

std::atomic<int> received_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may not wait for a lock");

void Remember(int signal) { received_signal.store(signal); }

void Handle(int signal) {
  struct sigaction action {};
  if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) return;
  action = {};
  action.sa_handler = &Remember;
  // SA_RESETHAND restores the default action, so that a second signal terminates the program.
  // SA_RESTART restarts system calls, so that an interrupt cannot look like a failed write.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

void InstallInterruptHandler() {
  Handle(SIGINT);
  Handle(SIGTERM);
}

bool InterruptRequested() { return received_signal.load(std::memory_order_relaxed) != 0; }

void ThrowIfInterrupted() {
  if (InterruptRequested()) throw Interrupted(received_signal.load());
}

void ClearInterrupt() { received_signal.store(0); }

}  // namespace lacuna
