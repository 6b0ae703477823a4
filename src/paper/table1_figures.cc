#include "paper/table1_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/measure.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "experiment/kept_recording.h"
#include "geometry/cut_open.h"
#include "geometry/nearest.h"
#include "meshing/tet_quality.h"
#include "paper/evaluation_record.h"
#include "paper/parameter_objective.h"
#include "report/arrow_mesh.h"
#include "scan/scan_writer.h"

namespace lacuna {
namespace {

const Eigen::Vector3d kScanColour(0.15, 0.2, 0.3), kFaintColour(0.74, 0.78, 0.84),
    kSkinColour(0.62, 0.72, 0.84), kInnerColour(0.95, 0.72, 0.42), kRemovedColour(0.85, 0.15, 0.1);
constexpr double kDeg = 180 / std::numbers::pi;

ParameterObjective ProblemOf(const Table1Study& table1, const Table1Scans& scans) {
  const ParameterSearchSettings& search = table1.configurations.front().search;
  return {scans.study,
          scans.states,
          scans.tracked,
          search.remesh_surface,
          search.registration_in_loop,
          0};
}

// The mesh where the first search starts, with the true moduli.
SearchedParameters ReferenceParameters(const Table1Study& table1) {
  const std::vector<SearchVariable>& variables = table1.configurations.front().search.variables;
  return {variables[0].start, variables[1].start, table1.true_young_modulus,
          table1.true_poisson_ratio};
}

// What the table has of a search's end.
struct Optimum {
  std::string name;
  SearchedParameters parameters;
  double residual_per_point = kNotMeasured;  // m
};

// Reads the best points of the searches of the first seed.
std::vector<Optimum> ReadOptima(const Table1Study& table1, const std::filesystem::path& results) {
  const std::filesystem::path file = results / "table1.json";
  if (!std::filesystem::exists(file))
    throw InputError(SourcePosition{file.string()}, "does not exist; run `lacuna table1` first");
  if (!IsKeptRecording(results / "seed_1" / "recording", RecordingKey(table1, 1)))
    throw InputError(
        SourcePosition{file.string()},
        "belongs to another scene, was made by another version of Lacuna, or its recording was "
        "changed; run `lacuna table1` with another `--output`, and name that folder as `--table1`");
  std::vector<Optimum> optima;
  ReadJsonFile(file, [&optima](const nlohmann::json& table) {
    for (const nlohmann::json& search : table.at("searches")) {
      if (search.at("seed") != 1 || !search.contains("best")) continue;
      optima.push_back(
          {search.at("name"), SearchedParametersFrom(search.at("best").at("parameters")),
           search.at("best").at("evaluation").at("residual_per_point_m").get<double>()});
    }
  });
  if (optima.empty())
    throw InputError(SourcePosition{file.string()}, "holds no search that found something");
  return optima;
}

FollowedMotion FollowOrThrow(const ParameterObjective& problem,
                             const SearchedParameters& parameters) {
  FollowedMotion motion =
      FollowForObjective(problem, parameters, MakeObjectiveBody(problem, parameters));
  const FollowedFrame& last = motion.frames.back();
  if (!last.solver.usable) {
    throw InputError(fmt::format("{}: frame {} cannot be followed: {}", problem.study.name,
                                 motion.frames.size() - 1, last.solver.message));
  }
  return motion;
}

PanelSurface EdgesOf(const TriMesh& mesh, const Eigen::Vector3d& colour) {
  PanelSurface surface;
  surface.mesh = mesh;
  surface.colour = colour;
  surface.only_edges = true;
  return surface;
}

// From one side, a little from above; long pictures for a long body.
PanelOptions SideView(int width, int height) {
  PanelOptions options;
  options.width = width;
  options.height = height;
  options.view_direction = {-0.45, 1, -0.4};
  options.text_size = 24;
  return options;
}

int FrameNumber(const Table1Scans& scans, size_t k) { return scans.study.frames[k]; }

}  // namespace

FigureContent DrawCloudAndSurface(const Table1Scans& scans, const Table1FigureSettings& settings) {
  const auto k = static_cast<size_t>(settings.cloud_frame);
  const Frame raw = LoadFrame(scans.study.recording, FrameNumber(scans, k));
  const FrameState& state = scans.states[k];
  // What the filter took away is what the cleaned cloud does not have in the same place.
  const Eigen::MatrixXd nearest =
      PointSearch(state.cloud.points).Nearest(raw.cloud.points).distance;
  const double rounding = 1e-6 * BoundingBoxDiagonal(raw.cloud.points);
  std::vector<Eigen::Index> removed;
  for (Eigen::Index j = 0; j < raw.cloud.Size(); ++j)
    if (nearest(0, j) > rounding) removed.push_back(j);

  const TriMesh truth =
      ReadTrueSurface(scans.study.recording.file.parent_path(), FrameNumber(scans, k));
  const Eigen::VectorXd error = SurfaceSearch(truth).Nearest(state.surface.vertices).distance;
  const LengthSummary to_scan = DistanceToSurface(state.surface, state.cloud.points);
  const LengthSummary to_truth = Summarise(error);

  FigureContent figure;
  figure.options = SideView(1800, 760);
  figure.picture.title = fmt::format("Figure 3: scan and surface, frame {}", settings.cloud_frame);
  figure.picture.columns = 2;
  figure.picture.value_name = "error mm";
  figure.picture.legend = {{kScanColour, "kept point"}, {kRemovedColour, "removed point"}};
  Panel cloud, surface;
  cloud.title = fmt::format("{} points, {} removed", raw.cloud.Size(), removed.size());
  cloud.points.push_back({state.cloud.points, kScanColour, 2});
  cloud.points.push_back({raw.cloud.points(Eigen::all, removed), kRemovedColour, 4});
  surface.title = fmt::format("surface of {} triangles", state.surface.triangles.cols());
  PanelSurface made;
  made.mesh = state.surface;
  made.vertex_values = 1e3 * error;
  made.show_edges = true;
  surface.surfaces.push_back(std::move(made));
  figure.picture.panels = {std::move(cloud), std::move(surface)};

  figure.text = fmt::format(
      "Figure 3: frame {} of the recording\n"
      "points scanned                          {}\n"
      "points removed                          {}\n"
      "surface: vertices, triangles            {}, {}\n"
      "cleaned points to surface, mean / rms   {:.3f} / {:.3f} mm\n"
      "surface to true surface, mean / max     {:.3f} / {:.3f} mm (colours)\n",
      settings.cloud_frame, raw.cloud.Size(), removed.size(), state.surface.vertices.cols(),
      state.surface.triangles.cols(), 1e3 * to_scan.mean, 1e3 * to_scan.rms, 1e3 * to_truth.mean,
      1e3 * to_truth.max);
  figure.numbers = {{"frame", settings.cloud_frame},
                    {"points", raw.cloud.Size()},
                    {"removed", removed.size()},
                    {"vertices", state.surface.vertices.cols()},
                    {"triangles", state.surface.triangles.cols()},
                    {"points_to_surface_mean_m", to_scan.mean},
                    {"points_to_surface_rms_m", to_scan.rms},
                    {"surface_to_truth_mean_m", to_truth.mean},
                    {"surface_to_truth_max_m", to_truth.max}};
  return figure;
}

namespace {

// One mesh of Figure 4: its panel, its line of the table and its numbers.
void AddMesh(const ReferenceBody& body, double ratio, const std::string& volume,
             const nlohmann::json& settings, FigureContent* figure) {
  const CutMesh cut =
      CutOpen(body.mesh, BoundingBox(body.mesh.nodes).center(), -Eigen::Vector3d::UnitY());
  Panel panel;
  panel.title = fmt::format("q = {:g}, {}: {} nodes, {} tetrahedra", ratio, volume,
                            body.mesh.NodeCount(), body.mesh.TetCount());
  for (const bool inner : {false, true}) {
    PanelSurface surface;
    surface.mesh = inner ? cut.inner : cut.skin;
    surface.colour = inner ? kInnerColour : kSkinColour;
    surface.show_edges = true;
    surface.flat = true;
    panel.surfaces.push_back(std::move(surface));
  }
  figure->picture.panels.push_back(std::move(panel));
  const TetQuality shapes = MeasureTets(body.mesh);
  figure->text += fmt::format(
      "{:8.2f}  {:>14}  {:7}  {:6}   {:9.2f}   {:13.2f}   {:16.1f}   {:10.2f}\n", ratio, volume,
      body.mesh.NodeCount(), body.mesh.TetCount(), body.quality.largest_radius_edge_ratio,
      shapes.aspect_ratio.mean, kDeg * body.quality.smallest_angle, 1e3 * body.quality.volume);
  nlohmann::json numbers = settings;
  numbers.update({{"radius_edge_ratio", ratio},
                  {"nodes", body.mesh.NodeCount()},
                  {"tetrahedra", body.mesh.TetCount()},
                  {"largest_radius_edge_ratio", body.quality.largest_radius_edge_ratio},
                  {"mean_aspect_ratio", shapes.aspect_ratio.mean},
                  {"smallest_dihedral_angle_rad", body.quality.smallest_angle},
                  {"volume_m3", body.quality.volume}});
  figure->numbers.push_back(numbers);
}

constexpr const char* kMeshColumns =
    "       q               v    nodes    tets   largest q   mean elongation   least dihedral °   "
    "volume dm³\n";

}  // namespace

FigureContent DrawMeshes(const Table1Study& table1, const Table1Scans& scans,
                         const Table1FigureSettings& settings) {
  FigureContent figure;
  figure.options = SideView(1700, 1150);
  figure.picture.title = "Figure 4: tetrahedral meshes of the first surface, cut open";
  figure.picture.columns = static_cast<int>(settings.max_volumes.size());
  figure.picture.legend = {{kSkinColour, "surface"}, {kInnerColour, "inside"}};
  figure.text = std::string("Figure 4: meshes of the first surface\n") + kMeshColumns;
  const ParameterObjective problem = ProblemOf(table1, scans);
  for (const double ratio : settings.radius_edge_ratios) {
    for (const double volume : settings.max_volumes) {
      SearchedParameters parameters = ReferenceParameters(table1);
      parameters.radius_edge_ratio = ratio;
      parameters.max_volume = volume;
      AddMesh(MakeObjectiveBody(problem, parameters), ratio,
              fmt::format("v = {:g} cm\u00b3", 1e6 * volume), {{"max_volume_m3", volume}}, &figure);
    }
  }
  return figure;
}

FigureContent DrawOwnSurfaceMeshes(const Table1Study& table1, const Table1Scans& scans,
                                   const Table1FigureSettings& settings) {
  const Table1FigureSettings::OwnSurface& own = settings.own_surface;
  FigureContent figure;
  figure.options = SideView(1700, 575 * static_cast<int>((own.radius_edge_ratios.size() + 1) / 2));
  figure.picture.title =
      "Figure 4: meshes of the first surface with its own triangles; only q differs";
  figure.picture.columns = 2;
  figure.picture.legend = {{kSkinColour, "surface"}, {kInnerColour, "inside"}};
  figure.text = fmt::format(
                    "Figure 4, second part: S_0 with its own triangles, which TetGen keeps; "
                    "dihedral angles of at least {:.1f}° where possible\n",
                    kDeg * own.min_dihedral_angle) +
                kMeshColumns;
  ReconstructionStudy study = scans.study;
  study.mesh.tets.min_dihedral_angle = own.min_dihedral_angle;
  study.mesh.tets.preserve_surface = true;
  const ParameterObjective problem{study, scans.states, scans.tracked, /*remesh_surface=*/false};
  for (const double ratio : own.radius_edge_ratios) {
    SearchedParameters parameters = ReferenceParameters(table1);
    parameters.radius_edge_ratio = ratio;
    parameters.max_volume = own.max_volume;
    AddMesh(MakeObjectiveBody(problem, parameters), ratio, "no v",
            {{"max_volume_m3", own.max_volume}, {"own_surface", true}}, &figure);
  }
  return figure;
}

FigureContent DrawBend(const Table1Study& table1, const Table1Scans& scans,
                       const Table1FigureSettings& settings) {
  for (const int frame : settings.bend_frames)
    if (const std::string& failure = scans.tracked.failures[static_cast<size_t>(frame)];
        !failure.empty())
      throw InputError(fmt::format(
          "bend: the registration of frame {} failed ({}), so that its displacement is not known; "
          "choose other frames",
          frame, failure));
  constexpr Eigen::Index kArrows = 90;
  constexpr double kArrowRadius = 0.007;  // share of the body's size
  FigureContent figure;
  figure.options = SideView(1800, 820);
  figure.picture.title =
      "Figure 5: registered displacement (above) and simulation under fitted forces (below)";
  figure.picture.columns = static_cast<int>(settings.bend_frames.size());
  figure.picture.value_name = "shift mm";
  figure.picture.legend = {{kFaintColour, "surface of the scan"}};
  figure.text =
      "Figure 5: displacements from the first frame, mm; distance of the simulated surface from\n"
      "the scan's points, mm\n"
      "frame   time s   registered mean / max    simulated mean / max    distance mean\n";
  const ParameterObjective problem = ProblemOf(table1, scans);
  const SearchedParameters parameters = ReferenceParameters(table1);
  const FollowedMotion motion = FollowOrThrow(problem, parameters);
  const BoundarySurface& boundary = motion.body->boundary;
  const Eigen::Matrix3Xd& at_rest = scans.tracked.points;
  const double size = BoundingBoxDiagonal(at_rest);
  std::vector<Eigen::Index> shown;
  for (Eigen::Index j = 0; j < kArrows; ++j) shown.push_back(j * at_rest.cols() / kArrows);
  std::vector<Panel> registered, simulated;
  for (const int frame : settings.bend_frames) {
    const auto k = static_cast<size_t>(frame);
    const FrameState& state = scans.states[k];
    const Eigen::Matrix3Xd shift = scans.tracked.DisplacementAt(k, at_rest);
    const Eigen::VectorXd length = shift.colwise().norm().transpose();
    Panel above, below;
    above.title = fmt::format("frame {}, {:.2f} s", frame, state.time);
    above.surfaces.push_back(EdgesOf(state.surface, kFaintColour));
    PanelSurface arrows;
    arrows.mesh =
        ArrowMesh(at_rest(Eigen::all, shown), shift(Eigen::all, shown), kArrowRadius * size);
    arrows.vertex_values.resize(arrows.mesh.vertices.cols());
    for (size_t j = 0; j < shown.size(); ++j)
      arrows.vertex_values.segment(static_cast<Eigen::Index>(j) * kArrowVertices, kArrowVertices)
          .setConstant(1e3 * length[shown[j]]);
    above.surfaces.push_back(std::move(arrows));
    registered.push_back(std::move(above));

    PanelSurface body;
    body.mesh = BoundaryAt(boundary, motion.frames[k].position);
    const Eigen::VectorXd moved =
        (body.mesh.vertices - boundary.surface.vertices).colwise().norm().transpose();
    const double distance = DistanceToSurface(body.mesh, state.cloud.points).mean;
    body.vertex_values = 1e3 * moved;
    body.show_edges = true;
    below.surfaces.push_back(std::move(body));
    simulated.push_back(std::move(below));
    figure.text +=
        fmt::format("{:5}   {:6.3f}   {:8.1f} / {:8.1f}      {:8.1f} / {:8.1f}    {:9.2f}\n", frame,
                    state.time, 1e3 * length.mean(), 1e3 * length.maxCoeff(), 1e3 * moved.mean(),
                    1e3 * moved.maxCoeff(), 1e3 * distance);
    figure.numbers.push_back({{"frame", frame},
                              {"time_s", state.time},
                              {"registered_mean_m", length.mean()},
                              {"registered_max_m", length.maxCoeff()},
                              {"simulated_mean_m", moved.mean()},
                              {"simulated_max_m", moved.maxCoeff()},
                              {"points_to_simulation_mean_m", distance}});
  }
  figure.picture.panels = std::move(registered);
  for (Panel& panel : simulated) figure.picture.panels.push_back(std::move(panel));
  return figure;
}

FigureContent DrawAlignment(const Table1Study& table1, const Table1Scans& scans,
                            const Table1FigureSettings& settings,
                            const std::filesystem::path& results) {
  const std::vector<Optimum> optima = ReadOptima(table1, results);
  FigureContent figure;
  figure.options = SideView(1800, 900);
  figure.picture.title = "Figure 6: the optima of Table 1 over the scan's surface";
  figure.picture.columns = static_cast<int>(optima.size());
  figure.picture.value_name = "distance mm";
  figure.picture.legend = {{kScanColour, "surface of the scan"}};
  figure.text =
      "Figure 6: the searches' optima; distance of the simulated surface from the scan's, mm\n"
      "search          q     v cm³    y kPa      p   nodes   D mm (in the table)";
  for (const int frame : settings.alignment_frames)
    figure.text += fmt::format("   frame {:2}: mean /   max", frame);
  figure.text += "\n";
  std::vector<std::vector<Panel>> rows(settings.alignment_frames.size());
  for (const Optimum& optimum : optima) {
    const ParameterObjective problem = ProblemOf(table1, scans);
    const SearchedParameters& p = optimum.parameters;
    const FollowedMotion motion = FollowOrThrow(problem, p);
    const ObjectiveEvaluation again = MeasureObjective(problem, motion);
    figure.text += fmt::format(
        "{:12} {:5.3f}  {:8.1f}  {:7.1f}  {:5.3f}  {:6}   {:.4f} ({:.4f})    ", optimum.name,
        p.radius_edge_ratio, 1e6 * p.max_volume, 1e-3 * p.young_modulus, p.poisson_ratio,
        motion.body->NodeCount(), 1e3 * again.residual_per_point, 1e3 * optimum.residual_per_point);
    nlohmann::json entry{{"search", optimum.name},
                         {"parameters", ToJson(p)},
                         {"residual_per_point_m", again.residual_per_point},
                         {"residual_per_point_in_table_m", optimum.residual_per_point}};
    for (size_t row = 0; row < rows.size(); ++row) {
      const int frame = settings.alignment_frames[row];
      const FrameState& state = scans.states[static_cast<size_t>(frame)];
      PanelSurface body;
      body.mesh =
          BoundaryAt(motion.body->boundary, motion.frames[static_cast<size_t>(frame)].position);
      body.vertex_values = 1e3 * SurfaceSearch(state.surface).Nearest(body.mesh.vertices).distance;
      const double mean = body.vertex_values.mean(), largest = body.vertex_values.maxCoeff();
      Panel panel;
      panel.title = fmt::format("{}, frame {}: mean {:.1f} mm", optimum.name, frame, mean);
      panel.surfaces.push_back(std::move(body));
      panel.surfaces.push_back(EdgesOf(state.surface, kScanColour));
      rows[row].push_back(std::move(panel));
      figure.text += fmt::format("         {:6.2f} / {:5.2f}", mean, largest);
      entry["distances"].push_back(
          {{"frame", frame}, {"mean_m", 1e-3 * mean}, {"max_m", 1e-3 * largest}});
    }
    figure.text += "\n";
    figure.numbers.push_back(entry);
  }
  for (std::vector<Panel>& row : rows)
    for (Panel& panel : row) figure.picture.panels.push_back(std::move(panel));
  return figure;
}

PictureResult WriteFigure(const FigureContent& figure, const std::string& name,
                          const std::filesystem::path& folder) {
  WriteFileAtomically(folder / (name + ".txt"), figure.text);
  WriteFileAtomically(folder / (name + ".json"), figure.numbers.dump(2) + "\n");
  return RenderPanelPng(folder / (name + ".png"), figure.picture, figure.options);
}

}  // namespace lacuna
