// The two formulations of a step's force fit, by the number of nodes and of coefficients: what
// fit/step_force_fitter.h chooses by. README.md of this folder tells how to read the figures.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <ctime>

#include "core/blas_kernels.h"
#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "fit/coefficient_fit.h"
#include "fit/position_fit.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A clamped bar, 100 × 30 × 30 mm, of `cells` elements' cells across.
Model ClampedBar(int cells) {
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0.03, 0.03),
                       {3 * cells, cells, cells}, 1),
               1000));
  std::vector<int> clamped;
  for (int i = 0; i < body->NodeCount(); ++i)
    if (body->mesh.nodes(0, i) < 1e-9) clamped.push_back(i);
  const Eigen::VectorXi held =
      Eigen::Map<Eigen::VectorXi>(clamped.data(), static_cast<Eigen::Index>(clamped.size()));
  return {body,
          {MakeEffect("corotational", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})},
          {Grip{held, {}}}};
}

// Every boundary node observed where it would be in a bar bent by 15 mm.
Observations BentBar(const Model& model) {
  const BoundarySurface& boundary = model.body->boundary;
  Eigen::Matrix3Xd target = boundary.surface.vertices;
  for (auto point : target.colwise()) point.z() -= 0.2 * point.x() * point.x();
  const Eigen::VectorXd sigma = Eigen::VectorXd::Constant(target.cols(), 3e-4);
  return ObserveVertices(boundary, model.body->mesh.nodes, target, sigma, sigma);
}

struct Cost {
  double seconds = 0;
  int factorisations = 0;
  bool converged = false;
};

template <typename Fit>
Cost Measure(const Fit& fit) {
  const double start = ProcessorSeconds();
  const ForceFit result = fit();
  return {ProcessorSeconds() - start, result.factorisations, result.IsUsable()};
}

std::string Text(const Cost& cost) {
  return fmt::format("{:9.3f} s {:3} {:9}", cost.seconds, cost.factorisations,
                     cost.converged ? "" : "not conv.");
}

void Compare(int cells, double length) {
  const Model model = ClampedBar(cells);
  const Body& body = *model.body;
  const MotionHistory rest = RestHistory(model);
  const StepEquation equation(model, rest, TimeScheme::kQuasiStatic, 0);
  const Observations observations = BentBar(model);
  std::vector<int> loaded;
  for (const int node : body.boundary.node)
    if (body.mesh.nodes(0, node) > 1e-9) loaded.push_back(node);
  const Eigen::VectorXi where =
      Eigen::Map<Eigen::VectorXi>(loaded.data(), static_cast<Eigen::Index>(loaded.size()));
  const ForceModel smooth = SmoothForces(body, where, length, 1000);
  const Eigen::Index count = smooth.CoefficientCount();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(count);
  const Eigen::VectorXd no_force = Eigen::VectorXd::Zero(rest.position.size());

  const Cost eliminated = Measure([&] {
    return CoefficientFitter(model, equation, smooth, ControlForces(model, smooth), rest.position,
                             zero)
        .Fit(observations, {no_force, zero}, {});
  });
  const Cost sparse = Measure([&] {
    return FitPositions(model, equation, smooth, observations, {rest.position, zero, no_force},
                        {no_force, zero}, {});
  });
  const ForceModel free = FreeForces(body, where);
  const Eigen::VectorXd none(0);
  const Cost free_nodes = Measure([&] {
    return FitPositions(model, equation, free, observations, {rest.position, none, no_force},
                        {no_force, none}, {});
  });
  fmt::print("{:7} {:7} {:6}   {}   {}   {}\n", body.ElementCount(), 3 * body.NodeCount(), count,
             Text(eliminated), Text(sparse), Text(free_nodes));
}

}  // namespace
}  // namespace lacuna

int main(int, char** argv) {
  lacuna::UseFastBlasKernels(argv);
  fmt::print(
      "                          eliminated                  positions, same basis       "
      "positions, "
      "free nodes\n"
      "   tets    dofs  coeff.       CPU  factors                CPU  factors               CPU  "
      "factors\n");
  setvbuf(stdout, nullptr, _IOLBF, 0);
  for (const int cells : {2, 4, 8})
    for (const double length : {0.2, 0.08, 0.04, 0.02}) lacuna::Compare(cells, length);
}
