#include "report/vtk_files.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cmath>
#include <set>

#include "core/atomic_file.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// Column-major storage is the layout that VTK needs: the components of one entity side by side.
vtkNew<vtkDoubleArray> ToArray(const Eigen::MatrixXd& values) {
  vtkNew<vtkDoubleArray> array;
  array->SetNumberOfComponents(static_cast<int>(values.rows()));
  array->SetNumberOfTuples(values.cols());
  std::copy(values.data(), values.data() + values.size(), array->GetPointer(0));
  return array;
}

vtkNew<vtkPoints> ToPoints(const Eigen::Matrix3Xd& positions) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetData(ToArray(positions));
  return points;
}

// One cell per column.
vtkNew<vtkCellArray> ToCells(const Eigen::MatrixXi& cells, Eigen::Index node_count) {
  CHECK(cells.size() == 0 || (cells.minCoeff() >= 0 && cells.maxCoeff() < node_count))
      << "an element refers to a node that does not exist";
  vtkNew<vtkIdTypeArray> offsets;
  vtkNew<vtkIdTypeArray> nodes;
  offsets->SetNumberOfValues(cells.cols() + 1);
  nodes->SetNumberOfValues(cells.size());
  for (Eigen::Index k = 0; k <= cells.cols(); ++k) offsets->SetValue(k, k * cells.rows());
  for (Eigen::Index k = 0; k < cells.size(); ++k) nodes->SetValue(k, cells.data()[k]);
  vtkNew<vtkCellArray> array;
  array->SetData(offsets, nodes);
  return array;
}

void AddFields(const std::vector<Field>& fields, Eigen::Index count, const char* of,
               vtkDataSetAttributes* attributes) {
  std::set<std::string> names;
  for (const Field& field : fields) {
    CHECK(!field.name.empty()) << "a field without a name";
    CHECK(names.insert(field.name).second) << "two fields named " << field.name;
    CHECK_GT(field.values.rows(), 0) << "field " << field.name << " has no components";
    CHECK_EQ(field.values.cols(), count)
        << "field " << field.name << " must have one column for each of the " << of;
    const auto array = ToArray(field.values);
    array->SetName(field.name.c_str());
    attributes->AddArray(array);
  }
}

template <typename Writer, typename Data>
void Write(const fs::path& file, Data* data) {
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->SetCompressorTypeToZLib();
  writer->WriteToOutputStringOn();
  CHECK(writer->Write()) << "VTK could not write " << file;
  WriteFileAtomically(file, writer->GetOutputString());
}

std::string EscapeXml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace

void WriteVtu(const fs::path& file, const TetMesh& mesh, const FieldSet& fields) {
  CHECK(mesh.tets.rows() == 4 || mesh.tets.rows() == 10);
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(ToPoints(mesh.nodes));
  grid->SetCells(mesh.Order() == 2 ? VTK_QUADRATIC_TETRA : VTK_TETRA,
                 ToCells(mesh.tets, mesh.NodeCount()));
  AddFields(fields.nodes, mesh.NodeCount(), "nodes", grid->GetPointData());
  AddFields(fields.cells, mesh.TetCount(), "tetrahedra", grid->GetCellData());
  Write<vtkXMLUnstructuredGridWriter>(file, grid.Get());
}

void WriteVtp(const fs::path& file, const TriMesh& mesh, const FieldSet& fields) {
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(ToPoints(mesh.vertices));
  surface->SetPolys(ToCells(mesh.triangles, mesh.vertices.cols()));
  AddFields(fields.nodes, mesh.vertices.cols(), "vertices", surface->GetPointData());
  AddFields(fields.cells, mesh.triangles.cols(), "triangles", surface->GetCellData());
  Write<vtkXMLPolyDataWriter>(file, surface.Get());
}

void WriteVtp(const fs::path& file, const PointCloud& cloud, const std::vector<Field>& fields) {
  vtkNew<vtkPolyData> points;
  points->SetPoints(ToPoints(cloud.points));
  const int count = static_cast<int>(cloud.Size());
  points->SetVerts(ToCells(Eigen::RowVectorXi::LinSpaced(count, 0, count - 1), count));
  std::vector<Field> all = fields;
  if (cloud.HasNormals()) all.push_back({"normal", cloud.normals});
  AddFields(all, cloud.Size(), "points", points->GetPointData());
  Write<vtkXMLPolyDataWriter>(file, points.Get());
}

void WritePvd(const fs::path& file, const std::vector<TimedFile>& series) {
  const fs::path folder = fs::absolute(file).parent_path();
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (size_t k = 0; k < series.size(); ++k) {
    CHECK(std::isfinite(series[k].time) && (k == 0 || series[k].time > series[k - 1].time))
        << "the times of " << file << " must increase";
    const fs::path relative = fs::absolute(series[k].file).lexically_relative(folder);
    text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", series[k].time,
                        EscapeXml(relative.generic_string()));
  }
  text += "  </Collection>\n</VTKFile>\n";
  WriteFileAtomically(file, text);
}

}  // namespace lacuna
