#include "core/interrupt.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <ctime>
#include <optional>
#include <thread>

#include "core/progress.h"

namespace lacuna {
namespace {

std::atomic<int> received_signal{0};

// What BlockInterruptSignals() has set. It may be called before any static initialisation.
struct Blocked {
  sigset_t awaited;  // those that are waited for
  sigset_t before;   // those that were blocked before
};
constinit std::optional<Blocked> blocked;
std::atomic<bool> is_watching{false};

bool IsIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// Ends the process as this signal does if nothing is installed for it.
[[noreturn]] void EndBy(int signal) {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  sigaction(signal, &action, nullptr);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  raise(signal);
  _exit(128 + signal);
}

// Waits for the first signal and then for a second one of the same number, or for the end of the
// grace. (A terminal sends SIGINT to all processes, and the parent of workers then SIGTERM.)
void Watch(sigset_t awaited) {
  int first = 0;
  if (sigwait(&awaited, &first) != 0) return;
  received_signal.store(first);
  sigset_t same;
  sigemptyset(&same);
  sigaddset(&same, first);
  const timespec grace{kStopGrace.count() / 1000, kStopGrace.count() % 1000 * 1'000'000};
  int second = 0;
  do second = sigtimedwait(&same, nullptr, &grace);
  while (second < 0 && errno == EINTR);
  if (second > 0) EndBy(second);
  // Where nobody reads standard error any more, the message must not hold up the end.
  signal(SIGALRM, SIG_DFL);
  alarm(1);
  WriteLineToStandardError(kStoppedMessage);
  _exit(128 + first);
}

}  // namespace

void BlockInterruptSignals() {
  if (blocked) return;
  Blocked now{};
  sigemptyset(&now.awaited);
  for (const int signal : {SIGINT, SIGTERM})
    if (!IsIgnored(signal)) sigaddset(&now.awaited, signal);
  pthread_sigmask(SIG_BLOCK, &now.awaited, &now.before);
  blocked = now;
}

void InstallInterruptHandler() {
  BlockInterruptSignals();
  is_watching = true;
  std::thread(&Watch, blocked->awaited).detach();
}

void RestartInterruptHandler() {
  if (is_watching) std::thread(&Watch, blocked->awaited).detach();
}

sigset_t SignalMaskOfStartedPrograms() {
  if (blocked) return blocked->before;
  sigset_t none;
  sigemptyset(&none);
  return none;
}

bool InterruptRequested() { return received_signal.load(std::memory_order_relaxed) != 0; }

void ThrowIfInterrupted() {
  if (InterruptRequested()) throw Interrupted(received_signal.load());
}

}  // namespace lacuna
