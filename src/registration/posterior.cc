#include "registration/posterior.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"

namespace lacuna {
namespace {

constexpr int kBlocksPerTask = 16;

// Calls visit(block, queries, candidates within reach) for each query block, in parallel.
template <typename Visit>
void ForEachBlock(const BlockTree& queries, const BlockTree& candidates, float reach,
                  const Visit& visit) {
  ParallelBlocks(queries.QueryBlockCount(), kBlocksPerTask, [&](int64_t begin, int64_t end) {
    std::vector<int> leaves;
    for (int64_t block = begin; block < end; ++block) {
      const int b = static_cast<int>(block);
      candidates.LeavesWithin(queries.QueryBox(b), reach, &leaves);
      visit(b, queries.Queries(b),
            CandidateList{candidates.Candidates(), leaves.data(), static_cast<int>(leaves.size())});
    }
  });
}

}  // namespace

Posterior ComputePosterior(const BlockTree& source, const Mixture& mixture,
                           const GaussianKernels& kernels, BlockTree* target) {
  const double variance = mixture.sigma * mixture.sigma;
  const float reach = static_cast<float>(mixture.cutoff * mixture.sigma);
  const GaussianWidth width = {static_cast<float>(0.5 / (variance * std::numbers::ln2)),
                               reach * reach};
  const double omega = mixture.outlier_weight;
  const float outlier_mass =
      static_cast<float>(std::pow(2.0 * std::numbers::pi * variance, 1.5) * omega / (1.0 - omega) *
                         source.Size() / mixture.outlier_volume);

  Posterior posterior;
  posterior.inlier.resize(target->Size());
  ForEachBlock(*target, source, reach,
               [&](int block, const QueryBlock& queries, const CandidateList& list) {
                 MassBlock sums;
                 kernels.mass_sums(queries, list, width, &sums);
                 const int first = block * kQueryBlock;
                 const int count = std::min(kQueryBlock, target->Size() - first);
                 for (int i = 0; i < count; ++i) {
                   const float mass = sums.mass[i] + outlier_mass;
                   target->SetWeight(first + i, mass > 0.f ? 1.f / mass : 0.f);
                   posterior.inlier[first + i] = mass > 0.f ? sums.mass[i] / mass : 0.f;
                 }
               });

  posterior.weight.resize(source.Size());
  posterior.shift.resize(3, source.Size());
  std::vector<double> block_spread(source.QueryBlockCount());
  std::vector<double> block_weight(source.QueryBlockCount());
  ForEachBlock(source, *target, reach,
               [&](int block, const QueryBlock& queries, const CandidateList& list) {
                 PosteriorBlock sums;
                 kernels.posterior_sums(queries, list, width, &sums);
                 const int first = block * kQueryBlock;
                 const int count = std::min(kQueryBlock, source.Size() - first);
                 for (int i = 0; i < count; ++i) {
                   const float weight = sums.weight[i];
                   const float inverse = weight > 0.f ? 1.f / weight : 0.f;
                   posterior.weight[first + i] = weight;
                   posterior.shift.col(first + i) << sums.shift_x[i] * inverse,
                       sums.shift_y[i] * inverse, sums.shift_z[i] * inverse;
                   block_weight[block] += weight;
                   block_spread[block] += sums.spread[i];
                 }
               });
  for (int block = 0; block < source.QueryBlockCount(); ++block) {
    posterior.total_weight += block_weight[block];
    posterior.total_spread += block_spread[block];
  }
  return posterior;
}

}  // namespace lacuna
