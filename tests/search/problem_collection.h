// Problems with known minima for the tests and the benchmark of the searches.
//
// P01 to P10: the test problems of Powell 1994. HS...: W. Hock and K. Schittkowski, "Test Examples
// for Nonlinear Programming Codes", 1981, by their numbers, bounds included. ROSB...: Rosenbrock's
// function in boxes.
#ifndef LACUNA_TESTS_SEARCH_PROBLEM_COLLECTION_H_
#define LACUNA_TESTS_SEARCH_PROBLEM_COLLECTION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "search/search_problem.h"

namespace lacuna {

struct KnownProblem {
  std::string name;
  std::string family;   // powell, hs or rosen
  double radius = 0.5;  // of the first steps
  double minimum = 0;
  std::vector<double> other_minima;
  SearchProblem problem;
};

std::vector<KnownProblem> SmoothProblems();

// A calibration of four parameters as a remeshing objective shows it, in the unit cube: a curved
// valley, and in the first two coordinates steps of 1/100 with a random offset of up to `noise` per
// step; a share `failing` of the steps fails. `smooth` is the valley alone, whose minimum is 0.
struct SteppedProblem {
  SearchProblem problem;
  double (*smooth)(const Eigen::VectorXd& u) = nullptr;
};

SteppedProblem MakeSteppedProblem(double noise, double failing, uint64_t seed);

// A number in [0, 1) that depends on nothing but the key.
double UniformOf(uint64_t key);

// The same problem from another start: each coordinate moved by up to a fifth of the radius.
KnownProblem Jittered(const KnownProblem& known, int start);

}  // namespace lacuna

#endif  // LACUNA_TESTS_SEARCH_PROBLEM_COLLECTION_H_
