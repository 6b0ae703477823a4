#include "meshing/tetrahedralize.h"

#include <fmt/format.h>
#include <glog/logging.h>
#define TETLIBRARY
#include <tetgen.h>

#include <cmath>
#include <mutex>
#include <new>
#include <numbers>
#include <string>
#include <vector>

#include "core/memory_limit.h"
#include "core/process_random.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// The error codes that TetGen 1.5 throws.
constexpr int kTetGenOutOfMemory = 1;
constexpr int kTetGenSelfIntersection = 3;
constexpr int kTetGenSmallFeature = 4;
constexpr int kTetGenCloseFacets = 5;

// TetGen merges vertices that are closer than its tolerance times the object's size, and may crash
// on the resulting surface. Such surfaces are therefore refused.
constexpr double kTetGenTolerance = 1e-10;
constexpr double kClosestVertices = 10 * kTetGenTolerance;

// TetGen treats facets that meet at more than this angle (degrees) as one flat facet. Its default
// of 179.9 would change the surface of a body with many triangles noticeably.
constexpr double kFlatAngle = 179.9999;

// The most tetrahedra that may be requested. With about 1 kB per tetrahedron for meshing and
// simulation, more would not fit into the memory of a workstation. The limit is the same on every
// machine, so that it may count as a failure of the mesh.
constexpr double kMostTets = 2e7;
// What TetGen occupies for each tetrahedron of the least number, volume over max_volume: a block of
// 0.65 million tetrahedra, twice the least number, took 0.26 GB.
constexpr double kBytesPerTet = 800;

// The relative deviation of the tetrahedra's total volume from that of the surface above which the
// mesh is refused.
constexpr double kVolumeTolerance = 1e-7;

// TetGen works on the surface moved to the origin and scaled to size 1, because some of its
// thresholds are absolute.
struct UnitFrame {
  Eigen::Vector3d centre;
  double size;
};

UnitFrame FrameOf(const TriMesh& surface) {
  const Eigen::AlignedBox3d box = BoundingBox(surface.vertices);
  return {box.center(), box.sizes().maxCoeff()};
}

// TetGen's input made from a surface. TetGen's destructor would free the vertex list of each
// polygon; here the lists are columns of one matrix, so the pointers are reset before it runs.
class Facets {
 public:
  Facets(const TriMesh& surface, const UnitFrame& frame)
      : triangles_(surface.triangles), polygons_(triangles_.cols()), facets_(triangles_.cols()) {
    points_ = (surface.vertices.colwise() - frame.centre) / frame.size;
    for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
      polygons_[t].vertexlist = triangles_.col(t).data();
      polygons_[t].numberofvertices = 3;
      facets_[t] = {&polygons_[t], 1, nullptr, 0};
    }
    input_.firstnumber = 0;
    input_.pointlist = points_.data();
    input_.numberofpoints = static_cast<int>(points_.cols());
    input_.facetlist = facets_.data();
    input_.numberoffacets = static_cast<int>(facets_.size());
  }
  ~Facets() { input_.initialize(); }
  Facets(const Facets&) = delete;
  Facets& operator=(const Facets&) = delete;

  tetgenio* Input() { return &input_; }

 private:
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xi triangles_;
  std::vector<tetgenio::polygon> polygons_;
  std::vector<tetgenio::facet> facets_;
  tetgenio input_;
};

tetgenbehavior Behaviour(const TetOptions& options, double size) {
  std::string switches = fmt::format("pzQq{:.17g}/{:.17g}", options.radius_edge_ratio,
                                     options.min_dihedral_angle * 180 / std::numbers::pi);
  if (options.max_volume > 0) {
    switches += fmt::format("a{:.17g}", options.max_volume / std::pow(size, 3));
  }
  if (options.preserve_surface) switches += "Y";
  switches += fmt::format("T{:.17g}S{}", kTetGenTolerance, options.max_added_nodes);
  tetgenbehavior behaviour;
  CHECK(behaviour.parse_commandline(switches.data())) << switches;
  behaviour.facet_ang_tol = kFlatAngle;
  return behaviour;
}

TetMesh FromTetGen(const tetgenio& output, const UnitFrame& frame) {
  TetMesh mesh;
  const Eigen::Map<const Eigen::Matrix3Xd> points(output.pointlist, 3, output.numberofpoints);
  mesh.nodes = (frame.size * points).colwise() + frame.centre;
  mesh.tets = Eigen::Map<const Eigen::MatrixXi>(output.tetrahedronlist, output.numberofcorners,
                                                output.numberoftetrahedra);
  return mesh;
}

