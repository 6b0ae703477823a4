// One implicit step of a swinging beam against the numeric sparse Cholesky factorisation of its
// matrix, which a code that factorises in every step cannot do without. See README.md.
//
// A mesh is a text file (nodes and tets on line 1, then the nodes, then the tets, from 0) or the
// stem of a pair of TetGen files, e.g. beam.1 for beam.1.node and beam.1.ele.
#include <cblas.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/blas_kernels.h"
#include "core/error.h"
#include "core/parallel.h"
#include "effects/catalogue.h"
#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/linear_solver.h"
#include "fem/node_rotations.h"
#include "fem/step_equation.h"

namespace lacuna {
namespace {

constexpr double kTimeStep = 0.01;     // s
constexpr int kStepsPerReversal = 12;  // of the strong field's direction
constexpr int kComparedSteps = 7;      // with the direct solution, at reversals and between them
constexpr int kReferenceRuns = 3;      // of CHOLMOD, before and after the motion

struct Time {
  double wall = 0, cpu = 0;  // s
  Time& operator+=(const Time& other) {
    wall += other.wall;
    cpu += other.cpu;
    return *this;
  }
};

Time Now() {
  timespec cpu;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(wall).count(),
          static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec)};
}

template <typename Work>
Time TimeOf(const Work& work) {
  const Time begin = Now();
  work();
  const Time end = Now();
  return {end.wall - begin.wall, end.cpu - begin.cpu};
}

double PeakMemory() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // MB
}

// Numbers of a file, without comments (# to the end of the line).
std::vector<double> ReadNumbers(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError({path}, "cannot be read");
  std::vector<double> numbers;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (double number; words >> number;) numbers.push_back(number);
  }
  return numbers;
}

TetMesh ReadMesh(const std::string& path) {
  TetMesh mesh;
  const bool tetgen = std::ifstream(path + ".node").good();
  std::vector<double> nodes, tets;
  if (tetgen) {
    nodes = ReadNumbers(path + ".node");  // count 3 attributes markers, then number x y z
    tets = ReadNumbers(path + ".ele");    // count 4 attributes, then number a b c d
    const int node_width = 4 + static_cast<int>(nodes.at(2) + nodes.at(3));
    const int tet_width = 5 + static_cast<int>(tets.at(2));
    mesh.nodes.resize(3, static_cast<int>(nodes.at(0)));
    mesh.tets.resize(4, static_cast<int>(tets.at(0)));
    const int first = static_cast<int>(nodes.at(4));
    for (Eigen::Index i = 0; i < mesh.nodes.cols(); ++i) {
      for (int k = 0; k < 3; ++k) mesh.nodes(k, i) = nodes.at(4 + i * node_width + 1 + k);
    }
    for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e) {
      for (int k = 0; k < 4; ++k) {
        mesh.tets(k, e) = static_cast<int>(tets.at(3 + e * tet_width + 1 + k)) - first;
      }
    }
  } else {
    nodes = ReadNumbers(path);
    mesh.nodes.resize(3, static_cast<int>(nodes.at(0)));
    mesh.tets.resize(4, static_cast<int>(nodes.at(1)));
    size_t at = 2;
    for (double& x : mesh.nodes.reshaped()) x = nodes.at(at++);
    for (int& node : mesh.tets.reshaped()) node = static_cast<int>(nodes.at(at++));
  }
  const Eigen::VectorXd volumes = TetVolumes(mesh);
  for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e) {
    if (volumes[e] < 0) std::swap(mesh.tets(0, e), mesh.tets(1, e));
  }
  return mesh;
}

struct Beam {
  Model model;
  std::vector<char> fixed;
  int root = 0, tip = 0;  // nodes near x = 0.15 m and 0.2 m on one edge, to see how far it turns
};

Beam ClampedBeam(const TetMesh& mesh) {
  Beam beam;
  beam.model.body = std::make_shared<Body>(MakeBody(mesh, 1000));
  beam.model.effects = {
      MakeEffect("corotational", {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}})};
  const int nodes = beam.model.body->NodeCount();
  std::vector<int> clamped;
  for (int i = 0; i < nodes; ++i) {
    beam.fixed.push_back(mesh.nodes(0, i) < 1e-9);
    if (beam.fixed.back()) clamped.push_back(i);
  }
  beam.model.grips.push_back(
      {Eigen::Map<Eigen::VectorXi>(clamped.data(), static_cast<Eigen::Index>(clamped.size())), {}});
  (mesh.nodes.colwise() - Eigen::Vector3d(0.15, 0, 0)).colwise().norm().minCoeff(&beam.root);
  (mesh.nodes.colwise() - Eigen::Vector3d(0.20, 0, 0)).colwise().norm().minCoeff(&beam.tip);
  return beam;
}

