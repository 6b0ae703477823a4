#include "meshing/tetrahedralize.h"

#include <fmt/format.h>
#include <glog/logging.h>
#define TETLIBRARY
#include <tetgen.h>

#include <cmath>
#include <mutex>
#include <new>
#include <numbers>
#include <vector>

namespace lacuna {
namespace {

// What TetGen 1.5 throws.
constexpr int kTetGenOutOfMemory = 1;
constexpr int kTetGenSelfIntersection = 3;
constexpr int kTetGenSmallFeature = 4;
constexpr int kTetGenCloseFacets = 5;

// TetGen's tolerances are relative to the bounding box, but its number formats and some of its
// thresholds are not: it works on the surface moved to the origin and scaled to size 1.
struct UnitFrame {
  Eigen::Vector3d centre;
  double size;
};

UnitFrame FrameOf(const TriMesh& surface) {
  const Eigen::AlignedBox3d box = BoundingBox(surface.vertices);
  return {box.center(), box.sizes().maxCoeff()};
}

// TetGen's polygons point into arrays that its destructor would free one by one; here they are
// columns of `triangles`, so the pointers are taken back before it runs.
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

std::string Switches(const TetOptions& options, double size) {
  std::string switches = fmt::format("pzQq{:.17g}/{:.17g}", options.radius_edge_ratio,
                                     options.min_dihedral_angle * 180 / std::numbers::pi);
  if (options.max_volume > 0)
    switches += fmt::format("a{:.17g}", options.max_volume / std::pow(size, 3));
  if (options.preserve_surface) switches += "Y";
  return switches + fmt::format("S{}", options.max_added_nodes);
}

TetMesh FromTetGen(const tetgenio& output, const UnitFrame& frame) {
  TetMesh mesh;
  const Eigen::Map<const Eigen::Matrix3Xd> points(output.pointlist, 3, output.numberofpoints);
  mesh.nodes = (frame.size * points).colwise() + frame.centre;
  mesh.tets = Eigen::Map<const Eigen::MatrixXi>(output.tetrahedronlist, output.numberofcorners,
                                                output.numberoftetrahedra);
  return mesh;
}

// A few tetrahedra in a thousand above a bound are what TetGen's last smoothing leaves.
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
        "{} of {} tetrahedra are larger than {:.4g} m^3, the largest by {:.3g} times: {}",
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

void Fail(MeshStatus status, const std::string& message, MeshResult& result) {
  result.status = status;
  result.message = message;
}

void FailByCode(int code, MeshResult& result) {
  switch (code) {
    case kTetGenOutOfMemory:
      return Fail(MeshStatus::kOutOfMemory, "TetGen ran out of memory", result);
    case kTetGenSelfIntersection:
      return Fail(MeshStatus::kFaultySurface, "TetGen found that the surface cuts itself", result);
    case kTetGenSmallFeature:
      return Fail(MeshStatus::kTooSmallFeature,
                  "TetGen found a feature too small against the size of the object", result);
    case kTetGenCloseFacets:
      return Fail(MeshStatus::kTooSmallFeature, "TetGen found two facets that all but touch",
                  result);
    default:
      return Fail(MeshStatus::kInternalError, fmt::format("TetGen gave up with its error {}", code),
                  result);
  }
}

}  // namespace

MeshResult MeshTetrahedra(const TriMesh& surface, const TetOptions& options) {
  CHECK(options.radius_edge_ratio > 1 && options.max_volume >= 0);
  CHECK(options.order == 1 || options.order == 2);
  MeshResult result;
  result.surface_report = CheckSurface(surface);
  if (!result.surface_report.BoundsVolume()) {
    Fail(MeshStatus::kFaultySurface,
         "the surface does not bound a volume: " + DescribeFaults(result.surface_report), result);
    return result;
  }

  // The predicates of TetGen keep their constants in variables of the whole process.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const UnitFrame frame = FrameOf(surface);
  Facets facets(surface, frame);
  tetgenio output;
  try {
    tetrahedralize(Switches(options, frame.size).data(), facets.Input(), &output);
  } catch (int code) {
    FailByCode(code, result);
    return result;
  } catch (const std::bad_alloc&) {
    FailByCode(kTetGenOutOfMemory, result);
    return result;
  }
  if (output.numberoftetrahedra == 0) {
    Fail(MeshStatus::kInternalError, "TetGen made no tetrahedra", result);
    return result;
  }
  result.mesh = FromTetGen(output, frame);
  result.quality = MeasureTets(result.mesh, options.radius_edge_ratio, options.max_volume);
  if (result.quality.inverted > 0) {
    Fail(MeshStatus::kInternalError,
         fmt::format("{} tetrahedra have no volume", result.quality.inverted), result);
    return result;
  }
  NoteUnmetBounds(options, result);
  if (options.order == 2) result.mesh = ToQuadratic(result.mesh);
  result.quality.nodes = result.mesh.NodeCount();
  result.status = MeshStatus::kUsable;
  result.message.clear();
  return result;
}

}  // namespace lacuna
