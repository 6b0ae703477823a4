#include "fem/dense_front.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

extern "C" void spotrf_(const char* uplo, const int* n, float* a, const int* lda, int* info);

// Compiled for three generations of processors, chosen when the program starts.
#define LACUNA_FOR_EACH_PROCESSOR \
  __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))

namespace lacuna {
namespace {

// Rounding errors of a pivot are at most some thousand times 6e-8.
constexpr float kCertainlyNegative = -1e-3f;
constexpr int kEliminationBlock = 192;   // columns eliminated before the rest is updated
constexpr int kTile = 256;               // columns of an update that one thread does at a time
constexpr int kSubstitutionBlock = 128;  // columns substituted before the rest is updated
constexpr int kRowsPerTask = 1024;       // of a forward substitution
constexpr int kGroup = 8;                // columns that one pass over a vector deals with

// update ← update − rows · rowsᵀ (lower triangle), rows: n × k.
void SubtractOuterProduct(int n, int k, const float* rows, int rows_stride, float* update,
                          int update_stride) {
  ParallelBlocks(n, kTile, [&](int64_t begin, int64_t end) {
    const int width = static_cast<int>(end - begin), below = n - static_cast<int>(end);
    float* target = update + begin * update_stride;
    cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, width, k, -1, rows + begin, rows_stride, 1,
                target + begin, update_stride);
    if (below == 0) return;
    cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, below, width, k, -1, rows + end,
                rows_stride, rows + begin, rows_stride, 1, target + end, update_stride);
  });
}

// y ← y − Σ_c columns(:, c) · factor[c] over a group of columns.
LACUNA_FOR_EACH_PROCESSOR
void SubtractColumns(int rows, const float* columns, int stride, const float* factor, float* y) {
  const float *c0 = columns, *c1 = c0 + stride, *c2 = c1 + stride, *c3 = c2 + stride,
              *c4 = c3 + stride, *c5 = c4 + stride, *c6 = c5 + stride, *c7 = c6 + stride;
#pragma omp simd
  for (int i = 0; i < rows; ++i) {
    y[i] -= ((c0[i] * factor[0] + c1[i] * factor[1]) + (c2[i] * factor[2] + c3[i] * factor[3])) +
            ((c4[i] * factor[4] + c5[i] * factor[5]) + (c6[i] * factor[6] + c7[i] * factor[7]));
  }
}

// sum[c] = columns(:, c) · y over a group of columns.
LACUNA_FOR_EACH_PROCESSOR
void DotColumns(int rows, const float* columns, int stride, const float* y, float* sum) {
  const float *c0 = columns, *c1 = c0 + stride, *c2 = c1 + stride, *c3 = c2 + stride,
              *c4 = c3 + stride, *c5 = c4 + stride, *c6 = c5 + stride, *c7 = c6 + stride;
  float s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, s5 = 0, s6 = 0, s7 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4, s5, s6, s7)
  for (int i = 0; i < rows; ++i) {
    s0 += c0[i] * y[i];
    s1 += c1[i] * y[i];
    s2 += c2[i] * y[i];
    s3 += c3[i] * y[i];
    s4 += c4[i] * y[i];
    s5 += c5[i] * y[i];
    s6 += c6[i] * y[i];
    s7 += c7[i] * y[i];
  }
  sum[0] = s0, sum[1] = s1, sum[2] = s2, sum[3] = s3;
  sum[4] = s4, sum[5] = s5, sum[6] = s6, sum[7] = s7;
}

// The same two for fewer columns than a group has.
void SubtractColumn(int rows, const float* column, float factor, float* y) {
  for (int i = 0; i < rows; ++i) y[i] -= column[i] * factor;
}

float DotColumn(int rows, const float* column, const float* y) {
  float sum = 0;
  for (int i = 0; i < rows; ++i) sum += column[i] * y[i];
  return sum;
}

// Substitutes columns [begin, end), at most a block, and updates y up to row `end`.
void ForwardWithinBlock(int m, int begin, int end, const float* panel, float* y) {
  const auto at = [&](int i, int j) { return panel + i + static_cast<int64_t>(j) * m; };
  for (int j = begin; j < end; j += kGroup) {
    const int width = std::min(kGroup, end - j);
    for (int c = j; c < j + width; ++c) {
      y[c] *= *at(c, c);
      SubtractColumn(j + width - c - 1, at(c + 1, c), y[c], y + c + 1);
    }
    const int below = j + width;
    if (width == kGroup) {
      SubtractColumns(end - below, at(below, j), m, y + j, y + below);
    } else {
      for (int c = j; c < j + width; ++c)
        SubtractColumn(end - below, at(below, c), y[c], y + below);
    }
  }
}

