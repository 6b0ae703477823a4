#include "search/problem_collection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lacuna {
namespace {

using Eigen::VectorXd;
using Numbers = std::vector<double>;

constexpr double kInf = std::numeric_limits<double>::infinity();

double Sq(double a) { return a * a; }

VectorXd ToVector(const Numbers& numbers) {
  return Eigen::Map<const VectorXd>(numbers.data(), static_cast<int>(numbers.size()));
}

// `f` returns the value followed by the constraints.
template <typename F>
KnownProblem Make(const char* name, const char* family, const Numbers& start, double radius,
                  double minimum, F f, Numbers lower = {}, Numbers upper = {}) {
  KnownProblem known{name, family, radius, minimum, {}, {}};
  const int n = static_cast<int>(start.size());
  if (lower.empty()) lower.assign(n, -kInf);
  if (upper.empty()) upper.assign(n, kInf);
  known.problem.lower = ToVector(lower);
  known.problem.upper = ToVector(upper);
  known.problem.start = ToVector(start).cwiseMax(known.problem.lower).cwiseMin(known.problem.upper);
  known.problem.constraint_count = static_cast<int>(f(known.problem.start).size()) - 1;
  known.problem.evaluate = [f](const VectorXd& x) {
    const Numbers numbers = f(x);
    Evaluation outcome;
    outcome.value = numbers[0];
    outcome.constraints = ToVector(numbers).tail(static_cast<int>(numbers.size()) - 1);
    return outcome;
  };
  return known;
}

using X = const VectorXd&;

double Rosenbrock(X x) {
  double sum = 0;
  for (int i = 0; i + 1 < x.size(); ++i) sum += 100 * Sq(x[i + 1] - Sq(x[i])) + Sq(1 - x[i]);
  return sum;
}

Numbers Powell9(X x) {
  return {Sq(x[0] - 10) + 5 * Sq(x[1] - 12) + std::pow(x[2], 4) + 3 * Sq(x[3] - 11) +
              10 * std::pow(x[4], 6) + 7 * Sq(x[5]) + std::pow(x[6], 4) - 4 * x[5] * x[6] -
              10 * x[5] - 8 * x[6],
          127 - 2 * Sq(x[0]) - 3 * std::pow(x[1], 4) - x[2] - 4 * Sq(x[3]) - 5 * x[4],
          282 - 7 * x[0] - 3 * x[1] - 10 * Sq(x[2]) - x[3] + x[4],
          196 - 23 * x[0] - Sq(x[1]) - 6 * Sq(x[5]) + 8 * x[6],
          -4 * Sq(x[0]) - Sq(x[1]) + 3 * x[0] * x[1] - 2 * Sq(x[2]) - 5 * x[5] + 11 * x[6]};
}

// The largest hexagon of unit diameter.
Numbers Powell10(X x) {
  return {
      -0.5 * (x[0] * x[3] - x[1] * x[2] + x[2] * x[8] - x[4] * x[8] + x[4] * x[7] - x[5] * x[6]),
      1 - Sq(x[2]) - Sq(x[3]),
      1 - Sq(x[8]),
      1 - Sq(x[4]) - Sq(x[5]),
      1 - Sq(x[0]) - Sq(x[1] - x[8]),
      1 - Sq(x[0] - x[4]) - Sq(x[1] - x[5]),
      1 - Sq(x[0] - x[6]) - Sq(x[1] - x[7]),
      1 - Sq(x[2] - x[4]) - Sq(x[3] - x[5]),
      1 - Sq(x[2] - x[6]) - Sq(x[3] - x[7]),
      1 - Sq(x[6]) - Sq(x[7] - x[8]),
      x[0] * x[3] - x[1] * x[2],
      x[2] * x[8],
      -x[4] * x[8],
      x[4] * x[7] - x[5] * x[6],
      x[8]};
}

void AddPowell(std::vector<KnownProblem>* all) {
  const auto add = [all](const char* name, int n, double minimum, auto f) {
    all->push_back(Make(name, "powell", Numbers(n, 1.0), 0.5, minimum, f));
  };
  add("P01_quad", 2, 0, [](X x) { return Numbers{10 * Sq(x[0] + 1) + Sq(x[1])}; });
  add("P02_circle", 2, -0.5, [](X x) { return Numbers{x[0] * x[1], 1 - Sq(x[0]) - Sq(x[1])}; });
  add("P03_ellips", 3, -1 / (9 * std::sqrt(2.0)), [](X x) {
    return Numbers{x[0] * x[1] * x[2], 1 - Sq(x[0]) - 2 * Sq(x[1]) - 3 * Sq(x[2])};
  });
  add("P04_wrosen", 2, 0, [](X x) { return Numbers{Sq(Sq(x[0]) - x[1]) + Sq(1 + x[0])}; });
  add("P05_irosen", 2, 0, [](X x) { return Numbers{10 * Sq(Sq(x[0]) - x[1]) + Sq(1 + x[0])}; });
  add("P06_fl9115", 2, -std::sqrt(2.0), [](X x) {
    return Numbers{-x[0] - x[1], x[1] - Sq(x[0]), 1 - Sq(x[0]) - Sq(x[1])};
  });
  add("P07_fl1442", 3, -3, [](X x) {
    return Numbers{x[2], 5 * x[0] - x[1] + x[2], x[2] - Sq(x[0]) - Sq(x[1]) - 4 * x[1],
                   x[2] - 5 * x[0] - x[1]};
  });
  add("P08_rosuz", 4, -44, [](X x) {
    return Numbers{
        Sq(x[0]) + Sq(x[1]) + 2 * Sq(x[2]) + Sq(x[3]) - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3],
        8 - x.squaredNorm() - x[0] + x[1] - x[2] + x[3],
        10 - Sq(x[0]) - 2 * Sq(x[1]) - Sq(x[2]) - 2 * Sq(x[3]) + x[0] + x[3],
        5 - 2 * Sq(x[0]) - Sq(x[1]) - Sq(x[2]) - 2 * x[0] + x[1] + x[3]};
  });
  add("P09_hs100", 7, 680.6300573744, Powell9);
  add("P10_hexagon", 9, -std::sqrt(0.75), Powell10);
  all->back().other_minima = {-0.5, -0.674981};
}

