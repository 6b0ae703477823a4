#include "exchange/feb_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/error.h"
#include "exchange/unique_names.h"

namespace lacuna {
namespace {

using Kind = PortableEffect::Kind;
using How = Counterpart::Kind;
constexpr int kMostBranches = 6;  // of FEBio's viscoelastic material

// The branches that are written: the first ones that are proportional to the material.
std::vector<const PortableEffect*> Branches(const PortableModel& model) {
  std::vector<const PortableEffect*> branches;
  for (const PortableEffect& effect : model.effects)
    if (effect.kind == Kind::kViscoelasticBranch && model.IsProportional(effect) &&
        branches.size() < kMostBranches)
      branches.push_back(&effect);
  return branches;
}

// `branch` is one of the effects of the model.
Counterpart BranchCounterpart(const PortableEffect& branch, const PortableModel& model) {
  if (!model.IsProportional(branch))
    return {branch.name, How::kNone, "its Poisson's ratio is not that of the material"};
  const std::vector<const PortableEffect*> branches = Branches(model);
  if (std::find(branches.begin(), branches.end(), &branch) == branches.end())
    return {
        branch.name, How::kNone,
        fmt::format("viscoelastic has at most {} branches, and others come first", kMostBranches)};
  return {branch.name, How::kConverted,
          "viscoelastic with g = m/E, over the elastic stress in place of Hooke's"};
}

Counterpart EffectCounterpart(const PortableEffect& effect, const PortableModel& model) {
  switch (effect.kind) {
    case Kind::kSaintVenantKirchhoff:
      return {effect.name, How::kExact, "isotropic elastic"};
    case Kind::kCorotational:
      return {effect.name, How::kConverted,
              "isotropic elastic: agrees to first order in the strain, at any rotation"};
    case Kind::kLinear:
      return {effect.name, How::kConverted,
              "isotropic elastic: agrees for small strains and rotations"};
    case Kind::kNeoHookean:
      return {
          effect.name, How::kConverted,
          "neo-Hookean, mu/2 (F:F-3) - mu ln J + lambda/2 (ln J)^2 in place of mu/2 (F:F-3) - mu "
          "(J-1) + (lambda+mu)/2 (J-1)^2: agrees to second order in J-1"};
    case Kind::kGravity:
      return {effect.name, How::kExact, "nodal loads, the weights of the lumped masses"};
    case Kind::kViscoelasticBranch:
      return BranchCounterpart(effect, model);
    default:
      return {effect.name, How::kNone, "no element of the format that is written describes it"};
  }
}

double RampTime(const PortableModel& model) {
  double time = 1;
  for (const PortableEffect* branch : Branches(model))
    time = std::max(time, 1e3 * branch->values[1]);
  return time;
}

class Writer {
 public:
  explicit Writer(const PortableModel& model) : model_(model), ramp_(RampTime(model)) {
    for (const NamedNodes& region : model.regions)
      regions_.push_back(node_sets_.Add(Identifier(region.name)));
  }

  std::string Text() {
    Mesh();
    // The grips are the first regions.
    for (size_t g = 0; g < model_.grips.size(); ++g) Grip(model_.grips[g], regions_[g]);
    Loads();
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
           XmlComment(model_, FebCounterparts(model_)) +
           "<febio_spec version=\"4.0\">\n<Module "
           "type=\"solid\"><units>SI</units></Module>\n" +
           Material() + mesh_ +
           "</Mesh>\n<MeshDomains><SolidDomain name=\"elements\" mat=\"lacuna\"/></MeshDomains>\n" +
           Section("MeshData", data_) + Section("Boundary", boundary_) + Section("Loads", loads_) +
           Section("LoadData", curves_) + Steps() +
           "<Output>\n<plotfile type=\"febio\"><var type=\"displacement\"/></plotfile>\n"
           "<logfile><node_data data=\"ux;uy;uz\" file=\"displacements.txt\"/></logfile>\n"
           "</Output>\n</febio_spec>\n";
  }

 private:
  static std::string Section(const std::string& name, const std::string& content) {
    return content.empty() ? "" : fmt::format("<{0}>\n{1}</{0}>\n", name, content);
  }

