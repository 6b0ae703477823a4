#include "record/library_versions.h"

#include <CGAL/version.h>
#include <SuiteSparse_config.h>
#include <ceres/version.h>
#include <fmt/format.h>
#include <metis.h>
#include <pcl/pcl_config.h>
#include <vtkVersionMacros.h>

#include <Eigen/Core>

namespace lacuna {

std::string ProgramVersion() { return LACUNA_VERSION; }

std::map<std::string, std::string> LibraryVersions() {
  return {
      {"CGAL", CGAL_VERSION_STR},
      {"Ceres", CERES_VERSION_STRING},
      {"Eigen",
       fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"METIS", fmt::format("{}.{}.{}", METIS_VER_MAJOR, METIS_VER_MINOR, METIS_VER_SUBMINOR)},
      {"PCL", PCL_VERSION_PRETTY},
      {"SuiteSparse", fmt::format("{}.{}.{}", SUITESPARSE_MAIN_VERSION, SUITESPARSE_SUB_VERSION,
                                  SUITESPARSE_SUBSUB_VERSION)},
      {"VTK", VTK_VERSION},
  };
}

}  // namespace lacuna
