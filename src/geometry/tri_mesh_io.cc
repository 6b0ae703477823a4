#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>
#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <functional>
#include <map>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/text_scanner.h"

namespace lacuna {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

struct Soup {
  std::vector<Point> points;
  std::vector<std::vector<size_t>> polygons;
};
using Reader = std::function<bool(std::istream&, Soup&)>;

const std::map<std::string, Reader>& Readers() {
  static const std::map<std::string, Reader> readers{
      {".ply",
       [](std::istream& in, Soup& s) { return CGAL::IO::read_PLY(in, s.points, s.polygons); }},
      {".obj",
       [](std::istream& in, Soup& s) { return CGAL::IO::read_OBJ(in, s.points, s.polygons); }},
      {".stl",
       [](std::istream& in, Soup& s) { return CGAL::IO::read_STL(in, s.points, s.polygons); }},
      {".off",
       [](std::istream& in, Soup& s) { return CGAL::IO::read_OFF(in, s.points, s.polygons); }}};
  return readers;
}

Soup ReadSoup(const std::filesystem::path& file) {
  const auto reader = Readers().find(LowerExtension(file));
  if (reader == Readers().end()) {
    throw InputError({file.string()},
                     fmt::format("\"{}\" is not a format of triangle meshes; expected .ply, .obj, "
                                 ".stl or .off",
                                 file.extension().string()));
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError({file.string()}, "cannot be opened");
  Soup soup;
  if (!reader->second(stream, soup) || soup.polygons.empty()) {
    throw InputError({file.string()},
                     fmt::format("is damaged or truncated: reading ended after {} vertices and {} "
                                 "faces",
                                 soup.points.size(), soup.polygons.size()));
  }
  return soup;
}

Eigen::Matrix3Xd FiniteVertices(const std::filesystem::path& file, const Soup& soup) {
  Eigen::Matrix3Xd vertices(3, soup.points.size());
  for (size_t v = 0; v < soup.points.size(); ++v) {
    vertices.col(v) << soup.points[v].x(), soup.points[v].y(), soup.points[v].z();
    if (!vertices.col(v).allFinite()) {
      throw InputError({file.string()},
                       fmt::format("vertex {} of {} is not finite", v + 1, soup.points.size()));
    }
  }
  return vertices;
}

// Cuts each polygon into a fan of triangles around its first corner.
Eigen::Matrix3Xi Triangles(const std::filesystem::path& file, const Soup& soup,
                           std::vector<std::string>& notes) {
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
    for (size_t k = 1; k + 1 < polygon.size(); ++k) {
      for (const size_t v : {polygon[0], polygon[k], polygon[k + 1]}) {
        corners.push_back(static_cast<int>(v));
      }
    }
  }
  if (larger > 0) notes.push_back(fmt::format("cut {} polygons into triangles", larger));
  return Eigen::Map<const Eigen::Matrix3Xi>(corners.data(), 3, corners.size() / 3);
}

template <typename T>
void AppendBytes(const T& value, std::string& bytes) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace

TriMeshFile ReadTriMesh(const std::filesystem::path& file) {
  const Soup soup = ReadSoup(file);
  TriMeshFile result;
  result.mesh.vertices = FiniteVertices(file, soup);
  result.mesh.triangles = Triangles(file, soup, result.notes);
  return result;
}

void WriteTriMesh(const std::filesystem::path& ply, const TriMesh& mesh) {
  std::string content = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.vertices.cols(), mesh.triangles.cols());
  for (const double coordinate : mesh.vertices.reshaped()) AppendBytes(coordinate, content);
  for (const auto triangle : mesh.triangles.colwise()) {
    AppendBytes(static_cast<unsigned char>(3), content);
    for (const int v : triangle) AppendBytes(static_cast<int32_t>(v), content);
  }
  WriteFileAtomically(ply, content);
}

}  // namespace lacuna
