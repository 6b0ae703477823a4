#include "scan/point_file.h"

#include <fmt/format.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "geometry/ply_header.h"
#include "geometry/text_scanner.h"
#include "scan/column_units.h"
#include "scan/delimited_table.h"
#include "scan/displacement_table.h"
#include "scan/pcd_header.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

// Keeps PCL from printing errors, because an exception reports them.
class SilentPcl {
 public:
  SilentPcl() : level_(pcl::console::getVerbosityLevel()) {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  }
  ~SilentPcl() { pcl::console::setVerbosityLevel(level_); }

 private:
  pcl::console::VERBOSITY_LEVEL level_;
};

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& message) {
  throw InputError({file.string()}, message);
}

// PCL would read a word in a text body as 0 or NaN.
void RefuseWords(const std::filesystem::path& file, std::string_view content, size_t body) {
  int line_number = 1 + static_cast<int>(std::count(content.begin(), content.begin() + body, '\n'));
  for (size_t at = body; at < content.size(); ++line_number) {
    const size_t end = std::min(content.find('\n', at), content.size());
    const std::string_view line = content.substr(at, end - at);
    for (const std::string_view field : SplitFields(line, ' ')) {
      if (!ParseNumber(field)) {
        throw InputError(
            {file.string(), line_number, static_cast<int>(field.data() - line.data()) + 1},
            fmt::format("got \"{}\"; expected a number", field));
      }
    }
    at = end + 1;
  }
}

// The readers of PCL give a negative status where a file cannot be read. What PCL would accept
// silently, or with which it would leave its memory, is refused before.

int ReadPly(const std::filesystem::path& file, const std::string& content,
            pcl::PCLPointCloud2* cloud) {
  const PlyHeader header = ReadPlyHeader(file, content);
  if (header.is_text) RefuseWords(file, content, header.body);
  const int status = pcl::PLYReader().read(file.string(), *cloud);
  // PCL takes the size of the image of an element "camera" for that of the cloud. A "range_grid"
  // arranges the points in such an image.
  const PlyElement* vertices = header.Find("vertex");
  if (vertices != nullptr && header.Find("range_grid") == nullptr) {
    cloud->width = static_cast<uint32_t>(vertices->count);
    cloud->height = 1;
  }
  return status;
}

// PCL takes lines at the beginning of the points for further lines of the header, so that it is
// given header and points apart.
int ReadPcd(const std::filesystem::path& file, const std::string& content,
            pcl::PCLPointCloud2* cloud) {
  const PcdHeader header = ReadPcdHeader(file, content);
  if (header.is_text) RefuseWords(file, content, header.body);
  pcl::PCDReader reader;
  std::istringstream head(content.substr(0, header.body));
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, kind = 0;
  unsigned body = 0;
  if (reader.readHeader(head, *cloud, origin, orientation, version, kind, body) < 0) return -1;
  if (header.is_text) {
    std::istringstream points(content.substr(header.body));
    return reader.readBodyASCII(points, *cloud, version);
  }
  constexpr int kCompressed = 2;
  return reader.readBodyBinary(reinterpret_cast<const unsigned char*>(content.data()), *cloud,
                               version, kind == kCompressed, static_cast<unsigned>(header.body));
}

// One coordinate of all points.
Eigen::VectorXd FieldValues(const std::filesystem::path& file, const pcl::PCLPointCloud2& cloud,
                            const pcl::PCLPointField& field) {
  const Eigen::Index count = static_cast<Eigen::Index>(cloud.width) * cloud.height;
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const uint8_t* at = cloud.data.data() + i * cloud.point_step + field.offset;
    if (field.datatype == pcl::PCLPointField::FLOAT64) {
      std::memcpy(&values[i], at, sizeof(double));
    } else if (field.datatype == pcl::PCLPointField::FLOAT32) {
      float value;
      std::memcpy(&value, at, sizeof(float));
      values[i] = value;
    } else {
      Fail(file,
           fmt::format("holds \"{}\" as integers; expected floating-point numbers", field.name));
    }
  }
  return values;
}

Eigen::Matrix3Xd Fields(const std::filesystem::path& file, const pcl::PCLPointCloud2& cloud,
                        const std::array<const char*, 3>& names, bool required) {
  Eigen::Matrix3Xd values(3, static_cast<Eigen::Index>(cloud.width) * cloud.height);
  for (int axis = 0; axis < 3; ++axis) {
    const auto field = std::find_if(cloud.fields.begin(), cloud.fields.end(),
                                    [&](const auto& f) { return f.name == names[axis]; });
    if (field == cloud.fields.end()) {
      if (required) Fail(file, fmt::format("has no field \"{}\"", names[axis]));
      return Eigen::Matrix3Xd(3, 0);
    }
    if (values.cols() == 0) continue;
    values.row(axis) = FieldValues(file, cloud, *field);
  }
  return values;
}

PointCloud ReadWithPcl(const std::filesystem::path& file, bool is_ply) {
  const std::string content = ReadFilledFile(file);
  pcl::PCLPointCloud2 cloud;
  int status = -1;
  try {
    const SilentPcl silent;
    status = is_ply ? ReadPly(file, content, &cloud) : ReadPcd(file, content, &cloud);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& problem) {
    Fail(file, fmt::format("cannot be read: {}", problem.what()));
  }
  const size_t expected = static_cast<size_t>(cloud.width) * cloud.height * cloud.point_step;
  if (status < 0 || cloud.data.size() < expected) {
    Fail(file, fmt::format("is truncated or malformed: its header announces {} points",
                           static_cast<size_t>(cloud.width) * cloud.height));
  }
  return {Fields(file, cloud, {"x", "y", "z"}, true),
          Fields(file, cloud, {"normal_x", "normal_y", "normal_z"}, false)};
}