// The constraints that HS034 and HS066 share: x_2 >= exp(x_1) and x_3 >= exp(x_2).
Numbers WithExponentialConstraints(X x, double value) {
  return {value, x[1] - std::exp(x[0]), x[2] - std::exp(x[1])};
}

void AddHockSchittkowski1To37(std::vector<KnownProblem>* all) {
  const auto add = [all](const char* name, const Numbers& start, double radius, double minimum,
                         auto f, const Numbers& lower, const Numbers& upper) {
    all->push_back(Make(name, "hs", start, radius, minimum, f, lower, upper));
  };
  const auto rosenbrock = [](X x) { return Numbers{Rosenbrock(x)}; };
  add("HS001", {-2, 1}, 0.5, 0, rosenbrock, {-kInf, -1.5}, {kInf, kInf});
  add("HS002", {-2, 1}, 0.5, 0.0504261879, rosenbrock, {-kInf, 1.5}, {kInf, kInf});
  all->back().other_minima = {4.941229318};
  add("HS005", {0, 0}, 0.5, -std::sqrt(0.75) - std::acos(-1.0) / 3,
      [](X x) {
        return Numbers{std::sin(x[0] + x[1]) + Sq(x[0] - x[1]) - 1.5 * x[0] + 2.5 * x[1] + 1};
      },
      {-1.5, -3}, {4, 3});
  add("HS021", {-1, -1}, 0.5, -99.96,
      [](X x) {
        return Numbers{0.01 * Sq(x[0]) + Sq(x[1]) - 100, 10 * x[0] - x[1] - 10};
      },
      {2, -50}, {50, 50});
  add("HS024", {1, 0.5}, 0.25, -1,
      [](X x) {
        const double root = std::sqrt(3.0);
        return Numbers{(Sq(x[0] - 3) - 9) * x[1] * Sq(x[1]) / (27 * root), x[0] / root - x[1],
                       x[0] + root * x[1], 6 - x[0] - root * x[1]};
      },
      {0, 0}, {kInf, kInf});
  add("HS029", {1, 1, 1}, 0.5, -16 * std::sqrt(2.0),
      [](X x) {
        return Numbers{-x[0] * x[1] * x[2], 48 - Sq(x[0]) - 2 * Sq(x[1]) - 4 * Sq(x[2])};
      },
      {}, {});
  add("HS031", {1, 1, 1}, 0.5, 6,
      [](X x) {
        return Numbers{9 * Sq(x[0]) + Sq(x[1]) + 9 * Sq(x[2]), x[0] * x[1] - 1};
      },
      {-10, 1, -10}, {10, 10, 1});
  add("HS034", {0, 1.05, 2.9}, 0.5, -std::log(std::log(10.0)),
      [](X x) { return WithExponentialConstraints(x, -x[0]); }, {0, 0, 0}, {100, 100, 10});
  add("HS035", {0.5, 0.5, 0.5}, 0.25, 1.0 / 9,
      [](X x) {
        return Numbers{9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + 2 * Sq(x[0]) + 2 * Sq(x[1]) + Sq(x[2]) +
                           2 * x[0] * x[1] + 2 * x[0] * x[2],
                       3 - x[0] - x[1] - 2 * x[2]};
      },
      {0, 0, 0}, {kInf, kInf, kInf});
  const auto box = [](X x) { return x[0] + 2 * x[1] + 2 * x[2]; };
  add("HS036", {10, 10, 10}, 1, -3300,
      [=](X x) {
        return Numbers{-x[0] * x[1] * x[2], 72 - box(x)};
      },
      {0, 0, 0}, {20, 11, 42});
  add("HS037", {10, 10, 10}, 1, -3456,
      [=](X x) {
        return Numbers{-x[0] * x[1] * x[2], 72 - box(x), box(x)};
      },
      {0, 0, 0}, {42, 42, 42});
}