struct Motion {
  const char* name;
  double gravity;  // m/s²
  bool reverses;
};
constexpr Motion kMotions[] = {{"gravity", 9.81, false}, {"swing", 60, true}};

// One Newton iteration of one step, from the end of the last one.
struct LinearisedStep {
  StepEquation equation;
  Eigen::VectorXd force;
  LinearisedStep(const Beam& beam, const MotionHistory& history, double gravity)
      : equation(beam.model, history, TimeScheme::kImplicitEuler, kTimeStep) {
    equation.Residual(history.position, &force);
    const Eigen::VectorXd& mass = beam.model.body->node_mass;
    for (Eigen::Index i = 0; i < mass.size(); ++i) force[3 * i + 2] += mass[i] * gravity;
    force = -force;
  }
};

struct Sample {
  MotionHistory history;
  double gravity = 0;
  bool convexified = false;
  Eigen::VectorXd solution;
};

struct Result {
  Time assembly, solve;  // of all steps
  int iterations = 0, factorisations = 0, convexified = 0;
  double largest_turn = 0;  // degrees
  double memory = 0;        // MB
  std::vector<Sample> samples;
};

Result Simulate(const Beam& beam, const Motion& motion, int steps, double tolerance) {
  const Body& body = *beam.model.body;
  Result result;
  LinearSolver solver(body.pattern, HeldComponents(HeldAxes(beam.model)),
                      {.relative_tolerance = tolerance});
  BlockMatrix tangent(body.pattern);
  MotionHistory history = RestHistory(beam.model);
  for (int step = 0; step < steps; ++step) {
    const bool upwards = motion.reverses && step / kStepsPerReversal % 2 == 1;
    const double gravity = upwards ? -motion.gravity : motion.gravity;
    Eigen::VectorXd solution;
    std::optional<LinearisedStep> linearised;
    bool convexify = false;
    result.assembly += TimeOf([&] {
      linearised.emplace(beam, history, gravity);
      linearised->equation.Tangent(history.position, convexify, &tangent);
    });
    LinearSolveSummary solved;
    const auto solve = [&] {
      const std::vector<Eigen::Matrix3d> rotations = NodeRotations(body, history.position);
      solved = solver.Solve(tangent, linearised->force, &solution, &rotations);
    };
    result.solve += TimeOf(solve);
    if (solved.status == LinearSolveSummary::Status::kNotPositiveDefinite) {
      convexify = true;
      ++result.convexified;
      result.assembly +=
          TimeOf([&] { linearised->equation.Tangent(history.position, convexify, &tangent); });
      result.solve += TimeOf(solve);
    }
    if (!solved.IsUsable()) throw std::runtime_error(solved.message);
    result.iterations += solved.iterations;
    if (step % std::max(1, steps / kComparedSteps) == 0) {
      result.samples.push_back({history, gravity, convexify, solution});
    }
    history = linearised->equation.Advance(history.position + solution);
    const Eigen::Vector3d edge =
        history.position.segment<3>(3 * beam.tip) - history.position.segment<3>(3 * beam.root);
    result.largest_turn = std::max(result.largest_turn,
                                   std::abs(std::atan2(edge[2], edge[0])) * 180 / std::numbers::pi);
  }
  result.factorisations = solver.factorisations();
  result.memory = PeakMemory();
  return result;
}

struct Reference {
  Time factorisation;             // mean
  double largest_difference = 0;  // of a step's displacements to the direct ones, relative
};

