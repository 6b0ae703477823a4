#include "report/vtk_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <string>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two tetrahedra over the face 1 2 3.
TetMesh TwoTets() {
  TetMesh mesh;
  mesh.nodes.resize(3, 5);
  mesh.nodes << 0, 1, 0, 0, 1,  //
      0, 0, 1, 0, 1,            //
      0, 0, 0, 1, 1.0 / 3;
  mesh.tets.resize(4, 2);
  mesh.tets << 0, 1,  //
      1, 3,           //
      2, 2,           //
      3, 4;
  return mesh;
}

TriMesh Square() {
  TriMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,               //
      0.1, 0.2, 0.3, 0.4;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0,  //
      1, 2,                //
      2, 3;
  return mesh;
}

void ExpectArray(vtkDataSetAttributes* attributes, const std::string& name,
                 const Eigen::MatrixXd& expected) {
  vtkDataArray* array = attributes->GetArray(name.c_str());
  ASSERT_NE(array, nullptr) << name;
  EXPECT_EQ(array->GetDataType(), VTK_DOUBLE);
  ASSERT_EQ(array->GetNumberOfComponents(), expected.rows());
  ASSERT_EQ(array->GetNumberOfTuples(), expected.cols());
  for (Eigen::Index column = 0; column < expected.cols(); ++column) {
    for (int row = 0; row < expected.rows(); ++row) {
      EXPECT_EQ(array->GetComponent(column, row), expected(row, column)) << name;
    }
  }
}

void ExpectPoints(vtkPointSet* data, const Eigen::Matrix3Xd& expected) {
  ASSERT_EQ(data->GetNumberOfPoints(), expected.cols());
  for (Eigen::Index k = 0; k < expected.cols(); ++k) {
    EXPECT_EQ(Eigen::Vector3d(data->GetPoint(k)), expected.col(k));
  }
}

void ExpectCells(vtkDataSet* data, int type, const Eigen::MatrixXi& expected) {
  ASSERT_EQ(data->GetNumberOfCells(), expected.cols());
  for (Eigen::Index k = 0; k < expected.cols(); ++k) {
    vtkCell* cell = data->GetCell(k);
    EXPECT_EQ(cell->GetCellType(), type);
    ASSERT_EQ(cell->GetNumberOfPoints(), expected.rows());
    for (int i = 0; i < expected.rows(); ++i) EXPECT_EQ(cell->GetPointId(i), expected(i, k));
  }
}

TEST(VtuTest, LinearTetrahedraAndTheirFieldsComeBackExactly) {
  const TemporaryFolder folder;
  const TetMesh mesh = TwoTets();
  const Eigen::MatrixXd displacement = Eigen::MatrixXd::Random(3, 5);
  const Eigen::MatrixXd stress = Eigen::MatrixXd::Random(9, 2);
  WriteVtu(folder / "a.vtu", mesh, {{{"displacement_m", displacement}}, {{"stress_Pa", stress}}});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "a.vtu").c_str());
  reader->Update();
  ExpectPoints(reader->GetOutput(), mesh.nodes);
  ExpectCells(reader->GetOutput(), VTK_TETRA, mesh.tets);
  ExpectArray(reader->GetOutput()->GetPointData(), "displacement_m", displacement);
  ExpectArray(reader->GetOutput()->GetCellData(), "stress_Pa", stress);
}

TEST(VtuTest, QuadraticTetrahedraHaveTheirEdgeNodesWhereVtkExpectsThem) {
  const TemporaryFolder folder;
  const TetMesh mesh = ToQuadratic(TwoTets());
  WriteVtu(folder / "a.vtu", mesh, {});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "a.vtu").c_str());
  reader->Update();
  ExpectCells(reader->GetOutput(), VTK_QUADRATIC_TETRA, mesh.tets);
  for (vtkIdType k = 0; k < 2; ++k) {
    vtkCell* cell = reader->GetOutput()->GetCell(k);
    for (int edge = 0; edge < cell->GetNumberOfEdges(); ++edge) {
      // VTK lists an edge as its two ends and its middle.
      const auto at = [&](int i) {
        return Eigen::Vector3d(cell->GetEdge(edge)->GetPoints()->GetPoint(i));
      };
      // One rounding of the sum.
      EXPECT_LT((at(2) - (at(0) + at(1)) / 2).norm(), 1e-15);
    }
  }
}

