#include "paper/drop_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "effects/plane_contact.h"
#include "fem/element_strain.h"
#include "report/line_chart.h"

namespace lacuna {
namespace {

struct Column {
  const char* name;
  double DropNumbers::*value;
  double scale;  // from SI to the unit of `name`
  const char* format;
};
constexpr std::array<Column, 9> kColumns{{
    {"touch ms", &DropNumbers::touch_time, 1e3, "{:.3f}"},
    {"contact ms", &DropNumbers::contact_time, 1e3, "{:.2f}"},
    {"compression %", &DropNumbers::compression, 1e2, "{:.2f}"},
    {"peak force N", &DropNumbers::peak_force, 1, "{:.1f}"},
    {"rebound m/s", &DropNumbers::rebound_speed, 1, "{:.4f}"},
    {"rebound mm", &DropNumbers::rebound_height, 1e3, "{:.1f}"},
    {"frequency Hz", &DropNumbers::frequency, 1, "{:.2f}"},
    {"energy growth", &DropNumbers::energy_growth, 1, "{:.1e}"},
    {"energy left %", &DropNumbers::energy_left, 1e2, "{:.1f}"},
}};
// Whether the relative change of a column is meaningful.
bool IsCompared(const Column& column) {
  return column.value != &DropNumbers::touch_time && column.value != &DropNumbers::energy_growth;
}

const char* NameOf(int order) { return order == 2 ? "quadratic" : "linear"; }

std::string Cell(double value, const char* format) {
  return fmt::format("{:>15}", std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value));
}

std::string Header() {
  std::string line = fmt::format("{:24}", "elements, nodes");
  for (const Column& column : kColumns) line += fmt::format("{:>15}", column.name);
  return line + "\n";
}

std::string LabelOf(const DropRun& run) {
  return fmt::format("{:24}", fmt::format("{}, {} ({})", NameOf(run.mesh.settings.order),
                                          run.motion.body->NodeCount(), run.mesh.paper_nodes));
}

std::string ChangesFrom(const DropNumbers& from, const DropNumbers& to) {
  std::string line;
  for (const Column& column : kColumns) {
    const double change = to.*column.value / from.*column.value - 1;
    line += IsCompared(column) ? Cell(100 * change, "{:+.2f}") : fmt::format("{:>15}", "");
  }
  return line + "\n";
}

const DropRun& FinestOf(const std::vector<DropRun>& runs) {
  return *std::max_element(runs.begin(), runs.end(), [](const DropRun& a, const DropRun& b) {
    return std::make_pair(a.mesh.settings.order, a.motion.body->NodeCount()) <
           std::make_pair(b.mesh.settings.order, b.motion.body->NodeCount());
  });
}

// Largest principal strain, in %, averaged over the elements around each boundary vertex with their
// volumes as weights.
Eigen::VectorXd SurfaceStrain(const Body& body, const Eigen::Matrix3Xd& positions) {
  const Eigen::VectorXd position = positions.reshaped();
  const Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(position.size());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(body.NodeCount()), weight = sum;
  for (int e = 0; e < body.ElementCount(); ++e) {
    const double strain = LargestPrincipal(MeanStrain(body, e, position, at_rest).strain);
    const double volume = body.weight
                              .segment(static_cast<Eigen::Index>(e) * body.points_per_element,
                                       body.points_per_element)
                              .sum();
    for (const int node : body.mesh.tets.col(e)) {
      sum[node] += volume * strain;
      weight[node] += volume;
    }
  }
  return 100 * sum.cwiseQuotient(weight)(body.boundary.node);
}

// The rectangle of the floor that the pictures show.
PanelSurface Floor(const Eigen::AlignedBox3d& box, double height) {
  PanelSurface floor;
  const Eigen::Vector3d low = box.min(), high = box.max();
  floor.mesh.vertices.resize(3, 4);
  floor.mesh.vertices << low.x(), high.x(), high.x(), low.x(),  //
      low.y(), low.y(), high.y(), high.y(),                     //
      height, height, height, height;
  floor.mesh.triangles.resize(3, 2);
  floor.mesh.triangles << 0, 0, 1, 2, 2, 3;
  floor.colour = {0.88, 0.86, 0.82};
  floor.is_lit = false;
  return floor;
}

size_t FrameAt(const DropMotion& motion, double time) {
  size_t nearest = 0;
  for (size_t k = 0; k < motion.times.size(); ++k)
    if (std::abs(motion.times[k] - time) < std::abs(motion.times[nearest] - time)) nearest = k;
  return nearest;
}

void WriteHeights(const std::vector<DropRun>& runs, const std::filesystem::path& file) {
  std::vector<ChartLine> lines;
  for (const DropRun& run : runs) {
    const auto count = static_cast<Eigen::Index>(run.motion.times.size());
    ChartLine line{
        fmt::format("{} {}", run.motion.body->NodeCount(), NameOf(run.mesh.settings.order)),
        Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto heights = run.motion.positions[static_cast<size_t>(k)].row(2);
      line.x[k] = 1e3 * run.motion.times[static_cast<size_t>(k)];
      line.y[k] = 1e3 * (heights.maxCoeff() - heights.minCoeff());
    }
    lines.push_back(std::move(line));
  }
  WriteLineChart(file, {"Height of the dropped body", "time, ms", "mm", lines});
}

nlohmann::json JsonOf(const std::vector<DropRun>& runs) {
  nlohmann::json json = nlohmann::json::array();
  for (const DropRun& run : runs) {
    json.push_back({{"paper_nodes", run.mesh.paper_nodes},
                    {"nodes", run.motion.body->NodeCount()},
                    {"tetrahedra", run.motion.body->ElementCount()},
                    {"order", run.mesh.settings.order},
                    {"volume_m3", run.motion.body->weight.sum()},
                    {"numbers", ToJson(run.numbers)},
                    {"numbers_with_halved_steps", ToJson(run.halved)}});
  }
  return json;
}

}  // namespace

