#include "exchange/inp_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "exchange/inp_labels.h"
#include "exchange/inp_lines.h"
#include "geometry/tet_soup.h"

namespace lacuna {
namespace {

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file), lines_(file) {}

  ImportedModel Read() {
    bool has_line = lines_.Next();
    if (has_line && !lines_.IsKeyword()) lines_.Fail("expected a keyword line, such as *NODE");
    while (has_line) has_line = ReadBlock();
    return Finish();
  }

 private:
  // Each reads from a keyword line up to the next one and returns whether there is one.
  bool ReadBlock() {
    const std::string keyword = lines_.Keyword();
    if (IsRead(keyword) && lines_.Parameter("INPUT") != nullptr)
      lines_.Fail(fmt::format(
          "*{} with INPUT is not read: put the content of that file in its place", keyword));
    if (keyword == "NODE") return ReadNodes();
    if (keyword == "ELEMENT") return ReadElements();
    if (keyword == "NSET") return ReadSet("NSET", &nodes_);
    if (keyword == "ELSET") return ReadSet("ELSET", &elements_);
    if (keyword == "MATERIAL") return ReadMaterial();
    if (keyword == "ELASTIC" || keyword == "DENSITY") return ReadProperty(keyword == "ELASTIC");
    if (keyword == "SOLID SECTION") return ReadSection();
    if (keyword == "INSTANCE") return ReadInstance();
    if (keyword == "INCLUDE")
      lines_.Fail("*INCLUDE is not read: put the content of that file in its place");
    if (keyword == "SYSTEM")
      lines_.Fail(
          "*SYSTEM is not read: give the coordinates of all nodes in the global Cartesian system");
    if (keyword != "HEADING") NotRead();
    return SkipData();
  }

  static bool IsRead(const std::string& keyword) {
    static const std::set<std::string> read = {"NODE",     "ELEMENT", "NSET",   "ELSET",
                                               "MATERIAL", "ELASTIC", "DENSITY"};
    return read.contains(keyword);
  }

  void NotRead() {
    model_.not_read.push_back(
        fmt::format("line {}: {}", lines_.KeywordLine(), lines_.KeywordText()));
  }

  // The data lines of a section give a thickness, which a solid does not have.
  bool ReadSection() {
    const std::string* elements = lines_.Parameter("ELSET");
    const std::string* material = lines_.Parameter("MATERIAL");
    if (elements != nullptr && material != nullptr)
      sections_.push_back({*elements, *material,
                           fmt::format("line {}: {}", lines_.KeywordLine(), lines_.KeywordText())});
    else
      NotRead();
    return SkipData();
  }

  // The data lines of an instance move and turn its part.
  bool ReadInstance() {
    NotRead();
    if (NextData())
      lines_.Fail(
          "*INSTANCE with a translation or a rotation is not read: give the coordinates of all "
          "nodes in the assembly's coordinate system");
    return has_next_;
  }

  bool NextData() { return has_next_ = lines_.Next(), has_next_ && !lines_.IsKeyword(); }

  bool SkipData() {
    while (NextData()) continue;
    return has_next_;
  }

  // The set that a parameter of the keyword line names; null: it names none.
  InpLabels::Set* SetOf(const char* parameter, InpLabels* labels) {
    const std::string* name = lines_.Parameter(parameter);
    return name == nullptr || name->empty() ? nullptr : labels->SetNamed(*name);
  }

  bool ReadNodes() {
    if (const std::string* system = lines_.Parameter("SYSTEM"); system != nullptr && *system != "R")
      lines_.Fail(fmt::format("only Cartesian coordinates are read, not SYSTEM={}", *system));
    InpLabels::Set* set = SetOf("NSET", &nodes_);
    while (NextData()) {
      const int label = lines_.Label(0, "the number of a node");
      if (!nodes_.Add(label, static_cast<int>(soup_.nodes.size())))
        lines_.Fail(fmt::format("node {} appears a second time", label));
      node_labels_.push_back(label);
      soup_.nodes.emplace_back(lines_.Number(1, "x"), lines_.Number(2, "y"), lines_.Number(3, "z"));
      if (set != nullptr) set->insert(label);
    }
    return has_next_;
  }

