// Runs CalculiX (ccx) on an exported file and compares its displacements with those of Lacuna.
#ifndef LACUNA_EXCHANGE_CALCULIX_H_
#define LACUNA_EXCHANGE_CALCULIX_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

// The displacements of all nodes at the end of the first step and at each frame.
struct CalculixResult {
  enum class Status { kNotRun, kAbsent, kFailed, kDone };
  Status status = Status::kNotRun;
  std::string message;           // of a failure: what ccx said; else empty
  Eigen::MatrixXd displacement;  // 3n × (1 + frames), node-major, m
  bool IsUsable() const { return status == Status::kDone; }
};

// Whether `ccx` is found on the PATH.
bool HasCalculix();

// Runs `ccx` on one core on a copy of `inp` in `folder`, which is created and keeps all files that
// ccx writes. The file is one of InpText(…, kCalculix) with `nodes` nodes and these frames (s).
// kAbsent: there is no ccx. kFailed: it stopped early, and `message` quotes its errors. Throws
// InputError where files cannot be written, and Interrupted after it has ended ccx.
CalculixResult RunCalculix(const std::filesystem::path& inp, const std::filesystem::path& folder,
                           Eigen::Index nodes, const std::vector<double>& frames);

// Differences of the displacements of two programs over nodes and times. Relative ones refer to the
// largest displacement of a node in `expected` at any time.
struct DisplacementDifference {
  double largest_displacement = 0;  // m, in `expected`
  double largest_difference = 0;    // m
  double largest = 0, rms = 0;      // relative

  // Whether a body of this size, m, is displaced in `expected` by more than rounding errors.
  // Relative differences mean nothing otherwise.
  bool IsDisplaced(double size) const { return largest_displacement > 1e-9 * size; }
};
// The arguments are 3n × times, m, and of the same size (CHECK).
DisplacementDifference CompareDisplacements(const Eigen::MatrixXd& expected,
                                            const Eigen::MatrixXd& found);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_CALCULIX_H_