void AddHockSchittkowski38To76(std::vector<KnownProblem>* all) {
  const auto add = [all](const char* name, const Numbers& start, double radius, double minimum,
                         auto f, const Numbers& lower, const Numbers& upper) {
    all->push_back(Make(name, "hs", start, radius, minimum, f, lower, upper));
  };
  add(
      "HS038_4d", {-3, -1, -3, -1}, 0.5, 0,
      [](X x) {
        return Numbers{100 * Sq(x[1] - Sq(x[0])) + Sq(1 - x[0]) + 90 * Sq(x[3] - Sq(x[2])) +
                       Sq(1 - x[2]) + 10.1 * (Sq(x[1] - 1) + Sq(x[3] - 1)) +
                       19.8 * (x[1] - 1) * (x[3] - 1)};
      },
      Numbers(4, -10.0), Numbers(4, 10.0));
  all->back().other_minima = {7.876966};
  add(
      "HS044_4d", {0, 0, 0, 0}, 0.5, -15,
      [](X x) {
        return Numbers{x[0] - x[1] - x[2] - x[0] * x[2] + x[0] * x[3] + x[1] * x[2] - x[1] * x[3],
                       8 - x[0] - 2 * x[1],
                       12 - 4 * x[0] - x[1],
                       12 - 3 * x[0] - 4 * x[1],
                       8 - 2 * x[2] - x[3],
                       8 - x[2] - 2 * x[3],
                       5 - x[2] - x[3]};
      },
      Numbers(4, 0.0), Numbers(4, kInf));
  add(
      "HS064", {1, 1, 1}, 0.5, 6299.842428,
      [](X x) {
        return Numbers{
            5 * x[0] + 50000 / x[0] + 20 * x[1] + 72000 / x[1] + 10 * x[2] + 144000 / x[2],
            1 - 4 / x[0] - 32 / x[1] - 120 / x[2]};
      },
      Numbers(3, 1e-5), Numbers(3, kInf));
  add("HS065", {-5, 5, 0}, 0.5, 0.9535288567,
      [](X x) {
        return Numbers{Sq(x[0] - x[1]) + Sq(x[0] + x[1] - 10) / 9 + Sq(x[2] - 5),
                       48 - x.squaredNorm()};
      },
      {-4.5, -4.5, -5}, {4.5, 4.5, 5});
  add("HS066", {0, 1.05, 2.9}, 0.5, 0.5181632741,
      [](X x) { return WithExponentialConstraints(x, 0.2 * x[2] - 0.8 * x[0]); }, {0, 0, 0},
      {100, 100, 10});
  add("HS072_4d", {1, 1, 1, 1}, 0.5, 727.679355748,
      [](X x) {
        return Numbers{1 + x[0] + x[1] + x[2] + x[3],
                       0.0401 - 4 / x[0] - 2.25 / x[1] - 1 / x[2] - 0.25 / x[3],
                       0.010085 - 0.16 / x[0] - 0.36 / x[1] - 0.64 / x[2] - 0.64 / x[3]};
      },
      Numbers(4, 1e-3), {4e5, 3e5, 2e5, 1e5});
  add(
      "HS076_4d", Numbers(4, 0.5), 0.25, -4.681818181818,
      [](X x) {
        return Numbers{Sq(x[0]) + 0.5 * Sq(x[1]) + Sq(x[2]) + 0.5 * Sq(x[3]) - x[0] * x[2] +
                           x[2] * x[3] - x[0] - 3 * x[1] + x[2] - x[3],
                       5 - x[0] - 2 * x[1] - x[2] - x[3], 4 - 3 * x[0] - x[1] - 2 * x[2] + x[3],
                       x[1] + 4 * x[2] - 1.5};
      },
      Numbers(4, 0.0), Numbers(4, kInf));
}