  // The number of nodes of a tetrahedron of this type, with any letters behind C3D4 or C3D10; 0 for
  // other elements.
  static size_t NodesOfTet(std::string_view type) {
    for (const size_t size : {4, 10}) {
      const std::string plain = fmt::format("C3D{}", size);
      if (type.starts_with(plain) && type.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ",
                                                            plain.size()) == std::string_view::npos)
        return size;
    }
    return 0;
  }

  // Whether elements of this type fill a volume: solids, also acoustic and thermal ones, continuum
  // shells and cohesive elements.
  static bool IsOtherVolume(std::string_view type) {
    return type.find("C3D") != std::string_view::npos || type.starts_with("SC") ||
           type.starts_with("CSS") || type.starts_with("COH3D");
  }

  bool SkipElements(const std::string& type) {
    const int line = lines_.KeywordLine();
    NotRead();
    elements_.AllowUnknown();
    skipped_types_.insert(type);
    long long count = 0;
    for (bool continues = false; NextData(); continues = lines_.EndsWithComma())
      count += !continues;
    if (IsOtherVolume(type)) soup_.AddOther("of type " + type, line, count);
    return has_next_;
  }

  bool ReadElements() {
    const std::string type = lines_.RequiredParameter("TYPE");
    const size_t size = NodesOfTet(type);
    if (size == 0) return SkipElements(type);
    if (const std::string plain = fmt::format("C3D{}", size); type != plain)
      variants_.insert(fmt::format(
          "elements of type {} are read as {}: Lacuna has no hybrid or modified tetrahedra", type,
          plain));
    InpLabels::Set* set = SetOf("ELSET", &elements_);
    while (NextData()) {
      const int line = lines_.Line(), label = lines_.Label(0, "the number of an element");
      if (!elements_.Add(label, static_cast<int>(soup_.tets.size())))
        lines_.Fail(fmt::format("element {} appears a second time", label));
      std::vector<int> tet;
      size_t at = 1;
      while (tet.size() < size) {
        if (at == lines_.Fields().size() && lines_.EndsWithComma()) {
          if (!NextData())
            lines_.Fail(fmt::format("element {} ends after {} nodes", label, tet.size()));
          at = 0;
        }
        tet.push_back(NodeAt(at++));
      }
      if (at < lines_.Fields().size())
        lines_.Fail(fmt::format("element {} has more than {} nodes", label, size));
      // The node order of C3D10 is that of TetMesh.
      soup_.Add(tet, line);
      if (set != nullptr) set->insert(label);
    }
    return has_next_;
  }

  int NodeAt(size_t field) {
    const int label = lines_.Label(field, "the number of a node");
    const std::optional<int> found = nodes_.IndexOf(label);
    if (!found) lines_.Fail(fmt::format("there is no node {}", label));
    return *found;
  }

  bool ReadSet(const char* parameter, InpLabels* labels) {
    lines_.RequiredParameter(parameter);
    // A set of an instance is read like any other, because the numbers in the file are unique, and
    // the order of UNSORTED is lost. INTERNAL hides a set from the user of Abaqus.
    std::set<std::string> known = {parameter, "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"};
    const bool is_of_nodes = labels == &nodes_;
    if (is_of_nodes) known.insert("ELSET");
    lines_.RefuseParametersBut(known);
    const bool generates = lines_.Parameter("GENERATE") != nullptr;
    InpLabels::Set* set = SetOf(parameter, labels);
    if (is_of_nodes && lines_.Parameter("ELSET") != nullptr) return ReadNodesOfElements(set);
    while (NextData()) {
      if (generates)
        labels->AddRange(lines_, set);
      else
        labels->AddLine(lines_, set);
    }
    return has_next_;
  }

  // *NSET, NSET=A, ELSET=B: the nodes of the elements of B.
  bool ReadNodesOfElements(InpLabels::Set* set) {
    const std::string& name = lines_.RequiredParameter("ELSET");
    if (const InpLabels::Set* elements = elements_.FindSet(name); elements != nullptr) {
      for (const int label : *elements) {
        const auto tet = static_cast<size_t>(*elements_.IndexOf(label));
        const auto size = static_cast<size_t>(soup_.sizes[tet]);
        entries_.Add(size, lines_);
        for (size_t k = 0; k < size; ++k)
          set->insert(node_labels_[static_cast<size_t>(soup_.tets[tet][k])]);
      }
    } else if (!elements_.AllowsUnknown()) {
      lines_.Fail(fmt::format("there is no element set {} above", name));
    }
    if (NextData()) lines_.Fail("expected a keyword line: the nodes are those of the element set");
    return has_next_;
  }

  bool ReadMaterial() {
    model_.materials.push_back({lines_.RequiredParameter("NAME"), {}, {}, {}});
    return SkipData();
  }

  bool ReadProperty(bool is_elasticity) {
    const std::string keyword = lines_.Keyword();
    if (model_.materials.empty())
      lines_.Fail(fmt::format("*{} stands before any *MATERIAL", keyword));
    const std::string* type = lines_.Parameter("TYPE");
    if (type != nullptr && !type->starts_with("ISO"))
      lines_.Fail(fmt::format("only isotropic elasticity is read, not TYPE={}", *type));
    ImportedMaterial& material = model_.materials.back();
    std::optional<double>& value = is_elasticity ? material.young_modulus : material.density;
    if (value) lines_.Fail(fmt::format("the material has a second *{}", keyword));
    const std::string* moduli = lines_.Parameter("MODULI");
    if (is_elasticity && moduli != nullptr && *moduli == "INSTANTANEOUS")
      material.is_instantaneous = true;
    while (NextData()) {
      if (value)
        lines_.Fail(
            fmt::format("a second line of *{}: values that depend on temperature are not "
                        "read",
                        keyword));
      value = lines_.Number(0, is_elasticity ? "Young's modulus" : "the density");
      if (*value <= 0) lines_.Fail(fmt::format("*{} must be positive", keyword));
      if (!is_elasticity) continue;
      material.poisson_ratio = lines_.Number(1, "Poisson's ratio");
      if (*material.poisson_ratio <= -1 || *material.poisson_ratio >= 0.5)
        lines_.Fail(
            "Poisson's ratio must lie between -1 and 0.5; for an incompressible material write "
            "0.49");
    }
    if (!value) lines_.Fail(fmt::format("*{} has no values", keyword));
    return has_next_;
  }

  // How many elements each material has. Sections of sets or materials that the file does not have
  // are not read.
  void AssignMaterials() {
    for (const Section& section : sections_) {
      const InpLabels::Set* elements = elements_.FindSet(section.elements);
      const auto material =
          std::find_if(model_.materials.begin(), model_.materials.end(),
                       [&](const ImportedMaterial& one) { return one.name == section.material; });
      if (elements == nullptr || material == model_.materials.end())
        model_.not_read.push_back(section.line);
      else
        material->element_count += elements->size();
    }
  }

  ImportedModel Finish() {
    if (soup_.tets.empty() && soup_.others == 0)
      throw InputError(
          {file_.string()},
          fmt::format("has no tetrahedra (C3D4, C3D10 and their variants){}",
                      skipped_types_.empty() ? ""
                                             : fmt::format("; its elements are of type {}",
                                                           fmt::join(skipped_types_, ", "))));
    TetMeshFile read = FinishTetMesh(soup_, file_);
    model_.notes.assign(variants_.begin(), variants_.end());
    model_.notes.insert(model_.notes.end(), read.notes.begin(), read.notes.end());
    AssignMaterials();
    std::vector<int> kept(soup_.nodes.size(), -1), all(soup_.tets.size());
    for (Eigen::Index n = 0; n < read.node_in_file.size(); ++n)
      kept[static_cast<size_t>(read.node_in_file[n])] = static_cast<int>(n);
    for (size_t e = 0; e < all.size(); ++e) all[e] = static_cast<int>(e);
    model_.node_sets = nodes_.SetsInMesh(kept, &model_.notes);
    model_.element_sets = elements_.SetsInMesh(all, &model_.notes);
    model_.mesh = std::move(read.mesh);
    return std::move(model_);
  }

  std::filesystem::path file_;
  InpLines lines_;
  bool has_next_ = false;
  TetSoup soup_;
  InpEntries entries_;
  InpLabels nodes_{&entries_}, elements_{&entries_};
  std::vector<int> node_labels_;  // in the order of soup_.nodes
  struct Section {
    std::string elements, material;
    std::string line;  // as in ImportedModel::not_read
  };
  std::vector<Section> sections_;
  std::set<std::string> variants_, skipped_types_;  // notes on types of tetrahedra; other types
  ImportedModel model_;
};

}  // namespace

ImportedModel ReadInp(const std::filesystem::path& file) { return Reader(file).Read(); }

}  // namespace lacuna
