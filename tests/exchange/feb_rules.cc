#include "exchange/feb_rules.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "exchange/xml_element.h"

namespace lacuna {
namespace {

using Words = std::set<std::string>;

// Manual, section 3.1: "it is recommended to list them in the same order as given above".
const std::vector<std::string> kSections = {
    "Module",      "Globals",     "Control",  "Material", "Mesh",  "MeshDomains",
    "MeshData",    "MeshAdaptor", "Initial",  "Boundary", "Loads", "Contact",
    "Constraints", "Rigid",       "Discrete", "LoadData", "Step",  "Output"};
const std::vector<std::string> kRequiredSections = {"Module", "Material", "Mesh", "MeshDomains"};

struct ElementRule {
  Words required, optional;  // attributes
  Words children;
};

// By the element's name, with its type behind a slash where the type decides what it may hold.
const std::map<std::string, ElementRule> kRules = {
    {"Module", {{"type"}, {}, {"units"}}},
    {"units", {}},
    {"Material", {{}, {}, {"material"}}},
    {"material/isotropic elastic", {{"id", "name", "type"}, {}, {"density", "E", "v"}}},
    {"material/neo-Hookean", {{"id", "name", "type"}, {}, {"density", "E", "v"}}},
    {"material/viscoelastic",
     {{"id", "name", "type"},
      {},
      {"density", "g0", "g1", "g2", "g3", "g4", "g5", "g6", "t1", "t2", "t3", "t4", "t5", "t6",
       "elastic"}}},
    {"elastic/isotropic elastic", {{"type"}, {}, {"density", "E", "v"}}},
    {"elastic/neo-Hookean", {{"type"}, {}, {"density", "E", "v"}}},
    {"Mesh", {{}, {}, {"Nodes", "Elements", "NodeSet"}}},
    {"Nodes", {{}, {"name"}, {"node"}}},
    {"Nodes/node", {{"id"}, {}, {}}},
    {"Elements", {{"type", "name"}, {}, {"elem"}}},
    {"elem", {{"id"}, {}, {}}},
    {"NodeSet", {{"name"}, {}, {}}},
    {"MeshDomains", {{}, {}, {"SolidDomain"}}},
    {"SolidDomain", {{"name", "mat"}, {"elem_type", "type"}, {}}},
    {"MeshData", {{}, {}, {"NodeData"}}},
    {"NodeData", {{"name", "node_set"}, {"data_type"}, {"node"}}},
    {"NodeData/node", {{"lid"}, {}, {}}},
    {"Boundary", {{}, {}, {"bc"}}},
    {"bc/zero displacement", {{"type", "node_set"}, {"name"}, {"x_dof", "y_dof", "z_dof"}}},
    {"bc/prescribed displacement", {{"type", "node_set"}, {"name"}, {"dof", "value", "relative"}}},
    {"value", {{}, {"lc", "type"}, {}}},
    {"Loads", {{}, {}, {"nodal_load"}}},
    {"nodal_load/nodal_load", {{"type", "node_set"}, {"name"}, {"dof", "scale"}}},
    {"scale", {{}, {"lc", "type"}, {}}},
    {"LoadData", {{}, {}, {"load_controller"}}},
    {"load_controller/loadcurve", {{"id", "type"}, {"name"}, {"interpolate", "extend", "points"}}},
    {"points", {{}, {}, {"pt"}}},
    {"Step", {{}, {}, {"step"}}},
    {"step", {{"id"}, {"name"}, {"Control", "Boundary", "Loads"}}},
    {"Control",
     {{},
      {},
      {"analysis", "time_steps", "step_size", "plot_level", "output_level", "solver",
       "time_stepper"}}},
    {"solver/solid", {{"type"}, {}, {"symmetric_stiffness"}}},
    {"time_stepper/default",
     {{"type"}, {}, {"max_retries", "opt_iter", "dtmin", "dtmax", "aggressiveness", "cutback"}}},
    {"Output", {{}, {}, {"logfile", "plotfile"}}},
    {"plotfile", {{}, {"type", "file"}, {"var"}}},
    {"var", {{"type"}, {}, {}}},
    {"logfile", {{}, {"file"}, {"node_data"}}},
    {"node_data", {{"data"}, {"file", "delim", "format", "comments", "name", "node_set"}, {}}},
};

// Values that are words.
const std::map<std::string, Words> kAllowed = {
    {"units", {"SI"}},
    {"analysis", {"STATIC", "DYNAMIC"}},
    {"symmetric_stiffness", {"non-symmetric", "symmetric", "symmetric structure", "preferred"}},
    {"interpolate", {"LINEAR", "STEP", "SMOOTH"}},
    {"extend", {"CONSTANT", "EXTRAPOLATE", "REPEAT", "REPEAT OFFSET"}},
    {"dof", {"x", "y", "z"}},
    {"x_dof", {"0", "1"}},
    {"y_dof", {"0", "1"}},
    {"z_dof", {"0", "1"}},
    {"relative", {"0", "1"}},
};

// Values that are numbers, with their ranges.
struct Range {
  double low, high;
  bool is_low_open, is_high_open;