  std::string Material() const {
    const PortableEffect& law = model_.Elasticity();
    const std::string elastic =
        fmt::format("type=\"{}\">\n<density>{}</density><E>{}</E><v>{}</v>\n",
                    law.kind == Kind::kNeoHookean ? "neo-Hookean" : "isotropic elastic",
                    model_.density, law.values[0], law.values[1]);
    const std::string head = "<Material>\n<material id=\"1\" name=\"lacuna\" ";
    const std::vector<const PortableEffect*> branches = Branches(model_);
    if (branches.empty()) return head + elastic + "</material>\n</Material>\n";
    std::string text =
        head + fmt::format("type=\"viscoelastic\">\n<density>{}</density>\n", model_.density);
    for (size_t k = 0; k < branches.size(); ++k)
      text += fmt::format("<g{0}>{1}</g{0}><t{0}>{2}</t{0}>\n", k + 1,
                          branches[k]->values[0] / law.values[0], branches[k]->values[1]);
    return text + "<elastic " + elastic + "</elastic>\n</material>\n</Material>\n";
  }

  void Mesh() {
    const auto end = std::back_inserter(mesh_);
    mesh_ = fmt::format("<Mesh>\n<Nodes name=\"{}\">\n", kAllNodes);
    for (Eigen::Index n = 0; n < model_.mesh.NodeCount(); ++n) {
      const auto node = model_.mesh.nodes.col(n);
      fmt::format_to(end, "<node id=\"{}\">{},{},{}</node>\n", n + 1, node.x(), node.y(), node.z());
    }
    fmt::format_to(end, "</Nodes>\n<Elements type=\"{}\" name=\"elements\">\n",
                   model_.mesh.Order() == 2 ? "tet10" : "tet4");
    for (Eigen::Index e = 0; e < model_.mesh.TetCount(); ++e) {
      const Eigen::VectorXi nodes = model_.mesh.tets.col(e).array() + 1;
      fmt::format_to(end, "<elem id=\"{}\">{}</elem>\n", e + 1, fmt::join(nodes, ","));
    }
    mesh_ += "</Elements>\n";
    for (size_t k = 0; k < model_.regions.size(); ++k) {
      const NamedNodes& region = model_.regions[k];
      if (regions_[k] != region.name)
        fmt::format_to(end, "<!-- \"{}\" in the recording -->\n", XmlCommentText(region.name));
      NodeSet(regions_[k], region.nodes);
    }
  }

  void NodeSet(const std::string& name, std::vector<int> nodes) {
    for (int& node : nodes) ++node;
    mesh_ += fmt::format("<NodeSet name=\"{}\">{}</NodeSet>\n", name, fmt::join(nodes, ","));
  }

  // A table over the total time, linear between its points; returns its number.
  int Curve(const std::vector<double>& times, const std::vector<double>& values) {
    const auto end = std::back_inserter(curves_);
    fmt::format_to(end,
                   "<load_controller id=\"{}\" type=\"loadcurve\"><interpolate>LINEAR</interpolate>"
                   "<extend>CONSTANT</extend><points>\n",
                   ++curve_count_);
    for (size_t k = 0; k < times.size(); ++k)
      fmt::format_to(end, "<pt>{},{}</pt>\n", times[k], values[k]);
    curves_ += "</points></load_controller>\n";
    return curve_count_;
  }

  // Grows linearly in the first step to the first value, and follows the values in the second.
  template <typename Values>
  int MotionCurve(const Values& values) {
    std::vector<double> times{0}, table{0};
    for (size_t k = 0; k < model_.times.size(); ++k) {
      times.push_back(ramp_ + model_.times[k]);
      table.push_back(values[static_cast<Eigen::Index>(k)]);
    }
    return Curve(times, table);
  }

  void Grip(const PortableGrip& grip, const std::string& set) {
    if (grip.displacements.empty()) {
      boundary_ += fmt::format(
          "<bc name=\"{0}\" node_set=\"{0}\" type=\"zero displacement\"><x_dof>{1}</x_dof>"
          "<y_dof>{2}</y_dof><z_dof>{3}</z_dof></bc>\n",
          set, grip.axes.Has(0) ? 1 : 0, grip.axes.Has(1) ? 1 : 0, grip.axes.Has(2) ? 1 : 0);
      return;
    }
    const bool is_translation = grip.IsTranslation();
    for (size_t column = 0; column < (is_translation ? 1 : grip.part.nodes.size()); ++column) {
      const int node = grip.part.nodes[column];
      const std::string place =
          is_translation ? set : node_sets_.Add(fmt::format("{}_{}", set, node + 1));
      if (!is_translation) NodeSet(place, {node});
      for (int axis = 0; axis < 3; ++axis) {
        if (!grip.axes.Has(axis)) continue;
        boundary_ += fmt::format(
            "<bc name=\"{0}_{1}\" node_set=\"{0}\" type=\"prescribed displacement\"><dof>{1}</dof>"
            "<value lc=\"{2}\">1</value><relative>0</relative></bc>\n",
            place, "xyz"[axis], MotionCurve(grip.Series(axis, static_cast<Eigen::Index>(column))));
      }
    }
  }