std::string DropText(const std::vector<DropRun>& runs) {
  std::string text =
      "Figure 1: one body dropped on a floor; in brackets the nodes of the paper's meshes.\n"
      "Energy in parts of the kinetic energy at the start: growth is its largest rise from one\n"
      "moment to a later one, left is what there is at the end.\n\n" +
      Header();
  for (const DropRun& run : runs) {
    text += LabelOf(run);
    for (const Column& column : kColumns)
      text += Cell(column.scale * run.numbers.*column.value, column.format);
    text += "\n";
  }
  text += "\nChange when every step is halved, %\n" + Header();
  for (const DropRun& run : runs) text += LabelOf(run) + ChangesFrom(run.numbers, run.halved);
  const DropRun& finest = FinestOf(runs);
  text += fmt::format("\nDifference from {} nodes, {}, %\n", finest.motion.body->NodeCount(),
                      NameOf(finest.mesh.settings.order)) +
          Header();
  for (const DropRun& run : runs) {
    if (&run == &finest) continue;
    text += LabelOf(run) + ChangesFrom(finest.numbers, run.numbers);
  }
  return text;
}

PanelPicture DropPicture(const DropStudy& study, const std::vector<DropRun>& runs, int order) {
  std::vector<const DropRun*> drawn;
  Eigen::AlignedBox3d box;
  for (const DropRun& run : runs) {
    if (run.mesh.settings.order != order) continue;
    drawn.push_back(&run);
    for (const double instant : study.instants)
      box.extend(BoundingBox(run.motion.positions[FrameAt(run.motion, instant)]));
  }
  PanelPicture picture;
  picture.columns = static_cast<int>(drawn.size());
  picture.title =
      fmt::format("Figure 1: dropped body, {} elements, at the same instants", NameOf(order));
  picture.value_name = "strain %";
  const double floor_height = ContactPlaneOf(*FindPlaneContact(study.scene.effects))->offset;
  const Eigen::Vector3d margin = 0.12 * box.sizes();
  const Eigen::AlignedBox3d ground(box.min() - margin, box.max() + margin);
  for (const double instant : study.instants) {
    for (const DropRun* run : drawn) {
      const Body& body = *run->motion.body;
      const size_t k = FrameAt(run->motion, instant);
      Panel panel;
      panel.title = fmt::format("n = {}, {:.1f} ms", body.NodeCount(), 1e3 * run->motion.times[k]);
      panel.surfaces.push_back(Floor(ground, floor_height));
      PanelSurface surface;
      surface.mesh = BoundaryAt(body.boundary, run->motion.positions[k]);
      surface.vertex_values = SurfaceStrain(body, run->motion.positions[k]);
      surface.show_edges = true;
      panel.surfaces.push_back(std::move(surface));
      picture.panels.push_back(std::move(panel));
    }
  }
  return picture;
}

PictureResult WriteDropFigure(const DropStudy& study, const std::vector<DropRun>& runs,
                              const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "figure1.txt", DropText(runs));
  WriteFileAtomically(folder / "figure1.json", JsonOf(runs).dump(2) + "\n");
  WriteHeights(runs, folder / "figure1_height.svg");
  PictureResult result{PictureResult::Status::kWritten, ""};
  for (const int order : {1, 2}) {
    const PanelPicture picture = DropPicture(study, runs, order);
    if (picture.panels.empty()) continue;
    PanelOptions options;
    options.width = 1650;
    options.height = 1300;
    options.view_direction = {-0.35, 1, -0.28};
    options.text_size = 24;
    result =
        RenderPanelPng(folder / fmt::format("figure1_{}.png", NameOf(order)), picture, options);
    if (!result.IsUsable()) break;
  }
  return result;
}

}  // namespace lacuna