  bool Has(double value) const {
    return (is_low_open ? value > low : value >= low) &&
           (is_high_open ? value < high : value <= high);
  }
};
constexpr Range kPositive{0, HUGE_VAL, true, true};
constexpr Range kNotNegative{0, HUGE_VAL, false, true};
const std::map<std::string, Range> kRanges = {
    {"density", kPositive},    {"E", kPositive},         {"v", {-1, 0.5, false, true}},
    {"time_steps", kPositive}, {"step_size", kPositive}, {"max_retries", kNotNegative},
    {"opt_iter", kPositive},   {"dtmin", kNotNegative},  {"dtmax", kPositive},
    {"g1", kNotNegative},      {"t1", kPositive}};

const std::map<std::string, size_t> kNodesOfType = {{"tet4", 4}, {"tet10", 10}};

std::optional<double> NumberOf(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

class FebCheck {
 public:
  std::vector<std::string> Faults(const XmlElement& root) {
    if (root.name != "febio_spec" || root.Attribute("version") != "4.0")
      Fault("the root is not febio_spec of version 4.0");
    Sections(root);
    for (const XmlElement& section : root.children) Structure(section, root.name);
    if (!faults_.empty()) return faults_;
    ReadMesh(*root.Find("Mesh"));
    Materials(*root.Find("Material"));
    Domains(*root.Find("MeshDomains"));
    Curves(root.Find("LoadData"));
    Maps(root.Find("MeshData"));
    for (const XmlElement& section : root.children) References(section);
    Steps(root);
    return faults_;
  }

 private:
  void Fault(const std::string& sentence) { faults_.push_back(sentence); }

  void Sections(const XmlElement& root) {
    size_t next = 0;
    for (const XmlElement& section : root.children) {
      const auto found = std::find(kSections.begin(), kSections.end(), section.name);
      const size_t place = static_cast<size_t>(found - kSections.begin());
      if (found == kSections.end())
        Fault("unknown section " + section.name);
      else if (place < next)
        Fault("section " + section.name + " is out of order, or written twice");
      else
        next = place + 1;
    }
    if (root.children.empty() || root.children.front().name != "Module")
      Fault("the first section is not Module");
    for (const std::string& name : kRequiredSections)
      if (root.Find(name) == nullptr) Fault("no section " + name);
  }

  static const ElementRule* RuleOf(const XmlElement& element, const std::string& parent) {
    for (const std::string& key : {element.name + "/" + element.Attribute("type"),
                                   parent + "/" + element.name, element.name})
      if (const auto found = kRules.find(key); found != kRules.end()) return &found->second;
    return nullptr;
  }

  void Structure(const XmlElement& element, const std::string& parent) {
    const ElementRule* rule = RuleOf(element, parent);
    if (rule == nullptr) {
      // A parameter: its parent's rule allows it.
      if (!element.attributes.empty() || !element.children.empty())
        Fault(fmt::format("{} of {} is not known", element.name, parent));
      return Value(element);
    }
    for (const std::string& key : rule->required)
      if (!element.attributes.contains(key))
        Fault(fmt::format("{} has no attribute {}", element.name, key));
    for (const auto& [key, value] : element.attributes)
      if (!rule->required.contains(key) && !rule->optional.contains(key))
        Fault(fmt::format("{} has the unknown attribute {}", element.name, key));
    for (const XmlElement& child : element.children) {
      if (!rule->children.contains(child.name))
        Fault(fmt::format("{} in {} is not known", child.name, element.name));
      Structure(child, element.name);
    }
    if (element.children.empty()) Value(element);
  }

  void Value(const XmlElement& element) {
    const auto allowed = kAllowed.find(element.name);
    if (allowed != kAllowed.end() && !allowed->second.contains(element.text))
      Fault(fmt::format("{} is \"{}\"", element.name, element.text));
    const auto range = kRanges.find(element.name);
    if (range == kRanges.end()) return;
    const std::optional<double> value = NumberOf(element.text);
    if (!value || !range->second.Has(*value))
      Fault(fmt::format("{} is \"{}\", out of its range", element.name, element.text));
  }

  // The numbers of a list "1,2,3".
  std::vector<double> Numbers(const XmlElement& element) {
    std::vector<double> numbers;
    const std::string& text = element.text;
    for (size_t begin = 0; begin <= text.size();) {
      const size_t end = std::min(text.find(',', begin), text.size());
      const std::optional<double> value =
          NumberOf(std::string_view(text).substr(begin, end - begin));
      if (!value) Fault(fmt::format("{} holds \"{}\"", element.name, text.substr(0, 60)));
      numbers.push_back(value.value_or(0));
      begin = end + 1;
    }
    return numbers;
  }

  // Whether the attribute counts 1, 2, 3, … over these elements.
  void Count(const std::vector<const XmlElement*>& elements, const std::string& key) {
    for (size_t k = 0; k < elements.size(); ++k)
      if (elements[k]->Attribute(key) != std::to_string(k + 1))
        Fault(fmt::format("{} number {} has {} {}", elements[k]->name, k + 1, key,
                          elements[k]->Attribute(key)));
  }

  void ReadMesh(const XmlElement& mesh) {
    const XmlElement* nodes = mesh.Find("Nodes");
    if (mesh.All("Nodes").size() != 1) return Fault("not one list of nodes");
    Count(nodes->All("node"), "id");
    for (const XmlElement& node : nodes->children) {
      const std::vector<double> place = Numbers(node);
      if (place.size() != 3) return Fault("a node has not three coordinates");
      nodes_.emplace_back(place[0], place[1], place[2]);
    }
    if (nodes->attributes.contains("name")) node_sets_[nodes->Attribute("name")] = nodes_.size();
    size_t first = 0;
    for (const XmlElement* part : mesh.All("Elements")) {
      if (!parts_.insert(part->Attribute("name")).second) Fault("a part's name stands twice");
      Elements(*part, first);
      first += part->children.size();
    }
    for (const XmlElement* set : mesh.All("NodeSet")) {
      const std::vector<double> members = Numbers(*set);
      if (std::set<double>(members.begin(), members.end()).size() != members.size())
        Fault("a node stands twice in " + set->Attribute("name"));
      for (const double node : members) IsNode(node);
      if (!node_sets_.emplace(set->Attribute("name"), members.size()).second)
        Fault("the node set " + set->Attribute("name") + " stands twice");
    }
  }

  bool IsNode(double number) {
    if (number == std::floor(number) && number >= 1 && number <= static_cast<double>(nodes_.size()))
      return true;
    Fault(fmt::format("there is no node {}", number));
    return false;
  }

  void Elements(const XmlElement& part, size_t first) {
    const auto type = kNodesOfType.find(part.Attribute("type"));
    if (type == kNodesOfType.end())
      return Fault("unknown type of elements " + part.Attribute("type"));
    for (size_t e = 0; e < part.children.size(); ++e) {
      const XmlElement& element = part.children[e];
      if (element.Attribute("id") != std::to_string(first + e + 1))
        Fault("an element is not numbered consecutively");
      const std::vector<double> nodes = Numbers(element);
      if (nodes.size() != type->second) return Fault("an element has not the nodes of its type");
      if (!std::all_of(nodes.begin(), nodes.end(), [&](double node) { return IsNode(node); }))
        return;
      const auto at = [&](size_t k) { return nodes_[static_cast<size_t>(nodes[k]) - 1]; };
      const Eigen::Vector3d a = at(1) - at(0), b = at(2) - at(0), c = at(3) - at(0);
      if (a.cross(b).dot(c) <= 0) Fault(fmt::format("element {} has no positive volume", e + 1));
    }
  }

  void Materials(const XmlElement& section) {
    Count(section.All("material"), "id");
    for (const XmlElement& material : section.children)
      if (!materials_.insert(material.Attribute("name")).second)
        Fault("a material's name stands twice");
  }

  void Domains(const XmlElement& section) {
    std::set<std::string> without = parts_;
    for (const XmlElement& domain : section.children) {
      if (without.erase(domain.Attribute("name")) == 0)
        Fault("a domain for the part " + domain.Attribute("name") + " that is not there");
      if (!materials_.contains(domain.Attribute("mat")))
        Fault("there is no material " + domain.Attribute("mat"));
    }
    for (const std::string& part : without) Fault("the part " + part + " has no domain");
  }

  void Curves(const XmlElement* section) {
    if (section == nullptr) return;
    Count(section->All("load_controller"), "id");
    curve_count_ = section->children.size();
    for (const XmlElement& curve : section->children) {
      const XmlElement* points = curve.Find("points");
      if (points == nullptr) {
        Fault("a load curve without points");
        continue;
      }
      double last = -HUGE_VAL;
      for (const XmlElement& point : points->children) {
        const std::vector<double> values = Numbers(point);
        if (values.size() != 2 || values[0] <= last) Fault("a load curve goes back in time");
        last = values[0];
      }
    }
  }

  void Maps(const XmlElement* section) {
    if (section == nullptr) return;
    for (const XmlElement& map : section->children) {
      if (!maps_.insert(map.Attribute("name")).second)
        Fault("the map " + map.Attribute("name") + " stands twice");
      Count(map.All("node"), "lid");
      for (const XmlElement& node : map.children) Numbers(node);
      const auto set = node_sets_.find(map.Attribute("node_set"));
      if (set != node_sets_.end() && set->second != map.children.size())
        Fault("the map " + map.Attribute("name") + " has not the length of its node set");
    }
  }

  void References(const XmlElement& element) {
    if (element.attributes.contains("node_set") &&
        !node_sets_.contains(element.Attribute("node_set")))
      Fault("there is no node set " + element.Attribute("node_set"));
    if (element.attributes.contains("lc")) {
      const std::optional<double> curve = NumberOf(element.Attribute("lc"));
      if (!curve || *curve != std::floor(*curve) || *curve < 1 ||
          *curve > static_cast<double>(curve_count_))
        Fault("there is no load controller " + element.Attribute("lc"));
    }
    if (element.Attribute("type") == "map" && !maps_.contains(element.text))
      Fault("there is no map " + element.text);
    for (const XmlElement& child : element.children) References(child);
  }

  void Steps(const XmlElement& root) {
    const XmlElement* section = root.Find("Step");
    if (section == nullptr) {
      if (root.Find("Control") == nullptr) Fault("neither Control nor Step");
      return;
    }
    Count(section->All("step"), "id");
    for (const XmlElement& step : section->children)
      if (step.Find("Control") == nullptr) Fault("a step without Control");
  }

  std::vector<std::string> faults_;
  std::vector<Eigen::Vector3d> nodes_;
  std::map<std::string, size_t> node_sets_;  // with their numbers of nodes
  std::set<std::string> parts_, materials_, maps_;
  size_t curve_count_ = 0;
};

}  // namespace

std::vector<std::string> FebFaults(const std::string& text) {
  if (!text.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"))
    return {"the XML declaration is missing"};
  try {
    return FebCheck().Faults(ReadXml(text));
  } catch (const std::runtime_error& error) {
    return {error.what()};
  }
}

}  // namespace lacuna
