// The implementation of gaussian_sums.h, written in GCC's vector extensions and compiled once per
// instruction set: gaussian_sums_<set>.cc defines LACUNA_LANES (4, 8 or 16) and includes this file.
//
// It must not include anything from the standard library or Eigen: the linker might keep an inline
// function compiled here for AVX-512 as the copy for the whole program.
#ifndef LACUNA_LANES
#error "define LACUNA_LANES before including this file"
#endif

#include "registration/gaussian_sums.h"

// Each instruction set includes this file once, in a file of its own.
// NOLINTBEGIN(misc-definitions-in-headers)
namespace lacuna {
namespace {

constexpr int kLanes = LACUNA_LANES;
constexpr int kGroups = kQueryBlock / kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float)), may_alias));
typedef int Ints __attribute__((vector_size(kLanes * sizeof(int)), may_alias));

inline Floats Load(const float* from) { return *reinterpret_cast<const Floats*>(from); }
inline void Store(const Floats& values, float* to) { *reinterpret_cast<Floats*>(to) = values; }

// 2^t for t ≤ 0, relative error 3e-6: 2^round(t) by its exponent bits times a minimax polynomial
// on [−½, ½].
inline Floats PowerOfTwo(Floats t) {
  t = t < -126.f ? Floats{} - 126.f : t;
  const Ints whole = __builtin_convertvector(t - 0.5f, Ints);
  const Floats part = t - __builtin_convertvector(whole, Floats);
  Floats power = part * 0.0095700971f + 0.0559178633f;
  power = power * part + 0.2402474498f;
  power = power * part + 0.6931218144f;
  power = power * part + 0.9999992614f;
  return power * reinterpret_cast<Floats>((whole + 127) << 23);
}

// 2^t for t ≤ 0 with relative error 2e-7, for values that enter a linear system.
inline Floats AccuratePowerOfTwo(Floats t) {
  t = t < -126.f ? Floats{} - 126.f : t;
  const Ints whole = __builtin_convertvector(t - 0.5f, Ints);
  const Floats part = t - __builtin_convertvector(whole, Floats);
  Floats power = part * 1.5403530393e-4f + 1.3333558146e-3f;
  power = power * part + 9.6181291076e-3f;
  power = power * part + 5.5504108665e-2f;
  power = power * part + 2.4022650696e-1f;
  power = power * part + 6.9314718056e-1f;
  power = power * part + 1.f;
  return power * reinterpret_cast<Floats>((whole + 127) << 23);
}

// e(q, p) from |q − p|² of each lane; 0 beyond the cutoff.
inline Floats Gaussian(const Floats& squared, const GaussianWidth& width) {
  const Floats value = PowerOfTwo(squared * -width.exponent);
  return squared <= width.squared_cutoff ? value : Floats{};
}

// Calls visit(x, y, z, weight) for each candidate of the list.
template <typename Visit>
inline void ForEachCandidate(const CandidateList& list, const Visit& visit) {
  for (int k = 0; k < list.leaf_count; ++k) {
    const Candidate* leaf = list.candidates + kLeaf * static_cast<long>(list.leaves[k]);
    for (int i = 0; i < kLeaf; ++i) visit(leaf[i]);
  }
}

void MassSums(const QueryBlock& block, const CandidateList& list, const GaussianWidth& width,
              MassBlock* out) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    const Floats x = Load(block.x + lane), y = Load(block.y + lane), z = Load(block.z + lane);
    Floats mass = {};
    ForEachCandidate(list, [&](const Candidate& p) {
      const Floats dx = p.x - x, dy = p.y - y, dz = p.z - z;
      mass += Gaussian(dx * dx + dy * dy + dz * dz, width);
    });
    Store(mass, out->mass + lane);
  }
}

