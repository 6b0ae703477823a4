#include "registration/basis_table.h"

#include <algorithm>
#include <numbers>

#include "core/parallel.h"

namespace lacuna {
namespace {

constexpr int kBlocksPerTask = 32;

Triple AsTriple(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::vector<Triple> AsTriples(const Eigen::Matrix3Xd& columns) {
  std::vector<Triple> triples(columns.cols());
  for (size_t k = 0; k < triples.size(); ++k) triples[k] = AsTriple(columns.col(k));
  return triples;
}

}  // namespace

BasisTable::BasisTable(const GaussianBasis& basis, const BlockTree& points,
                       const GaussianKernels& kernels)
    : basis_(basis),
      kernels_(kernels),
      size_(points.Size()),
      rank_(basis.Rank()),
      holds_functions_(basis.IsFine()),
      values_(static_cast<size_t>(points.QueryBlockCount()) * basis.Rank()) {
  if (holds_functions_) {
    FillWithFunctions(points);
  } else {
    FillWithKernels(points);
  }
}

void BasisTable::FillWithKernels(const BlockTree& points) {
  std::vector<GaussianTerm> terms;
  for (const KernelScale& scale : basis_.Kernel()) {
    terms.push_back({static_cast<float>(0.5 / (scale.width * scale.width * std::numbers::ln2)),
                     static_cast<float>(scale.amplitude)});
  }
  const std::vector<Triple> pivots = AsTriples(basis_.Pivots());
  ParallelFor(points.QueryBlockCount(), kBlocksPerTask, [&](int64_t block) {
    kernels_.kernel_values(points.Queries(static_cast<int>(block)), pivots.data(), rank_,
                           {terms.data(), static_cast<int>(terms.size())},
                           values_.data() + block * rank_);
  });
}

void BasisTable::FillWithFunctions(const BlockTree& points) {
  Eigen::Matrix3Xd places(3, size_);
  for (int i = 0; i < size_; ++i) {
    const QueryBlock& block = points.Queries(i / kQueryBlock);
    const int lane = i % kQueryBlock;
    places.col(i) << block.x[lane], block.y[lane], block.z[lane];
  }
  const Eigen::MatrixXd functions = basis_.Values(places);
  for (int i = 0; i < size_; ++i) {
    LaneRow* rows = values_.data() + static_cast<int64_t>(i / kQueryBlock) * rank_;
    for (int k = 0; k < rank_; ++k) {
      rows[k].lane[i % kQueryBlock] = static_cast<float>(functions(k, i));
    }
  }
}

Eigen::Matrix3Xf BasisTable::Expand(const Eigen::Matrix3Xd& coefficients) const {
  const std::vector<Triple> weights =
      AsTriples(holds_functions_ ? coefficients : basis_.KernelWeights(coefficients));
  Eigen::Matrix3Xf displacements(3, size_);
  const int64_t blocks = (size_ + kQueryBlock - 1) / kQueryBlock;
  ParallelFor(blocks, kBlocksPerTask, [&](int64_t block) {
    TripleBlock out;
    kernels_.expand(Values(block), weights.data(), rank_, &out);
    const int64_t first = block * kQueryBlock;
    for (int i = 0; i < kQueryBlock && first + i < size_; ++i) {
      displacements.col(first + i) << out.x[i], out.y[i], out.z[i];
    }
  });
  return displacements;
}

Eigen::Matrix3Xd BasisTable::Project(const Eigen::Matrix3Xf& forces) const {
  const int64_t blocks = (size_ + kQueryBlock - 1) / kQueryBlock;
  const int64_t tasks = (blocks + kBlocksPerTask - 1) / kBlocksPerTask;
  std::vector<Eigen::Matrix3Xd> partial(tasks);
  ParallelBlocks(blocks, kBlocksPerTask, [&](int64_t begin, int64_t end) {
    std::vector<TripleBlock> sums(rank_, TripleBlock{});
    for (int64_t block = begin; block < end; ++block) {
      TripleBlock force = {};
      const int64_t first = block * kQueryBlock;
      for (int i = 0; i < kQueryBlock && first + i < size_; ++i) {
        force.x[i] = forces(0, first + i);
        force.y[i] = forces(1, first + i);
        force.z[i] = forces(2, first + i);
      }
      kernels_.project(Values(block), force, rank_, sums.data());
    }
    Eigen::Matrix3Xd& total = partial[begin / kBlocksPerTask];
    total.setZero(3, rank_);
    for (int k = 0; k < rank_; ++k) {
      for (int i = 0; i < kQueryBlock; ++i) {
        total.col(k) += Eigen::Vector3d(sums[k].x[i], sums[k].y[i], sums[k].z[i]);
      }
    }
  });
  Eigen::Matrix3Xd projection = Eigen::Matrix3Xd::Zero(3, rank_);
  for (const Eigen::Matrix3Xd& part : partial) projection += part;
  return holds_functions_ ? projection : basis_.FromKernelSpace(projection);
}

}  // namespace lacuna