// The fraction of tetrahedra above a bound that deserves a note. TetGen's final smoothing usually
// leaves a few in a thousand.
constexpr double kWorthANote = 0.005;

void NoteUnmetBounds(const TetOptions& options, MeshResult& result) {
  const TetQuality& quality = result.quality;
  const auto many = [&](Eigen::Index count) {
    return static_cast<double>(count) > kWorthANote * static_cast<double>(quality.tets);
  };
  const char* why = options.preserve_surface ? "the surface is kept and too coarse or uneven for it"
                                             : "the surface's edges meet at sharp angles";
  if (many(quality.above_volume)) {
    result.notes.push_back(fmt::format(
        "{} of {} tetrahedra are larger than {:.4g} m^3, the largest by a factor of {:.3g}: {}",
        quality.above_volume, quality.tets, options.max_volume,
        quality.volume.max / options.max_volume, why));
  }
  if (many(quality.above_ratio)) {
    result.notes.push_back(
        fmt::format("{} of {} tetrahedra have a radius-edge ratio above {:.4g}, at most {:.3g}: {}",
                    quality.above_ratio, quality.tets, options.radius_edge_ratio,
                    quality.radius_edge_ratio.max, why));
  }
}

// A mesh deserves a note if it has at least kFewTets tetrahedra and kManyMore times as many as
// max_volume requires, because simulations take correspondingly longer.
constexpr double kManyMore = 10;
constexpr Eigen::Index kFewTets = 2000;

// With fewer triangles, relative to the tetrahedra, it is not the surface that makes them small.
constexpr Eigen::Index kTetsPerTriangle = 20;

void NoteManyTets(const TriMesh& surface, const TetOptions& options, MeshResult& result) {
  if (options.max_volume == 0) return;
  const double asked = result.quality.total_volume / options.max_volume;
  const Eigen::Index tets = result.quality.tets;
  if (tets < kFewTets || static_cast<double>(tets) < kManyMore * asked) return;
  const std::string alone = fmt::format("max_volume {:.4g} m^3 alone would need about {:.0f}",
                                        options.max_volume, std::max(1.0, asked));
  if (tets > kTetsPerTriangle * surface.triangles.cols())
    result.notes.push_back(fmt::format(
        "the mesh has {} tetrahedra because the body is thin, and elements of the required shape "
        "are as wide as it is thick; {}. `radius_edge_ratio: 3` and `min_dihedral_angle: 0` allow "
        "flatter ones",
        tets, alone));
  else
    result.notes.push_back(
        fmt::format("the mesh has {} tetrahedra because it must match the surface's {} triangles; "
                    "{}, so a coarser surface would make a faster model",
                    tets, surface.triangles.cols(), alone));
}

// What to do where one component lies within another.
constexpr const char* kGiveTets =
    "; a body with a cavity cannot be meshed from its surfaces: give its tetrahedra (`from: "
    "tet_mesh`)";

void Fail(MeshStatus status, const std::string& message, MeshResult& result) {
  result.status = status;
  result.message = message;
}

// A message with the location of two vertices that are too close for TetGen; empty if there are
// none.
std::string TooCloseVertices(const TriMesh& surface, double size) {
  const Eigen::VectorXd gap =
      PointSearch(surface.vertices).Nearest(surface.vertices, 2).distance.row(1);
  Eigen::Index closest;
  if (gap.minCoeff(&closest) > kClosestVertices * size) return "";
  const Eigen::Vector3d place = surface.vertices.col(closest);
  return fmt::format(
      "two vertices at ({:.4g}, {:.4g}, {:.4g}) are {:.2g} m apart, too close for an "
      "object of {:.4g} m",
      place.x(), place.y(), place.z(), gap(closest), size);
}

[[noreturn]] void ThrowOutOfMemory() {
  throw OutOfMemory(std::string("TetGen ran out of memory; ") + kCoarserMesh);
}

