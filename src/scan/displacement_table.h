// Tables of image correlation: the place of each point in the reference state, its displacement
// since, and a measure of its quality. A point of the frame lies at place + displacement. Some
// programs give its place in the deformed state instead.
//
// Recognised by the names of their columns, in any case and with or without a unit in brackets:
//   VIC-3D CSV             X, Y, Z, U, V, W, sigma
//   DICe, stereo           MODEL_COORDINATES_X …, MODEL_DISPLACEMENT_X …, SIGMA, STATUS_FLAG
//   ARAMIS nodemaps        x_undef [mm] …, u [mm], v [mm], w [mm], behind # above the rows; or
//                          x_undf …, ux, uy, uz
//   GOM and ZEISS CSV      x, y, z, displacement_x …; x, y and z are places in the deformed state
//   MatchID CSV            coor.X [mm] …, disp.Horizontal Displacement U [mm],
//                          disp.Vertical Displacement V [mm], disp.Out-Of-Plane: W [mm]
// Where two columns differ in case only (x in pixels beside metric X), the one of exactly this name
// counts.
#ifndef LACUNA_SCAN_DISPLACEMENT_TABLE_H_
#define LACUNA_SCAN_DISPLACEMENT_TABLE_H_

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scan/delimited_table.h"

namespace lacuna {

// Indices of columns, from 0.
struct DisplacementColumns {
  std::array<Eigen::Index, 3> place{}, displacement{};
  bool places_are_deformed = false;  // the places include the displacements already
  // Standard deviation that the program expects of the point, in any unit, e.g. pixels; negative or
  // NaN: the correlation failed.
  std::optional<Eigen::Index> sigma;
  // The status of the correlation: of DICe, where the column is called STATUS_FLAG, one of its
  // numbers; otherwise negative or NaN where it failed.
  std::optional<Eigen::Index> status;
  std::optional<Eigen::Index> id;  // identifies a point in all frames
  std::string length_unit;         // as the header gives it, e.g. "mm"; empty: not given
  // x, y, z, u, v, w without sigma: names that other tables may have, too.
  bool has_common_names = false;
};

// The columns of a table of image correlation, or nothing where no names of displacements are in
// the header. Where the table has no header, but the comment above its first row names such
// columns, that comment becomes the header. Throws InputError, naming the file, when displacements
// are given in the plane only, since the motion out of the plane is then unknown, when places and
// displacements have different units, and when two columns have a name that is used.
std::optional<DisplacementColumns> FindDisplacementColumns(DelimitedTable* table);

// Takes the columns SIGMA, STATUS_FLAG (DICe) or returnStatus (SPAM), and SUBSET_ID of a table, in
// any case, for those that `columns` does not give. Throws InputError when two columns have one of
// these names.
void AddKnownColumns(const DelimitedTable& table, DisplacementColumns* columns);

// The unit of places and displacements: in brackets in the names of their columns, or else in the
// comments. Empty where there is none. The table has names. Throws InputError when two units
// differ.
std::string LengthUnitOf(const DelimitedTable& table, const DisplacementColumns& columns);

// Columns as points: 3 × rows.
Eigen::Matrix3Xd PointsOf(const DelimitedTable& table, const std::array<Eigen::Index, 3>& columns);

// 3 × rows: place + displacement, in the table's unit; NaN where a point failed: where one of its
// numbers is missing, sigma is negative or missing, the status is missing or one of failure, or
// places and displacements are zero in several rows.
Eigen::Matrix3Xd MovedPoints(const DelimitedTable& table, const DisplacementColumns& columns);

// The column sigma, one entry for each row; empty where the table has none.
Eigen::VectorXd SigmaOf(const DelimitedTable& table, const DisplacementColumns& columns);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DISPLACEMENT_TABLE_H_
