// Time of one evaluation of forces and of forces with tangent, per element and thread.
//
// `time/tet` is CPU time: other work on the machine disturbs it little.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "core/parallel.h"
#include "effects/catalogue.h"
#include "fem/body.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

const Body& Beam(int cells, int order) {
  static std::map<std::pair<int, int>, Body> bodies;
  const auto key = std::make_pair(cells, order);
  if (bodies.count(key) == 0) {
    TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.2, 0.04, 0.04}, {5 * cells, cells, cells}),
                            0.04 / cells, 0.2, 1);
    bodies.emplace(key, MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000));
  }
  return bodies.at(key);
}

// Bent by 90° along its length, so that elements are turned and strained by up to 15 %.
Eigen::VectorXd Bent(const Body& body) {
  Eigen::VectorXd position(3 * body.NodeCount());
  const double radius = 0.2 / (std::numbers::pi / 2);
  for (int i = 0; i < body.NodeCount(); ++i) {
    const Eigen::Vector3d x = body.mesh.nodes.col(i);
    const double angle = x[0] / radius;
    position.segment<3>(3 * i) << (radius - x[2]) * std::sin(angle), x[1],
        radius - (radius - x[2]) * std::cos(angle);
  }
  return position;
}

void Evaluate(benchmark::State& state, const std::string& law, int order, bool with_tangent,
              bool convexify) {
  SetThreadCount(1);
  const Body& body = Beam(static_cast<int>(state.range(0)), order);
  const auto effect = MakeEffect(law, {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}});
  const Eigen::VectorXd position = Bent(body);
  const Eigen::VectorXd velocity = Eigen::VectorXd::Zero(position.size()), memory;
  const Kinematics at{body, position, velocity, velocity, 0, 0.01, memory};
  Eigen::VectorXd force = Eigen::VectorXd::Zero(position.size());
  BlockMatrix tangent(body.pattern);
  for (auto _ : state) {
    force.setZero();
    effect->AddForce(at, &force);
    if (with_tangent) {
      tangent.SetZero();
      effect->AddTangents(at, {.position = -1}, convexify, &tangent);
    }
    benchmark::ClobberMemory();
  }
  state.counters["tets"] = body.ElementCount();
  state.counters["time/tet"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * body.ElementCount(),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void Register() {
  for (const std::string law : {"corotational", "neo_hookean", "st_venant_kirchhoff", "linear"}) {
    for (const int order : {1, 2}) {
      const std::string name = law + (order == 1 ? "/P1" : "/P2");
      const auto add = [&](const std::string& what, bool with_tangent, bool convexify) {
        auto* entry = benchmark::RegisterBenchmark(
            (name + what).c_str(),
            [=](benchmark::State& state) { Evaluate(state, law, order, with_tangent, convexify); });
        for (const int cells : {order == 1 ? 7 : 5, order == 1 ? 12 : 8}) entry->Arg(cells);
        entry->Unit(benchmark::kMillisecond);
      };
      add("/force", false, false);
      add("/force_and_tangent", true, false);
      add("/force_and_definite_tangent", true, true);
    }
  }
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  lacuna::Register();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
