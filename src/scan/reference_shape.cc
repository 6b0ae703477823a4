#include "scan/reference_shape.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include "geometry/mesh_io.h"
#include "geometry/tri_mesh.h"
#include "scan/region.h"

namespace lacuna {
namespace {

constexpr const char* kNeedsMesh =
    "the frames do not show the surface of the object; give a mesh or a tet_mesh";

std::filesystem::path FindFile(const Config& config, const std::filesystem::path& data_folder,
                               const std::filesystem::path& own_folder) {
  const std::filesystem::path name = config.Text("file");
  for (const std::filesystem::path& folder : {data_folder, own_folder}) {
    if (std::filesystem::is_regular_file(folder / name)) return folder / name;
  }
  config.Fail("file", fmt::format("there is no file {}", (data_folder / name).string()));
}

void ReadSheet(const Config& config, ReferenceShape* reference) {
  const auto sheet = config.OptionalChild("sheet");
  if (!sheet) return;
  if (reference->source == ReferenceSource::kTetMesh) {
    config.Fail("sheet", "a tet_mesh is a solid already");
  }
  reference->sheet_thickness = sheet->Quantity("thickness", kLength, kPositive);
  reference->sheet_face = sheet->Choice<SheetFace>(
      "face", {{"middle", SheetFace::kMiddle}, {"front", SheetFace::kFront}}, "middle");
}

}  // namespace

ReferenceShape ReadReference(const Config& config, const DataLocation& data,
                             const std::filesystem::path& own_folder, bool frames_show_surface) {
  ReferenceShape reference;
  reference.world_from_file.scale = LengthOf(data.length_unit);
  const std::optional<Config> given = config.OptionalChild("reference");
  if (!given) {
    if (!frames_show_surface) config.Fail("", std::string("reference: ") + kNeedsMesh);
    return reference;
  }
  reference.source =
      given->Choice<ReferenceSource>("from", {{"first_frame", ReferenceSource::kFirstFrame},
                                              {"mesh", ReferenceSource::kMesh},
                                              {"tet_mesh", ReferenceSource::kTetMesh}});
  if (reference.source != ReferenceSource::kFirstFrame) {
    reference.file = FindFile(*given, data.folder, own_folder);
    reference.world_from_file =
        ReadWorldFromFile(*given, LengthOf(ReadLengthUnit(*given, data.length_unit)));
  } else if (!frames_show_surface) {
    given->Fail("from", kNeedsMesh);
  }
  ReadSheet(*given, &reference);
  return reference;
}

std::string DescribeReference(const ReferenceShape& reference) {
  std::string text = "the first frame";
  if (reference.source == ReferenceSource::kMesh) text = "mesh " + reference.file.string();
  if (reference.source == ReferenceSource::kTetMesh) text = "tet mesh " + reference.file.string();
  if (reference.sheet_thickness > 0) {
    text += fmt::format(", an open sheet {:.4g} mm thick", 1e3 * reference.sheet_thickness);
  }
  if (reference.source != ReferenceSource::kFirstFrame)
    text += ", " + DescribeCorners(ReferenceBox(reference));
  return text;
}

Eigen::AlignedBox3d ReferenceBox(const ReferenceShape& reference) {
  CHECK(reference.source != ReferenceSource::kFirstFrame);
  const Eigen::Matrix3Xd points = reference.source == ReferenceSource::kMesh
                                      ? ReadTriMesh(reference.file).mesh.vertices
                                      : ReadTetMesh(reference.file).mesh.nodes;
  return BoundingBox(reference.world_from_file * points);
}

}  // namespace lacuna
