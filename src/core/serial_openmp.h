// Keeps OpenMP loops inside libraries on the calling thread.
#ifndef LACUNA_CORE_SERIAL_OPENMP_H_
#define LACUNA_CORE_SERIAL_OPENMP_H_

namespace lacuna {

// While one of these lives, parallel regions that this thread meets run on it alone. CHOLMOD opens
// four OpenMP threads for each small copy between supernodes, whatever the machine: on two cores
// its factorisation is two to four times slower with them than without.
class SerialOpenMp {
 public:
  SerialOpenMp();
  ~SerialOpenMp();
  SerialOpenMp(const SerialOpenMp&) = delete;
  SerialOpenMp& operator=(const SerialOpenMp&) = delete;

 private:
  int active_levels_;  // to come back to
};

}  // namespace lacuna

#endif  // LACUNA_CORE_SERIAL_OPENMP_H_