Reference Compare(const Beam& beam, const Result& result, int threads) {
  const Body& body = *beam.model.body;
  const EliminationOrder order = NestedDissection(*body.pattern, beam.fixed);
  CholmodFactor factor(*body.pattern, order);
  LinearSolver direct(
      body.pattern, HeldComponents(HeldAxes(beam.model)),
      {.method = LinearSolverOptions::Method::kDirect, .relative_tolerance = 1e-13});
  BlockMatrix tangent(body.pattern);
  Reference reference;
  int runs = 0;
  for (size_t k = 0; k < result.samples.size(); ++k) {
    const Sample& sample = result.samples[k];
    const LinearisedStep linearised(beam, sample.history, sample.gravity);
    linearised.equation.Tangent(sample.history.position, sample.convexified, &tangent);
    if (k == 0) factor.Factorise(tangent);  // takes its memory
    if (k == 0 || k + 1 == result.samples.size()) {
      openblas_set_num_threads(threads);
      for (int run = 0; run < kReferenceRuns; ++run, ++runs) {
        reference.factorisation += TimeOf([&] { factor.Factorise(tangent); });
      }
      openblas_set_num_threads(1);
    }
    Eigen::VectorXd exact;
    direct.DropFactor();
    const LinearSolveSummary solved = direct.Solve(tangent, linearised.force, &exact);
    if (solved.relative_residual > 1e-11) throw std::runtime_error("no direct solution to compare");
    reference.largest_difference =
        std::max(reference.largest_difference, (sample.solution - exact).lpNorm<Eigen::Infinity>() /
                                                   exact.lpNorm<Eigen::Infinity>());
  }
  reference.factorisation.wall /= runs;
  reference.factorisation.cpu /= runs;
  return reference;
}

void PrintHeader() {
  fmt::print(
      "| tets | dofs | motion (turn) | threads | assembly ms | solve ms | step ms | Cholesky ms | "
      "ratio | ratio of CPU | CG/step | factors/steps | difference | MB |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void RunCase(const std::string& path, const Motion& motion, int threads, int steps,
             double tolerance) {
  SetThreadCount(threads);
  const Beam beam = ClampedBeam(ReadMesh(path));
  const Result result = Simulate(beam, motion, steps, tolerance);
  const Reference reference = Compare(beam, result, threads);
  Time step = result.assembly;
  step += result.solve;
  step.wall /= steps;
  step.cpu /= steps;
  const auto free_nodes = std::count(beam.fixed.begin(), beam.fixed.end(), 0);
  fmt::print(
      "| {} | {} | {} ({:.0f}°) | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | "
      "{:.1f} "
      "| {}/{} | {:.0e} | {:.0f} |\n",
      beam.model.body->ElementCount(), 3 * free_nodes, motion.name, result.largest_turn, threads,
      1e3 * result.assembly.wall / steps, 1e3 * result.solve.wall / steps, 1e3 * step.wall,
      1e3 * reference.factorisation.wall, step.wall / reference.factorisation.wall,
      step.cpu / reference.factorisation.cpu, static_cast<double>(result.iterations) / steps,
      result.factorisations, steps, reference.largest_difference, result.memory);
  std::fflush(stdout);
}

// Each case in a process of its own, so that its peak memory is its own.
bool RunInChild(const std::string& path, const Motion& motion, int threads, int steps,
                double tolerance) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    try {
      RunCase(path, motion, threads, steps, tolerance);
    } catch (const std::exception& error) {
      std::cerr << error.what() << "\n";
      _exit(1);
    }
    _exit(0);
  }
  int status = 1;
  waitpid(child, &status, 0);
  return status == 0;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  lacuna::UseFastBlasKernels(argv);
  int steps = 60;
  double tolerance = 1e-8;
  std::vector<int> thread_counts = {1, 2};
  std::vector<std::string> meshes;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--steps" && k + 1 < argc) {
      steps = std::max(1, std::atoi(argv[++k]));
    } else if (word == "--threads" && k + 1 < argc) {
      thread_counts = {std::max(1, std::atoi(argv[++k]))};
    } else if (word == "--tolerance" && k + 1 < argc) {
      tolerance = std::atof(argv[++k]);
    } else {
      meshes.push_back(word);
    }
  }
  if (meshes.empty()) {
    std::cerr << "usage: fem_benchmark [--steps 60] [--threads 1|2] [--tolerance 1e-8] MESH...\n";
    return 2;
  }
  fmt::print("BLAS kernels: {}; tolerance {:.0e}\n\n", lacuna::BlasKernelName(), tolerance);
  lacuna::PrintHeader();
  bool good = true;
  for (const std::string& mesh : meshes) {
    for (const lacuna::Motion& motion : lacuna::kMotions) {
      for (const int threads : thread_counts) {
        good = lacuna::RunInChild(mesh, motion, threads, steps, tolerance) && good;
      }
    }
  }
  return good ? 0 : 1;
}
