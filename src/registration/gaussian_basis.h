// A low-rank basis of the Gaussian kernel of motion coherence, continuous in space.
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

// Functions φ_1 … φ_K with Σ_k φ_k(a) φ_k(b) ≈ k(a, b): pivoted Cholesky decomposition of the
// kernel matrix of the given points (Harbrecht, Peters & Schneider 2012). With p the pivots and L
// the Cholesky factor of k(p, p), φ(y) = L⁻¹ k(p, y), which holds for every y, not only for the
// points; φ_k vanishes at the pivots before the k-th, so the first functions are a basis of less
// rank.
class GaussianBasis {
 public:
  GaussianBasis() = default;
  // Stops at `max_rank` or when no point misses more than `tolerance` of its variance k(y, y).
  GaussianBasis(const Eigen::Matrix3Xd& points, std::vector<KernelScale> kernel, double tolerance,
                int max_rank);

  int Rank() const { return static_cast<int>(pivots_.cols()); }
  double Variance() const;  // k(y, y)
  // Whether the last of the functions is so small that single precision leaves too little of
  // k(p, y) = L φ(y), and of the functions' products, for it.
  bool IsFine() const;
  const std::vector<KernelScale>& Kernel() const { return kernel_; }
  const Eigen::Matrix3Xd& Pivots() const { return pivots_; }

  // The basis of the first `rank` functions.
  GaussianBasis Leading(int rank) const;

  // w with Σ_k c_k φ_k(y) = Σ_k w_k k(p_k, y), i.e. c L⁻¹, and s L⁻ᵀ: Σ_i f_i φ(y_i)ᵀ from
  // s = Σ_i f_i k(p, y_i)ᵀ. All 3 × K.
  Eigen::Matrix3Xd KernelWeights(const Eigen::Matrix3Xd& coefficients) const;
  Eigen::Matrix3Xd FromKernelSpace(const Eigen::Matrix3Xd& sums) const;

  // φ at points: K × n.
  Eigen::MatrixXd Values(const Eigen::Matrix3Xd& points) const;

  // ∂φ/∂x, ∂φ/∂y, ∂φ/∂z at points, each K × n.
  void Gradients(const Eigen::Matrix3Xd& points, Eigen::MatrixXd gradient[3]) const;

 private:
  std::vector<KernelScale> kernel_;
  Eigen::Matrix3Xd pivots_;
  Eigen::MatrixXd factor_;  // L, K × K
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_GAUSSIAN_BASIS_H_
