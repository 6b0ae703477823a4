#include "fem/dense_front.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "fem/target_clones.h"

extern "C" void spotrf_(const char* uplo, const int* n, float* a, const int* lda, int* info);

namespace lacuna {
namespace {

// Rounding errors of a pivot are at most some thousand times 6e-8.
constexpr float kCertainlyNegative = -1e-3f;
constexpr int kEliminationBlock = 192;   // columns that are eliminated between two updates
constexpr int kTile = 256;               // columns of an update per task
constexpr int kSubstitutionBlock = 128;  // columns per block of a parallel substitution
constexpr int kRowsPerTask = 1024;       // rows of a forward substitution per task
// Columns that are processed in one pass over a vector; all blocks above are multiples of it.
constexpr int kGroup = 8;

// Replaces the lower triangle of a diagonal block by its Cholesky factor. `stride` separates its
// columns.
Pivots FactoriseDiagonal(int width, int stride, float* block) {
  int info = 0;
  spotrf_("L", &width, block, &stride, &info);
  // LAPACK leaves the pivot at which it stopped in its place.
  for (int j = 0; j < (info > 0 ? info : width); ++j) {
    const float pivot = block[j + static_cast<int64_t>(j) * stride];
    if (pivot < kCertainlyNegative) return Pivots::kNegative;
    if (!(pivot > 0) || !std::isfinite(pivot)) return Pivots::kInDoubt;
  }
  return info == 0 ? Pivots::kPositive : Pivots::kInDoubt;
}

// update ← update − rows · rowsᵀ in the lower triangle, where `rows` is n × k.
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

// y ← y − Σ_c columns(:, c) · factor[c] over a group of up to kGroup columns. In a smaller group,
// the last column takes the place of the missing ones with a factor of 0.
LACUNA_FOR_EACH_INSTRUCTION_SET
void SubtractColumns(int rows, int width, const float* columns, int stride, const float* factor,
                     float* y) {
  const float* c[kGroup];
  float f[kGroup] = {};
  for (int k = 0; k < kGroup; ++k)
    c[k] = columns + static_cast<int64_t>(std::min(k, width - 1)) * stride;
  for (int k = 0; k < width; ++k) f[k] = factor[k];
#pragma omp simd
  for (int i = 0; i < rows; ++i) {
    y[i] -= ((c[0][i] * f[0] + c[1][i] * f[1]) + (c[2][i] * f[2] + c[3][i] * f[3])) +
            ((c[4][i] * f[4] + c[5][i] * f[5]) + (c[6][i] * f[6] + c[7][i] * f[7]));
  }
}

// sum[c] = columns(:, c) · y for a group of columns, filled up in the same way.
LACUNA_FOR_EACH_INSTRUCTION_SET
void DotColumns(int rows, int width, const float* columns, int stride, const float* y, float* sum) {
  const float* c[kGroup];
  for (int k = 0; k < kGroup; ++k)
    c[k] = columns + static_cast<int64_t>(std::min(k, width - 1)) * stride;
  float s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0, s5 = 0, s6 = 0, s7 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4, s5, s6, s7)
  for (int i = 0; i < rows; ++i) {
    s0 += c[0][i] * y[i];
    s1 += c[1][i] * y[i];
    s2 += c[2][i] * y[i];
    s3 += c[3][i] * y[i];
    s4 += c[4][i] * y[i];
    s5 += c[5][i] * y[i];
    s6 += c[6][i] * y[i];
    s7 += c[7][i] * y[i];
  }
  sum[0] = s0, sum[1] = s1, sum[2] = s2, sum[3] = s3;
  sum[4] = s4, sum[5] = s5, sum[6] = s6, sum[7] = s7;
}

// Replaces the lower triangle of a group's rows by its inverse, and the rest by 0.
void InvertGroup(int width, float* group, int stride) {
  const auto at = [&](int i, int j) -> float& {
    return group[i + static_cast<int64_t>(j) * stride];
  };
  for (int j = 0; j < width; ++j) {
    at(j, j) = 1 / at(j, j);
    for (int i = 0; i < j; ++i) at(i, j) = 0;
    for (int i = j + 1; i < width; ++i) {
      // The inverse is complete above row i of column j; row i still holds the triangle.
      float sum = 0;
      for (int k = j; k < i; ++k) sum += at(i, k) * at(k, j);
      at(i, j) = -sum / at(i, i);
    }
  }
}

// y ← G y and y ← Gᵀ y, where G is the inverse stored in a group.
void MultiplyByGroup(int width, const float* group, int stride, float* y) {
  float product[kGroup] = {};
  for (int j = 0; j < width; ++j) {
    const float* column = group + static_cast<int64_t>(j) * stride;
    for (int i = j; i < width; ++i) product[i] += column[i] * y[j];
  }
  std::copy_n(product, width, y);
}

void MultiplyByTransposedGroup(int width, const float* group, int stride, float* y) {
  for (int j = 0; j < width; ++j) {
    const float* column = group + static_cast<int64_t>(j) * stride;
    float sum = 0;
    for (int i = j; i < width; ++i) sum += column[i] * y[i];
    y[j] = sum;
  }
}

// Substitutes the columns [begin, end) and updates y up to row `end`.
void ForwardWithinBlock(int m, int begin, int end, const float* panel, float* y) {
  for (int j = begin; j < end; j += kGroup) {
    const int width = std::min(kGroup, end - j), below = j + width;
    const float* group = panel + j + static_cast<int64_t>(j) * m;
    MultiplyByGroup(width, group, m, y + j);
    SubtractColumns(end - below, width, group + width, m, y + j, y + below);
  }
}

void BackwardWithinBlock(int m, int begin, int end, const float* panel, float* y) {
  for (int j = begin + (end - begin - 1) / kGroup * kGroup; j >= begin; j -= kGroup) {
    const int width = std::min(kGroup, end - j), below = j + width;
    const float* group = panel + j + static_cast<int64_t>(j) * m;
    float sum[kGroup];
    DotColumns(end - below, width, group + width, m, y + below, sum);
    for (int c = 0; c < width; ++c) y[j + c] -= sum[c];
    MultiplyByTransposedGroup(width, group, m, y + j);
  }
}

// Columns that are substituted between two updates; all columns of a front for a single thread.
int ColumnsPerBlock(int m, int p) { return m > kRowsPerTask ? kSubstitutionBlock : p; }

}  // namespace