// y(begin…end) −= columns [begin, end) over rows [from, m), dotted with y(from…m).
void SubtractDots(int m, int begin, int end, int from, const float* panel, float* y) {
  float sum[kGroup];
  for (int j = begin; j < end; j += kGroup) {
    const float* columns = panel + from + static_cast<int64_t>(j) * m;
    const int width = std::min(kGroup, end - j);
    if (width == kGroup) {
      DotColumns(m - from, columns, m, y + from, sum);
    } else {
      for (int c = 0; c < width; ++c) {
        sum[c] = DotColumn(m - from, columns + static_cast<int64_t>(c) * m, y + from);
      }
    }
    for (int c = 0; c < width; ++c) y[j + c] -= sum[c];
  }
}

void BackwardWithinBlock(int m, int begin, int end, const float* panel, float* y) {
  const auto at = [&](int i, int j) { return panel + i + static_cast<int64_t>(j) * m; };
  const int last = begin + (end - begin - 1) / kGroup * kGroup;
  for (int j = last; j >= begin; j -= kGroup) {
    const int stop = std::min(j + kGroup, end);
    float sum[kGroup] = {};
    if (stop - j == kGroup) {
      DotColumns(end - stop, at(stop, j), m, y + stop, sum);
    } else {
      for (int c = j; c < stop; ++c) sum[c - j] = DotColumn(end - stop, at(stop, c), y + stop);
    }
    for (int c = stop - 1; c >= j; --c) {
      y[c] = (y[c] - sum[c - j] - DotColumn(stop - c - 1, at(c + 1, c), y + c + 1)) * *at(c, c);
    }
  }
}

}  // namespace

Pivots EliminateColumns(int m, int p, float* panel, float* update) {
  for (int begin = 0; begin < p; begin += kEliminationBlock) {
    const int end = std::min(p, begin + kEliminationBlock), width = end - begin;
    float* diagonal = panel + begin + static_cast<int64_t>(begin) * m;
    int info = 0;
    spotrf_("L", &width, diagonal, &m, &info);
    // LAPACK stops with the pivot that failed in its place.
    for (int j = 0; j < (info > 0 ? info : width); ++j) {
      const float pivot = diagonal[j + static_cast<int64_t>(j) * m];
      if (pivot < kCertainlyNegative) return Pivots::kNegative;
      if (!(pivot > 0) || !std::isfinite(pivot)) return Pivots::kInDoubt;
    }
    if (info != 0) return Pivots::kInDoubt;
    if (end == m) break;
    ParallelBlocks(m - end, kRowsPerTask, [&](int64_t first, int64_t last) {
      cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit,
                  static_cast<int>(last - first), width, 1, diagonal, m, diagonal + width + first,
                  m);
    });
    // The columns of the panel that are still to be eliminated, with all their rows.
    ParallelBlocks(p - end, kTile, [&](int64_t first, int64_t last) {
      const float* rows = diagonal + width + first;
      cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, m - end - static_cast<int>(first),
                  static_cast<int>(last - first), width, -1, rows, m, rows, m, 1,
                  panel + end + first + (end + first) * static_cast<int64_t>(m), m);
    });
  }
  if (m > p) SubtractOuterProduct(m - p, p, panel + p, m, update, m - p);
  for (int j = 0; j < p; ++j) {
    float& pivot = panel[j + static_cast<int64_t>(j) * m];
    pivot = 1 / pivot;
  }
  return Pivots::kPositive;
}

void ForwardSubstitute(int m, int p, const float* panel, float* y) {
  for (int begin = 0; begin < p; begin += kSubstitutionBlock) {
    const int end = std::min(p, begin + kSubstitutionBlock);
    ForwardWithinBlock(m, begin, end, panel, y);
    ParallelBlocks(m - end, kRowsPerTask, [&](int64_t first, int64_t last) {
      const int rows = static_cast<int>(last - first), from = end + static_cast<int>(first);
      for (int j = begin; j < end; j += kGroup) {
        const float* columns = panel + from + static_cast<int64_t>(j) * m;
        if (end - j >= kGroup) {
          SubtractColumns(rows, columns, m, y + j, y + from);
        } else {
          for (int c = j; c < end; ++c) {
            SubtractColumn(rows, columns + static_cast<int64_t>(c - j) * m, y[c], y + from);
          }
        }
      }
    });
  }
}

void BackwardSubstitute(int m, int p, const float* panel, float* y) {
  const int last = (p - 1) / kSubstitutionBlock * kSubstitutionBlock;
  for (int begin = last; begin >= 0; begin -= kSubstitutionBlock) {
    const int end = std::min(p, begin + kSubstitutionBlock);
    const int columns_per_task =
        m - end > kRowsPerTask ? kSubstitutionBlock / 4 : kSubstitutionBlock;
    ParallelBlocks(end - begin, columns_per_task, [&](int64_t first, int64_t stop) {
      SubtractDots(m, begin + static_cast<int>(first), begin + static_cast<int>(stop), end, panel,
                   y);
    });
    BackwardWithinBlock(m, begin, end, panel, y);
  }
}

}  // namespace lacuna
