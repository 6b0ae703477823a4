// The inner loops of registration: truncated Gaussian sums between blocks of points, and products
// with a table of kernel values.
//
// With e(q, p) = exp(−|q − p|² / 2σ²) for |q − p| ≤ cutoff and 0 beyond, for each of the sixteen
// queries q of a block and over the candidates p of a list of leaves:
//   MassSums      mass     = Σ_p e
//   PosteriorSums weight   = Σ_p e w_p,   shift = Σ_p e w_p (p − q),   spread = Σ_p e w_p |p − q|²
//   MomentSums    the ten moments Σ_p e {1, d, d dᵀ} with d = p − q
// With values[k] = Σ_s amplitude_s exp(−|q − pivot_k|² / 2 width_s²), k < rank:
//   KernelValues  the values for a block of queries
//   Expand        Σ_k coefficient_k values[k], for vector coefficients
//   Project       projection_k += force · values[k], lane by lane, for vector forces
// All are computed in single precision. All truncate the same pairs, since |q − p|² does not depend
// on which of the two points is the query.
//
// Each function exists for three instruction sets, one of which is chosen at run time. Results are
// reproducible for one set and agree to a relative 1e-6 between sets, because fused multiply-adds
// round differently.
#ifndef LACUNA_REGISTRATION_GAUSSIAN_SUMS_H_
#define LACUNA_REGISTRATION_GAUSSIAN_SUMS_H_

namespace lacuna {

inline constexpr int kQueryBlock = 16;  // queries that are processed together, one per SIMD lane
inline constexpr int kLeaf = 8;         // candidates that are visited or skipped together

// The coordinate of padding points: beyond any cutoff, but without overflow of its square.
inline constexpr float kFarAway = 1e17f;

struct alignas(64) QueryBlock {
  float x[kQueryBlock];
  float y[kQueryBlock];
  float z[kQueryBlock];
};

struct alignas(16) Candidate {
  float x = kFarAway;
  float y = kFarAway;
  float z = kFarAway;
  float weight = 0.f;
};

// The candidates [8·leaves[k], 8·leaves[k] + 8) for k < leaf_count. Owns nothing.
struct CandidateList {
  const Candidate* candidates = nullptr;
  const int* leaves = nullptr;
  int leaf_count = 0;
};

struct GaussianWidth {
  float exponent = 0.f;        // 1 / (2 σ² ln 2), so that e = 2^(−exponent·|d|²)
  float squared_cutoff = 0.f;  // cutoff²
};

struct alignas(64) MassBlock {
  float mass[kQueryBlock];
};
struct alignas(64) PosteriorBlock {
  float weight[kQueryBlock];
  float shift_x[kQueryBlock];
  float shift_y[kQueryBlock];
  float shift_z[kQueryBlock];
  float spread[kQueryBlock];
};
struct alignas(64) MomentBlock {
  float moment[10][kQueryBlock];  // 1, x, y, z, xx, xy, xz, yy, yz, zz
};

// One Gaussian of a kernel: amplitude · 2^(−exponent·|d|²).
struct GaussianTerm {
  float exponent = 0.f;
  float amplitude = 0.f;
};
struct KernelTerms {
  const GaussianTerm* terms = nullptr;
  int count = 0;
};

// One value per lane, and three values (a vector) as scalars and per lane.
struct alignas(64) LaneRow {
  float lane[kQueryBlock];
};
struct Triple {
  float x = 0.f;
  float y = 0.f;
  float z = 0.f;
};
struct alignas(64) TripleBlock {
  float x[kQueryBlock];
  float y[kQueryBlock];
  float z[kQueryBlock];
};

enum class InstructionSet { kBaseline, kAvx2, kAvx512 };

// The functions above for one instruction set. All arrays have `rank` entries.
struct GaussianKernels {
  InstructionSet set = InstructionSet::kBaseline;
  void (*mass_sums)(const QueryBlock&, const CandidateList&, const GaussianWidth&, MassBlock*);
  void (*posterior_sums)(const QueryBlock&, const CandidateList&, const GaussianWidth&,
                         PosteriorBlock*);
  void (*moment_sums)(const QueryBlock&, const CandidateList&, const GaussianWidth&, MomentBlock*);
  void (*kernel_values)(const QueryBlock&, const Triple* pivots, int rank, const KernelTerms&,
                        LaneRow* values);
  void (*expand)(const LaneRow* values, const Triple* coefficients, int rank, TripleBlock*);
  void (*project)(const LaneRow* values, const TripleBlock& force, int rank,
                  TripleBlock* projection);
};

// Whether this processor supports the instruction set.
bool IsSupported(InstructionSet set);
// The kernels for an instruction set, which this processor must support (CHECK).
const GaussianKernels& KernelsFor(InstructionSet set);

// The kernels for the best instruction set that this processor supports.
const GaussianKernels& BestKernels();

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_GAUSSIAN_SUMS_H_
