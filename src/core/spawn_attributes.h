// How this program starts another one.
#ifndef LACUNA_CORE_SPAWN_ATTRIBUTES_H_
#define LACUNA_CORE_SPAWN_ATTRIBUTES_H_

#include <spawn.h>

#include "core/interrupt.h"

namespace lacuna {

// Attributes for posix_spawn: the started program can be stopped by Ctrl-C, which this one blocks
// in all of its threads (core/interrupt.h).
class SpawnAttributes {
 public:
  SpawnAttributes() {
    const sigset_t mask = SignalMaskOfStartedPrograms();
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setsigmask(&attributes_, &mask);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;

  const posix_spawnattr_t* Get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_SPAWN_ATTRIBUTES_H_
