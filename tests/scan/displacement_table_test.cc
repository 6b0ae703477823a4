// The columns of the tables of image correlation that the common programs write.
#include "scan/displacement_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "scan/displacement_table_fixture.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

Eigen::Matrix3Xd Moved(DelimitedTable table) {
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  EXPECT_TRUE(columns.has_value());
  return columns ? MovedPoints(table, *columns) : Eigen::Matrix3Xd(3, 0);
}

const std::string kVic =
    "\"X\",\"Y\",\"Z\",\"U\",\"V\",\"W\",\"sigma\",\"x\",\"y\"\n"
    "0,0,0,0,0,0,0.01,310,20\n"
    "10,0,0,0.5,0,-0.25,0.01,340,20\n"
    "0,10,0,0,1,0,0.01,310,50\n"
    "0,0,10,0,0,2,0.02,310,20\n"
    "10,10,0,9,9,9,-1,340,50\n";

TEST_F(DisplacementTable, OfVic3dHasMetricPlacesBesidePixels) {
  const Eigen::Matrix3Xd points = Moved(Table(kVic));
  ASSERT_EQ(points.cols(), 5);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(0, 0, 0)) << "one point may be at the origin";
  EXPECT_EQ(points.col(1), Eigen::Vector3d(10.5, 0, -0.25));
  EXPECT_TRUE(points.col(4).array().isNaN().all()) << "sigma is −1";
}

TEST_F(DisplacementTable, OfDiceFollowsItsBlockOfStars) {
  const Eigen::Matrix3Xd points = Moved(
      Table("***\n*** Digital Image Correlation Engine, a block of remarks, with commas\n***\n"
            "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,"
            "MODEL_COORDINATES_X,MODEL_COORDINATES_Y,MODEL_COORDINATES_Z,MODEL_DISPLACEMENT_X,"
            "MODEL_DISPLACEMENT_Y,MODEL_DISPLACEMENT_Z,SIGMA,STATUS_FLAG\n"
            "0,100,200,1,1,1.5,2,3,0.25,0.5,1,0.01,4\n"
            "1,120,200,1,1,2.5,2,3,0.25,0.5,1,-1,9\n"
            "2,140,200,1,1,3.5,2,3,0.25,0.5,1,0.01,8\n"
            "3,160,200,1,1,4.5,2,3,0.25,nan,1,0.01,0\n"));
  ASSERT_EQ(points.cols(), 4);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(1.75, 2.5, 4));
  for (int failed = 1; failed < 4; ++failed) EXPECT_FALSE(points.col(failed).allFinite()) << failed;
}

TEST_F(DisplacementTable, OfDiceWithoutAStatusHasFailed) {
  const Eigen::Matrix3Xd points =
      Moved(Table("MODEL_COORDINATES_X,MODEL_COORDINATES_Y,MODEL_COORDINATES_Z,"
                  "MODEL_DISPLACEMENT_X,MODEL_DISPLACEMENT_Y,MODEL_DISPLACEMENT_Z,STATUS_FLAG\n"
                  "1,2,3,1,1,1,4\n1,2,3,1,1,1,\n1,2,3,1,1,1,nan\n"));
  ASSERT_EQ(points.cols(), 3);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(2, 3, 4));
  for (const int unknown : {1, 2}) EXPECT_TRUE(points.col(unknown).array().isNaN().all());
}