Pivots EliminateColumns(int m, int p, float* panel, float* update) {
  for (int begin = 0; begin < p; begin += kEliminationBlock) {
    const int end = std::min(p, begin + kEliminationBlock), width = end - begin;
    float* diagonal = panel + begin + static_cast<int64_t>(begin) * m;
    const Pivots pivots = FactoriseDiagonal(width, m, diagonal);
    if (pivots != Pivots::kPositive) return pivots;
    if (end == m) break;
    ParallelBlocks(m - end, kRowsPerTask, [&](int64_t first, int64_t last) {
      cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit,
                  static_cast<int>(last - first), width, 1, diagonal, m, diagonal + width + first,
                  m);
    });
    // Update the remaining columns of the panel over all of their rows.
    ParallelBlocks(p - end, kTile, [&](int64_t first, int64_t last) {
      const float* rows = diagonal + width + first;
      cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, m - end - static_cast<int>(first),
                  static_cast<int>(last - first), width, -1, rows, m, rows, m, 1,
                  panel + end + first + (end + first) * static_cast<int64_t>(m), m);
    });
  }
  if (m > p) SubtractOuterProduct(m - p, p, panel + p, m, update, m - p);
  for (int j = 0; j < p; j += kGroup) {
    InvertGroup(std::min(kGroup, p - j), panel + j + static_cast<int64_t>(j) * m, m);
  }
  return Pivots::kPositive;
}

void ForwardSubstitute(int m, int p, const float* panel, float* y) {
  const int block = ColumnsPerBlock(m, p);
  for (int begin = 0; begin < p; begin += block) {
    const int end = std::min(p, begin + block);
    ForwardWithinBlock(m, begin, end, panel, y);
    ParallelBlocks(m - end, kRowsPerTask, [&](int64_t first, int64_t last) {
      const int rows = static_cast<int>(last - first), from = end + static_cast<int>(first);
      for (int j = begin; j < end; j += kGroup) {
        SubtractColumns(rows, std::min(kGroup, end - j), panel + from + static_cast<int64_t>(j) * m,
                        m, y + j, y + from);
      }
    });
  }
}

void BackwardSubstitute(int m, int p, const float* panel, float* y) {
  const int block = ColumnsPerBlock(m, p);
  for (int begin = (p - 1) / block * block; begin >= 0; begin -= block) {
    const int end = std::min(p, begin + block);
    const int columns_per_task = m - end > kRowsPerTask ? block / 4 : block;
    ParallelBlocks(end - begin, columns_per_task, [&](int64_t first, int64_t last) {
      float sum[kGroup];
      for (int64_t j = begin + first; j < begin + last; j += kGroup) {
        const int width = static_cast<int>(std::min<int64_t>(kGroup, begin + last - j));
        DotColumns(m - end, width, panel + end + j * m, m, y + end, sum);
        for (int c = 0; c < width; ++c) y[j + c] -= sum[c];
      }
    });
    BackwardWithinBlock(m, begin, end, panel, y);
  }
}

}  // namespace lacuna