  // A force `values` (n, N) along an axis at all nodes, times a load curve.
  void NodalLoad(const std::string& part, int axis, const Eigen::VectorXd& values, int curve) {
    if (values.isZero(0)) return;
    const std::string name = maps_.Add(fmt::format("{}_{}", part, "xyz"[axis]));
    data_ += fmt::format("<NodeData name=\"{}\" node_set=\"{}\" data_type=\"scalar\">\n", name,
                         kAllNodes);
    for (Eigen::Index n = 0; n < values.size(); ++n)
      data_ += fmt::format("<node lid=\"{}\">{}</node>\n", n + 1, values[n]);
    data_ += "</NodeData>\n";
    loads_ += fmt::format(
        "<nodal_load name=\"{0}\" node_set=\"{1}\" type=\"nodal_load\"><dof>{2}</dof>"
        "<scale lc=\"{3}\" type=\"map\">{0}</scale></nodal_load>\n",
        name, kAllNodes, "xyz"[axis], curve);
  }

  void Loads() {
    const Eigen::Vector3d gravity = model_.Gravity();
    for (int axis = 0; axis < 3; ++axis) {
      if (gravity[axis] != 0)
        NodalLoad("weight", axis, model_.node_mass * gravity[axis], Curve({0, ramp_}, {0, 1}));
      for (size_t l = 0; l < model_.loads.size(); ++l) {
        const PortableLoad& load = model_.loads[l];
        if (load.force.row(axis).isZero(0)) continue;
        Eigen::VectorXd shares = Eigen::VectorXd::Zero(model_.mesh.NodeCount());
        shares(load.part.nodes) = load.shares;
        NodalLoad(Identifier(load.part.name), axis, shares, MotionCurve(load.force.row(axis)));
      }
      // The hold vanishes within a millionth of the first time step of the motion.
      if (model_.held_force.size() > 0)
        NodalLoad("hold", axis, model_.held_force.row(axis),
                  Curve({0, ramp_, ramp_ + 1e-6 * model_.time_step}, {0, 1, 0}));
    }
  }

  static std::string Step(int number, const char* analysis, double duration, double step) {
    const int steps = std::max(1, static_cast<int>(std::ceil(duration / step - 1e-9)));
    return fmt::format(
        "<step id=\"{0}\" name=\"step{0}\"><Control>\n<analysis>{1}</analysis><time_steps>{2}"
        "</time_steps><step_size>{3}</step_size>\n<solver type=\"solid\"><symmetric_stiffness>"
        "symmetric</symmetric_stiffness></solver>\n<time_stepper type=\"default\"><max_retries>10"
        "</max_retries><opt_iter>15</opt_iter><dtmin>{4}</dtmin><dtmax>{3}</dtmax></time_stepper>\n"
        "</Control></step>\n",
        number, analysis, steps, duration / steps, 1e-4 * step);
  }

  std::string Steps() const {
    std::string steps = Step(1, "STATIC", ramp_, ramp_ / 10);
    if (!model_.frames.empty())
      steps +=
          Step(2, model_.is_static ? "STATIC" : "DYNAMIC", model_.Duration(), model_.time_step);
    return Section("Step", steps);
  }

  static constexpr const char* kAllNodes = "nodes";

  const PortableModel& model_;
  double ramp_;  // s
  int curve_count_ = 0;
  UniqueNames node_sets_{{kAllNodes}}, maps_;
  std::vector<std::string> regions_;  // the names of the node sets of model_.regions
  std::string mesh_, data_, boundary_, loads_, curves_;
};

}  // namespace

Counterparts FebCounterparts(const PortableModel& model) {
  Counterparts parts;
  for (const PortableEffect& effect : model.effects)
    parts.push_back(EffectCounterpart(effect, model));
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, How::kExact,
                     grip.displacements.empty()
                         ? "zero displacement"
                         : "prescribed displacement, linear between times at "
                           "most one time step apart"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kExact, "nodal loads with a load curve"});
  if (model.held_force.size() > 0)
    parts.push_back({"hold", How::kExact, "nodal loads that vanish when the motion starts"});
  if (model.HasInertia())
    parts.push_back({"inertia", How::kConverted,
                     "consistent masses in place of lumped ones; FEBio's time scheme"});
  return parts;
}

std::string FebText(const PortableModel& model) {
  if (!model.Elasticity().IsElasticity())
    throw InputError(fmt::format("{}: this elasticity law cannot be written into a .feb file",
                                 model.Elasticity().name));
  return Writer(model).Text();
}

}  // namespace lacuna
