#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <array>
#include <bit>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text_file.h"
#include "geometry/mended_surface.h"
#include "geometry/mesh_io.h"
#include "geometry/ply_header.h"
#include "geometry/polygon_soup.h"
#include "geometry/polygon_triangles.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

PolygonSoup ReadPly(const std::filesystem::path& file) {
  std::string content = ReadWholeFile(file);
  const PlyHeader header = ReadPlyHeader(file, content);
  CheckPlyBody(file, content, header);
  if (const PlyElement* vertices = header.Find("vertex")) {
    for (const char* name : {"x", "y", "z"}) {
      const PlyProperty* coordinate = FindProperty(*vertices, name);
      if (coordinate == nullptr)
        throw InputError({file.string()},
                         fmt::format("its vertices have no property \"{}\"", name));
      if (coordinate->is_list || !coordinate->is_floating)
        throw InputError({file.string()},
                         fmt::format("holds \"{}\" not as floating-point numbers", name));
    }
  }
  std::istringstream stream(std::move(content));
  std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
  PolygonSoup soup;
  const bool is_whole = CGAL::IO::read_PLY(stream, points, soup.polygons);
  if (!is_whole && (points.empty() || !soup.polygons.empty() || stream.fail())) {
    throw InputError({file.string()},
                     fmt::format("is damaged or truncated, or has properties that are not read: "
                                 "reading ended after {} vertices and {} faces",
                                 points.size(), soup.polygons.size()));
  }
  for (const auto& point : points) soup.points.emplace_back(point.x(), point.y(), point.z());
  return soup;
}

PolygonSoup ReadSoup(const std::filesystem::path& file) {
  using Reader = PolygonSoup (*)(const std::filesystem::path&);
  static const std::map<std::string, Reader> readers{
      {".ply", &ReadPly}, {".obj", &ReadObj}, {".stl", &ReadStl}, {".off", &ReadOff}};
  const auto reader = readers.find(LowerExtension(file));
  if (reader == readers.end()) {
    throw InputError({file.string()},
                     fmt::format("\"{}\" is not a format of triangle meshes; expected .ply, .obj, "
                                 ".stl or .off",
                                 file.extension().string()));
  }
  PolygonSoup soup = reader->second(file);
  if (soup.polygons.empty()) {
    throw InputError(
        {file.string()},
        fmt::format("holds {} vertices and 0 faces; expected a surface{}", soup.points.size(),
                    soup.points.empty() ? "" : " (points alone are kind: points)"));
  }
  return soup;
}

// Products of three distances between coordinates beyond the limit could overflow.
Eigen::Matrix3Xd FiniteVertices(const std::filesystem::path& file, const PolygonSoup& soup) {
  Eigen::Matrix3Xd vertices(3, soup.points.size());
  for (size_t v = 0; v < soup.points.size(); ++v) {
    vertices.col(v) = soup.points[v];
    if (vertices.col(v).allFinite() && vertices.col(v).cwiseAbs().maxCoeff() <= kFarthestCoordinate)
      continue;
    throw InputError({file.string()}, fmt::format("vertex {} of {} {}", v + 1, soup.points.size(),
                                                  vertices.col(v).allFinite()
                                                      ? fmt::format("has a coordinate beyond {}",
                                                                    kFarthestCoordinate)
                                                      : "is not finite"));
  }
  return vertices;
}

// Cutting a polygon takes a time that grows with the square of the number of its corners.
constexpr size_t kMostCorners = 10'000;

// Cuts each polygon into triangles.
Eigen::Matrix3Xi TrianglesOf(const std::filesystem::path& file, const PolygonSoup& soup,
                             std::vector<std::string>* notes) {
  std::vector<int> corners;
  size_t larger = 0;
  for (size_t f = 0; f < soup.polygons.size(); ++f) {
    const std::vector<size_t>& polygon = soup.polygons[f];
    const auto fail = [&](const std::string& what) {
      throw InputError({file.string()},
                       fmt::format("face {} of {} {}", f + 1, soup.polygons.size(), what));
    };
    if (polygon.size() < 3) fail(fmt::format("has {} corners", polygon.size()));
    for (const size_t v : polygon) {
      if (v >= soup.points.size()) {
        fail(fmt::format("refers to vertex {}, but there are {}, counted from 0",
                         static_cast<std::ptrdiff_t>(v), soup.points.size()));
      }
    }
    larger += polygon.size() > 3;
    if (polygon.size() > kMostCorners)
      fail(fmt::format("has {} corners; at most {} are read", polygon.size(), kMostCorners));
    Eigen::Matrix3Xd places(3, polygon.size());
    for (size_t k = 0; k < polygon.size(); ++k) places.col(k) = soup.points[polygon[k]];
    for (const std::array<int, 3>& triangle : CutPolygon(places))
      for (const int k : triangle) corners.push_back(static_cast<int>(polygon[k]));
  }
  if (larger > 0) notes->push_back(fmt::format("cut {} polygons into triangles", larger));
  return Eigen::Map<const Eigen::Matrix3Xi>(corners.data(), 3, corners.size() / 3);
}

template <typename T>
void AppendBytes(const T& value, std::string* bytes) {
  static_assert(std::endian::native == std::endian::little);
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

TriMeshFile ReadTriMesh(const std::filesystem::path& file) {
  const PolygonSoup soup = ReadSoup(file);
  TriMeshFile result;
  result.notes = soup.notes;
  const Eigen::Matrix3Xd vertices = FiniteVertices(file, soup);
  const Eigen::Matrix3Xi triangles = TrianglesOf(file, soup, &result.notes);
  MendedSurface mended = MendSurface({vertices, triangles}, LowerExtension(file) == ".stl");
  if (mended.mesh.triangles.cols() == 0)
    throw InputError(
        {file.string()},
        fmt::format("none of its {} faces has three different corners", soup.polygons.size()));
  result.mesh = std::move(mended.mesh);
  result.vertex_in_file = std::move(mended.vertex_in_file);
  result.vertices_in_file = vertices.cols();
  result.is_mended = !mended.notes.empty();
  result.notes.insert(result.notes.end(), mended.notes.begin(), mended.notes.end());
  return result;
}

void WriteTriMesh(const std::filesystem::path& ply, const TriMesh& mesh) {
  std::string content = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.vertices.cols(), mesh.triangles.cols());
  for (const double coordinate : mesh.vertices.reshaped()) AppendBytes(coordinate, &content);
  for (const auto triangle : mesh.triangles.colwise()) {
    AppendBytes(static_cast<unsigned char>(3), &content);
    for (const int v : triangle) AppendBytes(static_cast<int32_t>(v), &content);
  }
  WriteFileAtomically(ply, content);
}

}  // namespace lacuna
