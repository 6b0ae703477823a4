// A progress that writes nothing.
#ifndef LACUNA_TESTS_SUPPORT_SILENT_PROGRESS_H_
#define LACUNA_TESTS_SUPPORT_SILENT_PROGRESS_H_

#include "core/progress.h"

namespace lacuna {

struct SilentProgress : Progress {
  SilentProgress() : Progress({.style = ProgressStyle::kSilent}) {}
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_SILENT_PROGRESS_H_
