#include "core/serial_openmp.h"

#include <omp.h>

namespace lacuna {

SerialOpenMp::SerialOpenMp() : active_levels_(omp_get_max_active_levels()) {
  omp_set_max_active_levels(0);
}

SerialOpenMp::~SerialOpenMp() { omp_set_max_active_levels(active_levels_); }

}  // namespace lacuna
