#include "core/process_random.h"

namespace lacuna {

std::mutex& ProcessRandomMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace lacuna