void FailByCode(int code, MeshResult& result) {
  switch (code) {
    case kTetGenOutOfMemory:
      ThrowOutOfMemory();
    case kTetGenSelfIntersection:
      return Fail(MeshStatus::kFaultySurface, "TetGen found that the surface intersects itself",
                  result);
    case kTetGenSmallFeature:
      return Fail(MeshStatus::kTooSmallFeature,
                  "TetGen found a feature too small against the size of the object", result);
    case kTetGenCloseFacets:
      return Fail(MeshStatus::kTooSmallFeature, "TetGen found two facets that almost touch",
                  result);
    default:
      return Fail(MeshStatus::kInternalError, fmt::format("TetGen failed with error {}", code),
                  result);
  }
}

}  // namespace

MeshResult MeshTetrahedra(const TriMesh& surface, const TetOptions& options) {
  CHECK(options.radius_edge_ratio > 1 && options.max_volume >= 0);
  CHECK(options.min_dihedral_angle >= 0 && options.min_dihedral_angle < std::numbers::pi / 2);
  CHECK_GE(options.max_added_nodes, 0);
  CHECK(options.order == 1 || options.order == 2);
  MeshResult result;
  result.surface_report = CheckSurface(surface);
  if (!result.surface_report.BoundsVolume()) {
    const SurfaceReport& report = result.surface_report;
    const bool may_have_cavity =
        report.components > 1 && report.IsOriented() && !report.inside_out_components.empty();
    Fail(MeshStatus::kFaultySurface,
         "the surface does not bound a volume: " + DescribeFaults(report) +
             (may_have_cavity ? kGiveTets : ""),
         result);
    return result;
  }

  if (result.surface_report.unused_vertices > 0) {
    Fail(MeshStatus::kFaultySurface,
         fmt::format("{} vertices of the surface belong to no triangle",
                     result.surface_report.unused_vertices),
         result);
    return result;
  }
  const UnitFrame frame = FrameOf(surface);
  const std::string too_close = TooCloseVertices(surface, frame.size);
  if (!too_close.empty()) {
    Fail(MeshStatus::kTooSmallFeature, too_close, result);
    return result;
  }

  const double least_tets =
      options.max_volume > 0 ? result.surface_report.volume / options.max_volume : 0;
  if (least_tets > kMostTets) {
    Fail(MeshStatus::kTooManyTets,
         fmt::format(
             "max_volume requires at least {:.0f} million tetrahedra; at most {:.0f} million "
             "are allowed",
             1e-6 * least_tets, 1e-6 * kMostTets),
         result);
    return result;
  }

  RequireMemory(kBytesPerTet * least_tets,
                fmt::format("a mesh of at least {:.2g} million tetrahedra", 1e-6 * least_tets),
                "a larger max_volume needs less");

  // TetGen uses the random numbers of the process, and its geometric predicates keep their
  // constants in global variables.
  const std::lock_guard lock(ProcessRandomMutex());
  Facets facets(surface, frame);
  tetgenio output;
  try {
    tetgenbehavior behaviour = Behaviour(options, frame.size);
    tetrahedralize(&behaviour, facets.Input(), &output);
  } catch (int code) {
    FailByCode(code, result);
    return result;
  } catch (const std::bad_alloc&) {
    ThrowOutOfMemory();
  }
  if (output.numberoftetrahedra == 0) {
    Fail(MeshStatus::kInternalError, "TetGen returned no tetrahedra", result);
    return result;
  }
  result.mesh = FromTetGen(output, frame);
  result.quality = MeasureTets(result.mesh, options.radius_edge_ratio, options.max_volume);
  if (result.quality.inverted > 0) {
    Fail(MeshStatus::kInternalError,
         fmt::format("{} tetrahedra have no volume", result.quality.inverted), result);
    return result;
  }
  const double missing = result.quality.total_volume - result.surface_report.volume;
  if (std::abs(missing) > kVolumeTolerance * result.surface_report.volume) {
    Fail(MeshStatus::kInternalError,
         fmt::format("the tetrahedra fill {:.6g} m^3, but the surface encloses {:.6g} m^3{}",
                     result.quality.total_volume, result.surface_report.volume,
                     result.surface_report.components > 1
                         ? ", as where one component lies within another"
                         : ""),
         result);
    return result;
  }
  NoteUnmetBounds(options, result);
  NoteManyTets(surface, options, result);
  if (options.order == 2) result.mesh = ToQuadratic(result.mesh);
  result.quality.nodes = result.mesh.NodeCount();
  result.status = MeshStatus::kUsable;
  result.message.clear();
  return result;
}

}  // namespace lacuna
