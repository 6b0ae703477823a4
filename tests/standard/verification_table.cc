#include "standard/verification_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/quantity.h"

namespace lacuna {
namespace {

std::string Percent(double error) {
  if (!std::isfinite(error)) return "–";
  return error < 0.995 ? fmt::format("{:.2g} %", 100 * error)
                       : fmt::format("{:.0f} %", 100 * error);
}

std::string NameOf(const Wanted& wanted) {
  const std::string name = wanted.kind == Wanted::Kind::kFrequency
                               ? fmt::format("frequency {}", wanted.mode)
                               : wanted.name;
  return wanted.label.empty() ? name : name + ", " + wanted.label;
}

std::string Value(double value, const Wanted& wanted) {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format("{:.5g}", value / wanted.scale);
  return wanted.unit.empty() ? text : text + " " + wanted.unit;
}

std::string MeshText(const Problem& problem) {
  std::vector<std::string> meshes;
  const bool has_steps =
      problem.kind == ProblemKind::kMotion || problem.kind == ProblemKind::kQuasiStatic;
  for (const ProblemMesh& mesh : problem.meshes) {
    std::string text = fmt::format("{}", fmt::join(mesh.cells, "×"));
    if (has_steps) text += fmt::format(" in {} steps", mesh.steps);
    meshes.push_back(text);
  }
  return fmt::format("{}", fmt::join(meshes, ", "));
}

std::string Row(const SolvedProblem& solved, const RefinementStudy& study, size_t wanted) {
  const Problem& problem = solved.problem;
  const Wanted& quantity = problem.wanted[wanted];
  std::string errors;
  for (size_t mesh = 0; mesh < study.solutions.size(); ++mesh)
    errors += Percent(study.Error(problem, mesh, wanted)) + " | ";
  const ProblemSolution& finest = study.solutions.back();
  const double order = study.ObservedOrder(problem, wanted);
  return fmt::format("| {} | {} | {} | {} | {}{} |\n", NameOf(quantity), study.order,
                     Value(quantity.value, quantity),
                     finest.IsUsable() ? Value(finest.values[wanted], quantity) : "–", errors,
                     std::isfinite(order) ? fmt::format("{:.1f}", order) : "–");
}

}  // namespace

std::string VerificationTable(const std::vector<SolvedProblem>& problems) {
  std::string text =
      "# Standard problems: results\n\n"
      "This page is written by `lacuna-standard --table`. [verification.md](verification.md) says "
      "what the numbers mean.\n\n";
  for (const SolvedProblem& solved : problems) {
    const Problem& problem = solved.problem;
    text += fmt::format("## {}\n\n{}\n", problem.title, problem.source);
    if (!problem.remark.empty()) text += "\n" + problem.remark + "\n";
    text += fmt::format("\nCells, of six tetrahedra each: {}.\n\n", MeshText(problem));
    text += "| quantity | order of elements | published | finest mesh |";
    for (size_t mesh = 0; mesh < solved.studies.front().solutions.size(); ++mesh)
      text += fmt::format(" error, mesh {} |", mesh + 1);
    text += " observed order |\n|---|---|---|---|";
    for (size_t mesh = 0; mesh < solved.studies.front().solutions.size(); ++mesh) text += "---|";
    text += "---|\n";
    for (size_t wanted = 0; wanted < problem.wanted.size(); ++wanted)
      for (const RefinementStudy& study : solved.studies) text += Row(solved, study, wanted);
    if (!problem.peers.empty())
      text += "\n| other program | quantity | value | error |\n|---|---|---|---|\n";
    for (const PeerResult& peer : problem.peers) {
      const Wanted& wanted = problem.wanted[peer.wanted];
      text += fmt::format("| {} ({}) | {} | {} | {} |\n", peer.program, peer.source, NameOf(wanted),
                          Value(peer.value, wanted),
                          Percent(std::abs(peer.value - wanted.value) / std::abs(wanted.value)));
    }
    for (const RefinementStudy& study : solved.studies)
      for (const ProblemSolution& solution : study.solutions)
        if (!solution.IsUsable())
          text += fmt::format("\nElements of order {} failed on a mesh of {} nodes: {}.\n",
                              study.order, solution.nodes, solution.message);
    text += "\n";
  }
  return text;
}

}  // namespace lacuna
