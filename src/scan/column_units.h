// The units that a table of text gives for its columns.
#ifndef LACUNA_SCAN_COLUMN_UNITS_H_
#define LACUNA_SCAN_COLUMN_UNITS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/quantity.h"

namespace lacuna {

struct DelimitedTable;

// The unit that a table with names gives for a column, in the line below the names or else in
// brackets in the name; empty where it gives none.
std::string UnitOfColumn(const DelimitedTable& table, Eigen::Index column);
// UnitOfColumn() where that is a unit of length; empty where it is another remark.
std::string LengthUnitOfColumn(const DelimitedTable& table, Eigen::Index column);

// Throws InputError naming the table where it gives another unit for the column than `unit`: in the
// line below the names, in the name in brackets, as in "Force [kN]", or at its end where that is a
// unit of this dimension, as in "F/kN", "F_kN" and "F in kN". A unit of another dimension, and one
// of which only the case differs ("KN"), is refused, too. Other words in brackets are remarks, as
// in "Force (left)", and so is "(min)", a minimum. `key` is the one of recording.yaml that gives
// the unit. A table without names has no such columns.
void RefuseOtherUnit(const DelimitedTable& table, Eigen::Index column, double unit,
                     const Dimension& dimension, const std::string& key);
// RefuseOtherUnit() for several columns, by their names or numbers.
void RefuseOtherUnits(const DelimitedTable& table, const std::vector<std::string>& names,
                      double unit, const Dimension& dimension, const std::string& key);

}  // namespace lacuna

#endif  // LACUNA_SCAN_COLUMN_UNITS_H_
