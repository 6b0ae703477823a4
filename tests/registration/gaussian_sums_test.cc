#include "registration/gaussian_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace lacuna {
namespace {

constexpr int kLeaves = 5;
constexpr int kRank = 7;

struct Inputs {
  QueryBlock queries;
  std::vector<Candidate> candidates = std::vector<Candidate>(kLeaf * kLeaves);
  std::vector<int> leaves = {0, 2, 4};
  double sigma = 0.3;
  double cutoff = 0.8;

  CandidateList List() const {
    return {candidates.data(), leaves.data(), static_cast<int>(leaves.size())};
  }
  GaussianWidth Width() const {
    return {static_cast<float>(0.5 / (sigma * sigma * std::numbers::ln2)),
            static_cast<float>(cutoff * cutoff)};
  }
  double Gaussian(int query, const Candidate& p, double d[3]) const {
    d[0] = double{p.x} - queries.x[query];
    d[1] = double{p.y} - queries.y[query];
    d[2] = double{p.z} - queries.z[query];
    const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    return squared <= cutoff * cutoff ? std::exp(-0.5 * squared / (sigma * sigma)) : 0.0;
  }
};

Inputs RandomInputs() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  Inputs inputs;
  for (int i = 0; i < kQueryBlock; ++i) {
    inputs.queries.x[i] = uniform(random);
    inputs.queries.y[i] = uniform(random);
    inputs.queries.z[i] = uniform(random);
  }
  for (Candidate& p : inputs.candidates) {
    p = {uniform(random), uniform(random), uniform(random), uniform(random) + 1.f};
  }
  inputs.candidates[3] = Candidate{};  // padding
  return inputs;
}

class GaussianSumsTest : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (!IsSupported(GetParam())) GTEST_SKIP() << "skipped, not an instruction of this processor";
  }
};

// Sums of about 20 terms of size 1 in single precision, 2^t with an error of 3e-6: 2e-5 is enough.
constexpr double kTolerance = 2e-5;

TEST_P(GaussianSumsTest, MassAndPosteriorAreTheSumsOfTheirTerms) {
  const Inputs inputs = RandomInputs();
  const GaussianKernels& kernels = KernelsFor(GetParam());
  MassBlock mass;
  PosteriorBlock posterior;
  kernels.mass_sums(inputs.queries, inputs.List(), inputs.Width(), &mass);
  kernels.posterior_sums(inputs.queries, inputs.List(), inputs.Width(), &posterior);
  for (int q = 0; q < kQueryBlock; ++q) {
    double expected[6] = {};
    for (const int leaf : inputs.leaves) {
      for (int i = 0; i < kLeaf; ++i) {
        const Candidate& p = inputs.candidates[leaf * kLeaf + i];
        double d[3];
        const double e = inputs.Gaussian(q, p, d);
        expected[0] += e;
        expected[1] += e * p.weight;
        for (int axis = 0; axis < 3; ++axis) expected[2 + axis] += e * p.weight * d[axis];
        expected[5] += e * p.weight * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      }
    }
    EXPECT_NEAR(mass.mass[q], expected[0], kTolerance);
    EXPECT_NEAR(posterior.weight[q], expected[1], kTolerance);
    EXPECT_NEAR(posterior.shift_x[q], expected[2], kTolerance);
    EXPECT_NEAR(posterior.shift_y[q], expected[3], kTolerance);
    EXPECT_NEAR(posterior.shift_z[q], expected[4], kTolerance);
    EXPECT_NEAR(posterior.spread[q], expected[5], kTolerance);
  }
}

TEST_P(GaussianSumsTest, MomentsAreTheSumsOfTheirTerms) {
  const Inputs inputs = RandomInputs();
  MomentBlock moments;
  KernelsFor(GetParam()).moment_sums(inputs.queries, inputs.List(), inputs.Width(), &moments);
  for (int q = 0; q < kQueryBlock; ++q) {
    double expected[10] = {};
    for (const int leaf : inputs.leaves) {
      for (int i = 0; i < kLeaf; ++i) {
        double d[3];
        const double e = inputs.Gaussian(q, inputs.candidates[leaf * kLeaf + i], d);
        const double terms[10] = {1.0,         d[0],        d[1],        d[2],        d[0] * d[0],
                                  d[0] * d[1], d[0] * d[2], d[1] * d[1], d[1] * d[2], d[2] * d[2]};
        for (int k = 0; k < 10; ++k) {
          if (e > 0.0) expected[k] += e * terms[k];
        }
      }
    }
    for (int k = 0; k < 10; ++k) EXPECT_NEAR(moments.moment[k][q], expected[k], kTolerance);
  }
}

TEST_P(GaussianSumsTest, ExpandAndProjectMultiplyByTheKernelValuesAndTheirTranspose) {
  const Inputs inputs = RandomInputs();
  const GaussianKernels& kernels = KernelsFor(GetParam());
  std::mt19937 random(6);
  std::uniform_real_distribution<float> uniform(-1.f, 1.f);
  std::vector<Triple> pivots(kRank), coefficients(kRank);
  for (int k = 0; k < kRank; ++k) {
    pivots[k] = {uniform(random), uniform(random), uniform(random)};
    coefficients[k] = {uniform(random), uniform(random), uniform(random)};
  }
  const GaussianTerm terms[2] = {{1.2f, 1.f}, {9.f, 0.3f}};
  std::vector<LaneRow> values(kRank);
  kernels.kernel_values(inputs.queries, pivots.data(), kRank, {terms, 2}, values.data());
  TripleBlock expanded;
  kernels.expand(values.data(), coefficients.data(), kRank, &expanded);
  std::vector<TripleBlock> projection(kRank, TripleBlock{});
  kernels.project(values.data(), expanded, kRank, projection.data());

  std::vector<double> projected_x(kRank, 0.0);
  for (int q = 0; q < kQueryBlock; ++q) {
    double x = 0.0;
    std::vector<double> value(kRank);
    for (int k = 0; k < kRank; ++k) {
      const double dx = double{pivots[k].x} - inputs.queries.x[q];
      const double dy = double{pivots[k].y} - inputs.queries.y[q];
      const double dz = double{pivots[k].z} - inputs.queries.z[q];
      const double squared = dx * dx + dy * dy + dz * dz;
      value[k] = std::exp2(-1.2 * squared) + 0.3 * std::exp2(-9.0 * squared);
      // 2^t in single precision with a rounded t.
      EXPECT_NEAR(values[k].lane[q], value[k], 1e-6);
      x += coefficients[k].x * value[k];
    }
    EXPECT_NEAR(expanded.x[q], x, 1e-5);
    for (int k = 0; k < kRank; ++k) projected_x[k] += x * value[k];
  }
  for (int k = 0; k < kRank; ++k) {
    double sum = 0.0;
    for (int q = 0; q < kQueryBlock; ++q) sum += projection[k].x[q];
    EXPECT_NEAR(sum, projected_x[k], 1e-4);
  }
}

std::string NameOf(const testing::TestParamInfo<InstructionSet>& info) {
  switch (info.param) {
    case InstructionSet::kAvx512:
      return "Avx512";
    case InstructionSet::kAvx2:
      return "Avx2";
    default:
      return "Baseline";
  }
}

INSTANTIATE_TEST_SUITE_P(EverySet, GaussianSumsTest,
                         testing::Values(InstructionSet::kBaseline, InstructionSet::kAvx2,
                                         InstructionSet::kAvx512),
                         NameOf);

}  // namespace
}  // namespace lacuna
