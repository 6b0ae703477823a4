// Restricts OpenMP loops inside libraries to the calling thread.
#ifndef LACUNA_CORE_SERIAL_OPENMP_H_
#define LACUNA_CORE_SERIAL_OPENMP_H_

namespace lacuna {

// During the lifetime of an object, OpenMP parallel regions that this thread enters run serially.
// CHOLMOD uses four OpenMP threads for each small copy between supernodes on every machine; on two
// cores, its factorisation is two to four times slower with these threads than without them.
class SerialOpenMp {
 public:
  SerialOpenMp();
  ~SerialOpenMp();
  SerialOpenMp(const SerialOpenMp&) = delete;
  SerialOpenMp& operator=(const SerialOpenMp&) = delete;

 private:
  int active_levels_;  // the value to restore
};

}  // namespace lacuna

#endif  // LACUNA_CORE_SERIAL_OPENMP_H_