TEST(VtpTest, SurfaceComesBackExactly) {
  const TemporaryFolder folder;
  const TriMesh mesh = Square();
  const Eigen::MatrixXd distance = Eigen::RowVector4d(1, 2, 3, 4);
  const Eigen::MatrixXd area = Eigen::RowVector2d(5, 6);
  WriteVtp(folder / "a.vtp", mesh, {{{"distance_m", distance}}, {{"area_m2", area}}});
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  ExpectPoints(reader->GetOutput(), mesh.vertices);
  ExpectCells(reader->GetOutput(), VTK_TRIANGLE, mesh.triangles);
  ExpectArray(reader->GetOutput()->GetPointData(), "distance_m", distance);
  ExpectArray(reader->GetOutput()->GetCellData(), "area_m2", area);
}

TEST(VtpTest, PointsAreVerticesWithTheirNormals) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.points = Eigen::Matrix3Xd::Random(3, 7);
  cloud.normals = Eigen::Matrix3Xd::Random(3, 7).colwise().normalized();
  const Eigen::MatrixXd weight = Eigen::RowVectorXd::LinSpaced(7, 0, 1);
  WriteVtp(folder / "a.vtp", cloud, {{"weight", weight}});
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  ExpectPoints(reader->GetOutput(), cloud.points);
  ExpectCells(reader->GetOutput(), VTK_VERTEX, Eigen::RowVectorXi::LinSpaced(7, 0, 6));
  ExpectArray(reader->GetOutput()->GetPointData(), "normal", cloud.normals);
  ExpectArray(reader->GetOutput()->GetPointData(), "weight", weight);
}

TEST(VtpTest, EmptyCloudIsAReadableFile) {
  const TemporaryFolder folder;
  WriteVtp(folder / "a.vtp", PointCloud(), {});
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  EXPECT_EQ(reader->GetErrorCode(), 0u);
  EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(VtpTest, SameDataGiveTheSameBytes) {
  const TemporaryFolder folder;
  WriteVtp(folder / "a.vtp", Square(), {});
  WriteVtp(folder / "b.vtp", Square(), {});
  EXPECT_EQ(FileContent(folder / "a.vtp"), FileContent(folder / "b.vtp"));
}

TEST(VtkFilesTest, UnwritableFileIsNamed) {
  EXPECT_THAT([] { WriteVtp("/proc/a.vtp", Square(), {}); },
              ThrowsMessage<InputError>(HasSubstr("/proc/a.vtp: cannot be written")));
}

TEST(VtkFilesDeathTest, FieldsThatDoNotFitTheMeshAreRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "a.vtu";
  const Eigen::MatrixXd four = Eigen::RowVector4d::Zero();
  const Eigen::MatrixXd five = Eigen::RowVectorXd::Zero(5);
  EXPECT_DEATH(WriteVtu(file, TwoTets(), {{{"u", four}}, {}}), "field u must have one column");
  EXPECT_DEATH(WriteVtu(file, TwoTets(), {{}, {{"s", five}}}), "each of the tetrahedra");
  EXPECT_DEATH(WriteVtu(file, TwoTets(), {{{"u", five}, {"u", five}}, {}}), "two fields named u");
  EXPECT_DEATH(WriteVtu(file, TwoTets(), {{{"", five}}, {}}), "without a name");
  TriMesh broken = Square();
  broken.triangles(0, 0) = 4;
  EXPECT_DEATH(WriteVtp(file, broken, {}), "a node that does not exist");
}

TEST(PvdTest, NamesFilesByTimeRelativeToItsOwnFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "frames");
  WritePvd(folder / "a.pvd", {{0, folder / "frames/0 & 1.vtu"}, {0.1, folder / "b\"<.vtu"}});
  vtkNew<vtkXMLDataParser> parser;  // that the file is XML is for a parser to say
  parser->SetFileName((folder / "a.pvd").c_str());
  ASSERT_TRUE(parser->Parse());
  vtkXMLDataElement* root = parser->GetRootElement();
  EXPECT_STREQ(root->GetName(), "VTKFile");
  EXPECT_STREQ(root->GetAttribute("type"), "Collection");
  vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
  ASSERT_EQ(collection->GetNumberOfNestedElements(), 2);
  vtkXMLDataElement* first = collection->GetNestedElement(0);
  vtkXMLDataElement* second = collection->GetNestedElement(1);
  EXPECT_STREQ(first->GetAttribute("timestep"), "0");
  EXPECT_STREQ(first->GetAttribute("file"), "frames/0 & 1.vtu");
  EXPECT_STREQ(second->GetAttribute("timestep"), "0.1");
  EXPECT_STREQ(second->GetAttribute("file"), "b\"<.vtu");
}

TEST(PvdDeathTest, TimesMustIncrease) {
  const TemporaryFolder folder;
  EXPECT_DEATH(WritePvd(folder / "a.pvd", {{1, "a.vtu"}, {1, "b.vtu"}}), "must increase");
}

}  // namespace
}  // namespace lacuna