double Valley(const VectorXd& u) {
  const double stiffness = u[2] - 0.4 + 0.3 * Sq(1 - u[1]);
  return 8 * Sq(stiffness + 0.4 * (u[3] - 0.6)) + 0.8 * Sq(u[3] - 0.6) + 0.3 * Sq(u[0] - 0.35) +
         0.6 * Sq(u[1] - 0.7);
}

}  // namespace

std::vector<KnownProblem> SmoothProblems() {
  std::vector<KnownProblem> all;
  AddPowell(&all);
  AddHockSchittkowski1To37(&all);
  AddHockSchittkowski38To76(&all);
  const auto rosenbrock = [](X x) { return Numbers{Rosenbrock(x)}; };
  all.push_back(Make("ROSB2_act", "rosen", {-1.2, 1}, 0.5, 0.04, rosenbrock, {-2, -2}, {0.8, 2}));
  all.push_back(Make("ROSB4_int", "rosen", {0, 0, 0, 0}, 0.5, 0, rosenbrock, Numbers(4, -2.0),
                     Numbers(4, 2.0)));
  all.back().other_minima = {3.70142861};
  all.push_back(Make("ROSB4_act", "rosen", Numbers(4, 0.5), 0.25, 0.116975144782, rosenbrock,
                     Numbers(4, -2.0), {2, 2, 2, 0.5}));
  return all;
}

double UniformOf(uint64_t key) {
  uint64_t z = key * 0x9e3779b97f4a7c15u + 0x632be59bd9b4e019u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

KnownProblem Jittered(const KnownProblem& known, int start) {
  KnownProblem jittered = known;
  SearchProblem& problem = jittered.problem;
  for (int i = 0; i < problem.start.size() && start > 0; ++i) {
    problem.start[i] += 0.2 * known.radius * (2 * UniformOf(1000 * start + i) - 1);
    problem.start[i] = std::clamp(problem.start[i], problem.lower[i], problem.upper[i]);
  }
  return jittered;
}

SteppedProblem MakeSteppedProblem(double noise, double failing, uint64_t seed) {
  SteppedProblem stepped;
  stepped.smooth = Valley;
  stepped.problem.lower = VectorXd::Zero(4);
  stepped.problem.upper = VectorXd::Ones(4);
  stepped.problem.start = VectorXd::Constant(4, 0.5);
  stepped.problem.evaluate = [=](const VectorXd& u) {
    const auto row = static_cast<uint64_t>(std::floor(u[0] * 100));
    const auto column = static_cast<uint64_t>(std::floor(u[1] * 100));
    const uint64_t cell = seed * 1000003 + row * 1009 + column;
    Evaluation outcome;
    if (UniformOf(2 * cell) < failing) {
      outcome.failure = "the mesher refused";
    } else {
      outcome.value = Valley(u) + noise * (2 * UniformOf(2 * cell + 1) - 1);
    }
    return outcome;
  };
  return stepped;
}

}  // namespace lacuna
