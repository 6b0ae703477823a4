#include "scan/displacement_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/letter_case.h"
#include "scan/column_name.h"
#include "scan/column_units.h"

namespace lacuna {
namespace {

using Names = std::array<const char*, 3>;

// Names of the places and of the displacements; those of programs before the common ones.
struct KnownNames {
  Names place, displacement;
};
constexpr KnownNames kKnown[] = {
    {{"model_coordinates_x", "model_coordinates_y", "model_coordinates_z"},
     {"model_displacement_x", "model_displacement_y", "model_displacement_z"}},
    {{"x_undef", "y_undef", "z_undef"}, {"u", "v", "w"}},
    {{"x_undf", "y_undf", "z_undf"}, {"ux", "uy", "uz"}},
    {{"coor.X", "coor.Y", "coor.Z"},
     {"disp.Horizontal Displacement U", "disp.Vertical Displacement V", "disp.Out-Of-Plane: W"}},
    {{"X", "Y", "Z"}, {"U", "V", "W"}},
    {{"x", "y", "z"}, {"u", "v", "w"}},
    {{"x", "y", "z"}, {"displacement_x", "displacement_y", "displacement_z"}}};
// The displacements beside which places are those of the deformed state.
constexpr const char* kBesideDeformed = "displacement_x";
// Names that a table of displacements in the plane has, and of the component that it lacks.
constexpr Names kInPlane[] = {
    {"displacement_x", "displacement_y", "displacement_z"},
    {"disp.Horizontal Displacement U", "disp.Vertical Displacement V", "disp.Out-Of-Plane: W"}};
// The status flags of DICe of a correlation that has succeeded.
const std::set<double> kSucceeded = {0, 1, 2, 3, 4, 6, 15, 18, 26};
constexpr const char* kStatusOfDice = "status_flag";

// The column of this name, in any case where there is only one.
std::optional<Eigen::Index> Find(const std::vector<std::string>& header, const std::string& name) {
  std::optional<Eigen::Index> similar;
  for (size_t k = 0; k < header.size(); ++k) {
    const std::string other = SplitColumnName(header[k]).name;
    if (other == name) return static_cast<Eigen::Index>(k);
    if (InLowerCase(other) != InLowerCase(name)) continue;
    if (similar) return std::nullopt;
    similar = static_cast<Eigen::Index>(k);
  }
  return similar;
}

std::optional<std::array<Eigen::Index, 3>> FindAll(const std::vector<std::string>& header,
                                                   const Names& names) {
  std::array<Eigen::Index, 3> columns{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::optional<Eigen::Index> column = Find(header, names[axis]);
    if (!column) return std::nullopt;
    columns[axis] = *column;
  }
  return columns;
}

// Throws where another column has the same name, be it in another unit.
void RefuseTwins(const DelimitedTable& table, const std::vector<std::string>& header,
                 Eigen::Index column) {
  const size_t own = static_cast<size_t>(column);
  for (size_t k = 0; k < header.size(); ++k)
    if (k != own && SplitColumnName(header[k]).name == SplitColumnName(header[own]).name)
      throw InputError({table.file.string()},
                       fmt::format("has the columns \"{}\" and \"{}\", of which the numbers are {} "
                                   "and {}; rename one of them, or name the columns with `columns`",
                                   header[own], header[k], own + 1, k + 1));
}

// Takes the columns of known names that give the quality and the number of a point, where `columns`
// has none.
void AddKnownColumns(const DelimitedTable& table, const std::vector<std::string>& header,
                     DisplacementColumns* columns) {
  const auto add = [&](const char* name, std::optional<Eigen::Index>* column) {
    if (*column) return;
    *column = Find(header, name);
    if (*column) RefuseTwins(table, header, **column);
  };
  add("sigma", &columns->sigma);
  add(kStatusOfDice, &columns->status);
  add("returnstatus", &columns->status);
  add("subset_id", &columns->id);
}

// Whether a status says that the correlation of a point has failed. One that is missing is NaN,
// which the set would take for equal to any of its numbers.
bool HasFailed(double status, bool is_of_dice) {
  if (std::isnan(status)) return true;
  return is_of_dice ? kSucceeded.count(status) == 0 : status < 0;
}

std::optional<DisplacementColumns> FindIn(const DelimitedTable& table,
                                          const std::vector<std::string>& header) {
  for (const KnownNames& known : kKnown) {
    const auto place = FindAll(header, known.place);
    const auto displacement = FindAll(header, known.displacement);
    if (!place || !displacement) continue;
    DisplacementColumns columns;
    columns.place = *place;
    columns.displacement = *displacement;
    AddKnownColumns(table, header, &columns);
    // ARAMIS writes "ID", and older exports "ID,ID".
    for (const char* name : {"id", "id,id", "index"})
      if (!columns.id) columns.id = Find(header, name);
    for (const auto& part : {columns.place, columns.displacement})
      for (const Eigen::Index k : part) RefuseTwins(table, header, k);
    if (columns.id) RefuseTwins(table, header, *columns.id);
    columns.has_common_names = InLowerCase(known.displacement[0]) == "u" &&
                               InLowerCase(known.place[0]) == "x" && !columns.sigma;
    columns.places_are_deformed = std::string(known.displacement[0]) == kBesideDeformed;
    return columns;
  }
  for (const auto& [x, y, z] : kInPlane)
    if (Find(header, x) && Find(header, y) && !Find(header, z))
      throw InputError(
          {table.file.string()},
          fmt::format("gives displacements in the image plane only (\"{}\" and \"{}\"); a "
                      "recording needs three components, as stereo correlation measures them",
                      header[static_cast<size_t>(*Find(header, x))],
                      header[static_cast<size_t>(*Find(header, y))]));
  return std::nullopt;
}

}  // namespace

std::optional<DisplacementColumns> FindDisplacementColumns(DelimitedTable* table) {
  const bool has_header = !table->header.empty();
  std::optional<DisplacementColumns> columns =
      FindIn(*table, has_header ? table->header : table->commented_header);
  if (!columns) return std::nullopt;
  if (!has_header) table->header = table->commented_header;
  columns->length_unit = LengthUnitOf(*table, *columns);
  return columns;
}

void AddKnownColumns(const DelimitedTable& table, DisplacementColumns* columns) {
  AddKnownColumns(table, table.header, columns);
}

std::string LengthUnitOf(const DelimitedTable& table, const DisplacementColumns& columns) {
  std::string unit;
  for (const auto& part : {columns.place, columns.displacement})
    for (const Eigen::Index k : part) {
      const std::string own = UnitOfColumn(table, k);
      if (unit.empty()) unit = own;
      if (own.empty() || own == unit) continue;
      throw InputError({table.file.string()},
                       fmt::format("gives \"{}\" beside columns in {}; places and displacements "
                                   "must have one unit",
                                   table.header[static_cast<size_t>(k)], unit));
    }
  if (!unit.empty()) return unit;
  // GOM: "Units: length:mm angle:deg time:s".
  for (const std::string& comment : table.comments) {
    const size_t at = comment.rfind("Units:", 0) == 0 ? comment.find("length:") : std::string::npos;
    if (at == std::string::npos) continue;
    const size_t from = at + std::string("length:").size();
    return comment.substr(from, comment.find(' ', from) - from);
  }
  return unit;
}

Eigen::Matrix3Xd PointsOf(const DelimitedTable& table, const std::array<Eigen::Index, 3>& columns) {
  Eigen::Matrix3Xd points(3, table.values.rows());
  for (int axis = 0; axis < 3; ++axis)
    points.row(axis) = table.values.col(columns[static_cast<size_t>(axis)]).transpose();
  return points;
}

Eigen::Matrix3Xd MovedPoints(const DelimitedTable& table, const DisplacementColumns& columns) {
  const Eigen::MatrixXd& values = table.values;
  const Eigen::Index rows = values.rows();
  const Eigen::Matrix3Xd places = PointsOf(table, columns.place);
  const Eigen::Matrix3Xd displacements = PointsOf(table, columns.displacement);
  const auto is_zero = (places.array() == 0 && displacements.array() == 0).colwise().all().eval();
  const bool forgets_zeros = is_zero.count() > 1;
  Eigen::Matrix3Xd points = places;
  if (!columns.places_are_deformed) points += displacements;
  const bool is_of_dice =
      columns.status && !table.header.empty() &&
      InLowerCase(SplitColumnName(table.header[static_cast<size_t>(*columns.status)]).name) ==
          kStatusOfDice;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const bool has_failed = (columns.sigma && !(values(i, *columns.sigma) >= 0)) ||
                            (columns.status && HasFailed(values(i, *columns.status), is_of_dice)) ||
                            (forgets_zeros && is_zero[i]);
    if (has_failed) points.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return points;
}

Eigen::VectorXd SigmaOf(const DelimitedTable& table, const DisplacementColumns& columns) {
  return columns.sigma ? Eigen::VectorXd(table.values.col(*columns.sigma)) : Eigen::VectorXd();
}

}  // namespace lacuna
