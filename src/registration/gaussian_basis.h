// A low-rank basis, continuous in space, of the Gaussian kernel of motion coherence.
#ifndef LACUNA_REGISTRATION_GAUSSIAN_BASIS_H_
#define LACUNA_REGISTRATION_GAUSSIAN_BASIS_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

// One Gaussian of a kernel k(a, b) = Σ_s amplitude_s exp(−|a − b|² / 2 width_s²).
struct KernelScale {
  double width = 1.0;
  double amplitude = 1.0;
};

// Functions φ_1 … φ_K with Σ_k φ_k(a) φ_k(b) ≈ k(a, b), by pivoted Cholesky decomposition of the
// kernel matrix of the given points (H. Harbrecht, M. Peters and R. Schneider, Appl. Numer. Math.
// 62, 2012). With the pivots p and the Cholesky factor L of k(p, p), φ(y) = L⁻¹ k(p, y) for every
// y, not only for the points. φ_k vanishes at the pivots before the k-th, so the first functions
// form a basis of lower rank.
class GaussianBasis {
 public:
  GaussianBasis() = default;
  // Adds functions until there are `max_rank` or until at every point y the unexplained part of the
  // variance is at most `tolerance` · k(y, y). `points`: 3 × n, in the unit of the kernel's widths.
  GaussianBasis(const Eigen::Matrix3Xd& points, std::vector<KernelScale> kernel, double tolerance,
                int max_rank);

  int Rank() const { return static_cast<int>(pivots_.cols()); }
  double Variance() const;  // k(y, y)
  // Whether the last function is too small to be computed from kernel values in single precision.
  bool IsFine() const;
  const std::vector<KernelScale>& Kernel() const { return kernel_; }
  const Eigen::Matrix3Xd& Pivots() const { return pivots_; }

  // The basis of the first `rank` functions.
  GaussianBasis Leading(int rank) const;

  // The weights w = c L⁻¹ with Σ_k c_k φ_k(y) = Σ_k w_k k(p_k, y). Both are 3 × K.
  Eigen::Matrix3Xd KernelWeights(const Eigen::Matrix3Xd& coefficients) const;
  // Σ_i f_i φ(y_i)ᵀ = s L⁻ᵀ from the sums s = Σ_i f_i k(p, y_i)ᵀ. Both are 3 × K.
  Eigen::Matrix3Xd FromKernelSpace(const Eigen::Matrix3Xd& sums) const;

  // φ at `points` (3 × n): K × n.
  Eigen::MatrixXd Values(const Eigen::Matrix3Xd& points) const;

  // ∂φ/∂x, ∂φ/∂y and ∂φ/∂z at `points` (3 × n), each K × n.
  void Gradients(const Eigen::Matrix3Xd& points, Eigen::MatrixXd gradient[3]) const;

 private:
  std::vector<KernelScale> kernel_;
  Eigen::Matrix3Xd pivots_;
  Eigen::MatrixXd factor_;  // L, K × K
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_GAUSSIAN_BASIS_H_
