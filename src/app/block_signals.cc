// Blocks the signals of Ctrl-C before the shared libraries are initialised (core/interrupt.h): the
// functions of .preinit_array are called before theirs.
#include "core/interrupt.h"

namespace {

[[gnu::used,
  gnu::section(".preinit_array")]] void (*const block_signals)() = &lacuna::BlockInterruptSignals;

}  // namespace