TEST_F(DisplacementTable, OfAramisHasItsNamesInTheLastComment) {
  DelimitedTable table = Table(
      "####\n# Facet size: 19.0\n# Force; with a semicolon: 12 N\n####\n#\n"
      "#ID,ID; x_undef [mm]; y_undef [mm]; z_undef [mm]; u [mm]; v [mm]; w [mm]; epsx [%]\n"
      "7; 1.0; 2.0; 3.0; 0.5; -0.5; 0.25; 1\n"
      "9; 2.0; 2.0; 3.0; 0.5; -0.5; 0.25; 1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_EQ(columns->id, 0);
  EXPECT_FALSE(columns->has_common_names);
  EXPECT_EQ(MovedPoints(table, *columns).col(0), Eigen::Vector3d(1.5, 1.5, 3.25));
}

TEST_F(DisplacementTable, OfSimulatedNodemapsHasOtherNames) {
  EXPECT_EQ(Moved(Table("#   index   ;    x_undf  ;    y_undf  ;    z_undf  ;    ux      ;    uy   "
                        "   ;    uz      ;    eps_x\n     1.00000;     30.00000;     0.00000;     "
                        "0.00000;     -0.5;     0.25;     1.00000;    -0.03577\n"))
                .col(0),
            Eigen::Vector3d(29.5, 0.25, 1));
}

TEST_F(DisplacementTable, OfMatchIdHasItsLongNames) {
  DelimitedTable table = Table(
      "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],coor.X [mm],coor.Y [mm],coor.Z [mm],"
      "disp.Horizontal Displacement U [mm],disp.Vertical Displacement V [mm],"
      "disp.Out-Of-Plane: W [mm],strain.Strain-global frame: Exx [ ]\n"
      "100,200,1,2,3,0.5,-0.5,0.25,0.001\n101,200,2,2,3,0.5,,0.25,0.001\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_FALSE(columns->has_common_names);
  const Eigen::Matrix3Xd points = MovedPoints(table, *columns);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(1.5, 1.5, 3.25));
  EXPECT_FALSE(points.col(1).allFinite());
  DelimitedTable plane = Table(
      "coor.X [mm],coor.Y [mm],disp.Horizontal Displacement U [mm],"
      "disp.Vertical Displacement V [mm]\n1,2,3,4\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&plane); }),
              HasSubstr("in the image plane only (\"disp.Horizontal Displacement U [mm]\""));
}

TEST_F(DisplacementTable, MayHaveATitleUnitsAndDecimalCommas) {
  DelimitedTable table = Table(
      "Blade_2 AOI 2\n\"Index [1]\";\"X [mm]\";\"Y [mm]\";\"Z [mm]\";\"U [mm]\";\"V [mm]\";"
      "\"W [mm]\";\"Sigma_X [mm]\";\"sigma [pixel]\"\n"
      "1;1,5;2;3;0,5;0;-1;0,1;0,02\n2;1;2;3;0;0;0;0,1;-1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_EQ(columns->id, 0);
  EXPECT_EQ(MovedPoints(table, *columns).col(0), Eigen::Vector3d(2, 2, 2));
  EXPECT_EQ(SigmaOf(table, *columns), Eigen::Vector2d(0.02, -1));
}

TEST_F(DisplacementTable, MayHaveUnitsWithoutABlank) {
  DelimitedTable table = Table("x[m],y[m],z[m],u[m],v[m],w[m]\n1,2,3,1,1,1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "m");
  EXPECT_TRUE(columns->has_common_names);
}

TEST_F(DisplacementTable, ForgetsPointsThatAreZeroInSeveralRows) {
  const Eigen::Matrix3Xd points =
      Moved(Table("X,Y,Z,U,V,W,sigma\n0,0,0,0,0,0,0\n1,2,3,0,0,0,0.1\n0,0,0,0,0,0,0\n"));
  EXPECT_FALSE(points.col(0).allFinite());
  EXPECT_TRUE(points.col(1).allFinite());
  EXPECT_FALSE(points.col(2).allFinite());
}

TEST_F(DisplacementTable, IsNotSeenInOtherTables) {
  for (const char* content :
       {"x,y,z\n1,2,3\n", "x,y,z,u,v\n1,2,3,4,5\n", "1,2,3,4,5,6\n", "# x; y; z: remarks\n1;2;3\n",
        "# x y z u v w\n1 2 3 4 5\n", "# u; v; w; a; b; c\n1;2;3;4;5;6\n"}) {
    DelimitedTable table = Table(content);
    const std::vector<std::string> header = table.header;
    EXPECT_FALSE(FindDisplacementColumns(&table).has_value()) << content;
    EXPECT_EQ(table.header, header) << content;
  }
}

TEST_F(DisplacementTable, ThatCannotBeUsedIsExplained) {
  DelimitedTable plane = Table(
      "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA\n0,1,2,3,4,0.1\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&plane); }),
              HasSubstr("displacements in the image plane only (\"DISPLACEMENT_X\""));
  DelimitedTable units = Table("x [mm],y [mm],z [mm],u [um],v [um],w [um]\n1,2,3,4,5,6\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&units); }),
              HasSubstr("gives \"u [um]\" beside columns in mm"));
  EXPECT_THAT(ErrorOf([&] { Table("X,Y,Z,U,V,W\n1,2,3,4,5,6\n*** end\n"); }),
              HasSubstr("table.txt:3:1"))
      << "stars may stand above the table only";
}

TEST_F(DisplacementTable, RefusesANameThatTwoColumnsHave) {
  DelimitedTable table = Table("X,Y,Z,U,V,W,U\n1,2,3,0,0,0,9\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&table); }),
              HasSubstr("has the columns \"U\" and \"U\", of which the numbers are 4 and 7"));
}

}  // namespace
}  // namespace lacuna
