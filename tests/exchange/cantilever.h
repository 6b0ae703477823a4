// A small bar that is clamped at one end, as a model to export.
#ifndef LACUNA_TESTS_EXCHANGE_CANTILEVER_H_
#define LACUNA_TESTS_EXCHANGE_CANTILEVER_H_

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "exchange/portable_model.h"
#include "fem/prescribed_force.h"
#include "support/box_mesh.h"

namespace lacuna {

struct Cantilever {
  TetMesh mesh;
  Model model;
  PredictionOptions options;
  std::vector<double> frames;
  PortableNames names{{"clamp"}, {}};

  Cantilever(const std::string& law, const std::array<int, 3>& cells, int order)
      : mesh(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, cells, order)) {
    model.body = std::make_shared<const Body>(MakeBody(mesh, 1000));
    model.effects = {
        MakeEffect(law, {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}),
        MakeEffect("gravity",
                   {{"acceleration_x", 0}, {"acceleration_y", 0}, {"acceleration_z", -9.81}})};
    model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x.x() < 1e-9; }), {}}};
    options.time_step = 1e-3;
  }

  Eigen::VectorXi Tip() const {
    return NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x.x() > 0.08 - 1e-9; });
  }

  PortableModel Describe() const {
    PortableModel described = DescribeModel(model, mesh, options, frames, names);
    described.run = "cantilever";
    described.recording = "release";
    described.experiment = "cantilever.yaml";
    described.program_version = "0.0.0";
    return described;
  }

  // The displacements at the start and in the frames, 3n × (1 + frames), m.
  Eigen::MatrixXd Displacements() const {
    const PortableModel described = Describe();
    std::vector<double> times;
    for (const double frame : described.frames) times.push_back(described.start + frame);
    Eigen::MatrixXd moved(3 * mesh.NodeCount(), static_cast<Eigen::Index>(times.size()) + 1);
    const PredictionSummary summary = Predict(
        model, options, times, {},
        [&](int index, const PredictedState& state) { moved.col(index + 1) = state.position; });
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
    moved.col(0) = summary.held;
    return moved.colwise() - Eigen::VectorXd(mesh.nodes.reshaped());
  }
};

// With a middle that is shifted, a tip that is turned, two forces on the tip and a hold; `law` and
// `order` are those of Cantilever. The regions: clamp, turned, moved, weight, pull, hold.
inline Cantilever LoadedCantilever(const std::string& law, int order) {
  Cantilever bar(law, {2, 1, 1}, order);
  const Eigen::VectorXi tip = bar.Tip();
  const Eigen::VectorXi middle =
      NodesWhere(bar.mesh, [](const Eigen::Vector3d& x) { return std::abs(x.x() - 0.04) < 1e-9; });
  const Eigen::Matrix3Xd rest_tip = bar.mesh.nodes(Eigen::all, tip);
  const Eigen::Matrix3Xd rest_middle = bar.mesh.nodes(Eigen::all, middle);
  bar.model.grips.push_back(
      {tip, [rest_tip](double time) -> Eigen::Matrix3Xd {
         return Eigen::AngleAxisd(time, Eigen::Vector3d::UnitX()).toRotationMatrix() * rest_tip;
       }});
  bar.model.grips.push_back({middle, [rest_middle](double time) -> Eigen::Matrix3Xd {
                               return rest_middle.colwise() + Eigen::Vector3d(0, 0.01 * time, 0);
                             }});
  for (const double size : {0.01, 0.02})
    bar.model.effects.push_back(std::make_shared<PrescribedForce>(
        BoundaryShares(*bar.model.body, tip),
        [size](double time) { return Eigen::Vector3d(0, size * time, size); }));
  bar.names.grips = {"clamp", "turned", "moved"};
  bar.names.loads = {"weight", "pull"};
  bar.names.regions = {{"weight", {1, 2}}, {"pull", {1}}, {"hold", {5}}};
  bar.frames = {0.1, 0.2};
  bar.options.time_step = 0.05;
  bar.options.held_force = Eigen::VectorXd::Constant(3 * bar.mesh.NodeCount(), 0.01);
  return bar;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_CANTILEVER_H_
