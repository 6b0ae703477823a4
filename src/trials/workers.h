// Processes that share a list of jobs out among themselves.
#ifndef LACUNA_TRIALS_WORKERS_H_
#define LACUNA_TRIALS_WORKERS_H_

#include <cstddef>
#include <filesystem>
#include <functional>

namespace lacuna {

// Holds a file's lock until it goes out of scope; a process that dies lets go of it. Where another
// one has it, holds() is false.
class Claim {
 public:
  explicit Claim(const std::filesystem::path& file);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  bool holds() const { return holds_; }

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

// Each of `workers` processes of one thread calls job(k) for every k in [0, count): a job must
// claim what it works on and leave what is done. Returns 0, or 1 when a worker was stopped or ended
// badly.
int ShareOut(size_t count, int workers, const std::function<void(size_t)>& job);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_WORKERS_H_