Eigen::Matrix3Xd Columns(const DelimitedTable& table, const std::array<std::string, 3>& names) {
  Eigen::Matrix3Xd values(3, table.values.rows());
  for (int axis = 0; axis < 3; ++axis) {
    values.row(axis) = table.values.col(RequireColumn(table, names[axis])).transpose();
  }
  return values;
}

bool AreUnitVectors(const Eigen::Matrix3Xd& vectors) {
  constexpr double kRounding = 1e-2;  // rounding of normals with two or three digits
  return ((vectors.colwise().norm().array() - 1).abs() < kRounding).all();
}

// The columns of a table of image correlation that the user or the header names.
std::optional<DisplacementColumns> DisplacementsOf(const PointColumns& columns,
                                                   DelimitedTable* table) {
  if (columns.position[0].empty()) return FindDisplacementColumns(table);
  if (columns.displacement[0].empty()) return std::nullopt;
  DisplacementColumns chosen;
  for (size_t axis = 0; axis < 3; ++axis) {
    chosen.place[axis] = RequireColumn(*table, columns.position[axis]);
    chosen.displacement[axis] = RequireColumn(*table, columns.displacement[axis]);
  }
  chosen.places_are_deformed = columns.positions_are_deformed;
  if (!columns.sigma.empty()) chosen.sigma = RequireColumn(*table, columns.sigma);
  if (!columns.status.empty()) chosen.status = RequireColumn(*table, columns.status);
  AddKnownColumns(*table, &chosen);
  if (!table->header.empty() && !LengthUnitOfColumn(*table, chosen.place[0]).empty() &&
      !LengthUnitOfColumn(*table, chosen.displacement[0]).empty())
    chosen.length_unit = LengthUnitOf(*table, chosen);
  return chosen;
}

}  // namespace

PointCloud PointsOfTable(DelimitedTable table, const PointColumns& columns,
                         std::vector<std::string>* notes, CorrelationTable* correlation) {
  const std::filesystem::path file = table.file;
  PointCloud cloud;
  cloud.normals.resize(3, 0);
  if (auto displacements = DisplacementsOf(columns, &table)) {
    if (!columns.id.empty()) displacements->id = RequireColumn(table, columns.id);
    cloud.points = MovedPoints(table, *displacements);
    if (displacements->has_common_names)
      table.notes.push_back(
          fmt::format("{}: the points are x, y, z plus the displacements u, v, w, as in tables of "
                      "image correlation; `columns` can name others",
                      file.string()));
    if (correlation != nullptr) {
      *correlation = {true,
                      {},
                      displacements->length_unit,
                      SigmaOf(table, *displacements),
                      cloud.points,
                      PointsOf(table, displacements->place),
                      PointsOf(table, displacements->displacement),
                      displacements->places_are_deformed};
      if (displacements->id) {
        const auto ids = table.values.col(*displacements->id);
        correlation->ids.assign(ids.begin(), ids.end());
      }
    }
  }
  if (notes != nullptr) notes->insert(notes->end(), table.notes.begin(), table.notes.end());
  if (cloud.Size() > 0) return cloud;
  if (!columns.position[0].empty()) {
    cloud.points = Columns(table, columns.position);
    if (correlation != nullptr && !table.header.empty()) {
      correlation->length_unit =
          LengthUnitOfColumn(table, RequireColumn(table, columns.position[0]));
    }
    if (!columns.normal[0].empty()) cloud.normals = Columns(table, columns.normal);
    return cloud;
  }
  if (!table.header.empty()) {
    cloud.points = Columns(table, {"x", "y", "z"});
    if (FindColumn(table, "nx")) cloud.normals = Columns(table, {"nx", "ny", "nz"});
    return cloud;
  }
  const Eigen::Matrix3Xd last = table.values.cols() == 6
                                    ? Eigen::Matrix3Xd(table.values.rightCols(3).transpose())
                                    : Eigen::Matrix3Xd(3, 0);
  if (table.values.cols() != 3 && (last.cols() == 0 || !AreUnitVectors(last))) {
    Fail(file, fmt::format("has {} columns and no header; say with `columns` which are x, y, z",
                           table.values.cols()));
  }
  cloud.points = table.values.leftCols(3).transpose();
  cloud.normals = last;
  return cloud;
}

PointCloud ReadPointFile(const std::filesystem::path& file, const PointColumns& columns,
                         std::vector<std::string>* notes, CorrelationTable* correlation) {
  const std::string extension = LowerExtension(file);
  if (extension == ".ply" || extension == ".pcd") return ReadWithPcl(file, extension == ".ply");
  return PointsOfTable(ReadDelimitedTable(file), columns, notes, correlation);
}

CorrelationTable ReadCorrelationTable(const std::filesystem::path& file,
                                      const PointColumns& columns) {
  CorrelationTable correlation;
  const std::string extension = LowerExtension(file);
  if (extension == ".ply" || extension == ".pcd") return correlation;
  try {
    PointsOfTable(ReadDelimitedTable(file), columns, nullptr, &correlation);
  } catch (const InputError&) {
    correlation = {};
  }
  return correlation;
}

void WritePointFile(const std::filesystem::path& file, const PointCloud& cloud) {
  std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n",
      cloud.Size());
  if (cloud.HasNormals()) header += "property double nx\nproperty double ny\nproperty double nz\n";
  header += "end_header\n";
  Eigen::MatrixXd rows(cloud.HasNormals() ? 6 : 3, cloud.Size());
  rows.topRows(3) = cloud.points;
  if (cloud.HasNormals()) rows.bottomRows(3) = cloud.normals;
  header.append(reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(double));
  WriteFileAtomically(file, header);
}

}  // namespace lacuna