void PosteriorSums(const QueryBlock& block, const CandidateList& list, const GaussianWidth& width,
                   PosteriorBlock* out) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    const Floats x = Load(block.x + lane), y = Load(block.y + lane), z = Load(block.z + lane);
    Floats weight = {}, shift_x = {}, shift_y = {}, shift_z = {}, spread = {};
    ForEachCandidate(list, [&](const Candidate& p) {
      const Floats dx = p.x - x, dy = p.y - y, dz = p.z - z;
      const Floats squared = dx * dx + dy * dy + dz * dz;
      const Floats e = Gaussian(squared, width) * p.weight;
      weight += e;
      shift_x += e * dx;
      shift_y += e * dy;
      shift_z += e * dz;
      // For a padding point e = 0 and |d|² = 1e34 is finite, so the product is 0.
      spread += e * squared;
    });
    Store(weight, out->weight + lane);
    Store(shift_x, out->shift_x + lane);
    Store(shift_y, out->shift_y + lane);
    Store(shift_z, out->shift_z + lane);
    Store(spread, out->spread + lane);
  }
}

void MomentSums(const QueryBlock& block, const CandidateList& list, const GaussianWidth& width,
                MomentBlock* out) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    const Floats x = Load(block.x + lane), y = Load(block.y + lane), z = Load(block.z + lane);
    Floats sum[10] = {};
    ForEachCandidate(list, [&](const Candidate& p) {
      const Floats dx = p.x - x, dy = p.y - y, dz = p.z - z;
      const Floats e = Gaussian(dx * dx + dy * dy + dz * dz, width);
      const Floats ex = e * dx, ey = e * dy, ez = e * dz;
      sum[0] += e;
      sum[1] += ex;
      sum[2] += ey;
      sum[3] += ez;
      sum[4] += ex * dx;
      sum[5] += ex * dy;
      sum[6] += ex * dz;
      sum[7] += ey * dy;
      sum[8] += ey * dz;
      sum[9] += ez * dz;
    });
    for (int k = 0; k < 10; ++k) Store(sum[k], out->moment[k] + lane);
  }
}

void KernelValues(const QueryBlock& block, const Triple* pivots, int rank,
                  const KernelTerms& kernel, LaneRow* values) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    const Floats x = Load(block.x + lane), y = Load(block.y + lane), z = Load(block.z + lane);
    for (int k = 0; k < rank; ++k) {
      const Floats dx = pivots[k].x - x, dy = pivots[k].y - y, dz = pivots[k].z - z;
      const Floats squared = dx * dx + dy * dy + dz * dz;
      Floats value = {};
      for (int s = 0; s < kernel.count; ++s) {
        value +=
            kernel.terms[s].amplitude * AccuratePowerOfTwo(squared * -kernel.terms[s].exponent);
      }
      Store(value, values[k].lane + lane);
    }
  }
}

void Expand(const LaneRow* values, const Triple* coefficients, int rank, TripleBlock* out) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    Floats x = {}, y = {}, z = {};
    for (int k = 0; k < rank; ++k) {
      const Floats value = Load(values[k].lane + lane);
      x += coefficients[k].x * value;
      y += coefficients[k].y * value;
      z += coefficients[k].z * value;
    }
    Store(x, out->x + lane);
    Store(y, out->y + lane);
    Store(z, out->z + lane);
  }
}

void Project(const LaneRow* values, const TripleBlock& force, int rank, TripleBlock* projection) {
  for (int g = 0; g < kGroups; ++g) {
    const int lane = g * kLanes;
    const Floats x = Load(force.x + lane), y = Load(force.y + lane), z = Load(force.z + lane);
    for (int k = 0; k < rank; ++k) {
      const Floats value = Load(values[k].lane + lane);
      Store(Load(projection[k].x + lane) + x * value, projection[k].x + lane);
      Store(Load(projection[k].y + lane) + y * value, projection[k].y + lane);
      Store(Load(projection[k].z + lane) + z * value, projection[k].z + lane);
    }
  }
}

}  // namespace
}  // namespace lacuna
// NOLINTEND(misc-definitions-in-headers)
