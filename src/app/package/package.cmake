# Debian packages: `cpack -G DEB` in the build folder makes lacuna, liblacuna-dev and, where the
# Python module is built, python3-lacuna.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lacuna)
set(CPACK_PACKAGE_CONTACT "${LACUNA_MAINTAINER}")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
    GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lacuna)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Pictures are drawn without a screen, by Mesa.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "calculix-ccx, liblacuna-dev, python3-lacuna")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
"find the physical effect that a finite-element model lacks
Lacuna compares the motion that a finite-element model of a deforming soft
object predicts with a recording of the real motion, fits the parameters of
the model, and finds out which physical effect is missing from it.
.
Example experiments are in /usr/share/lacuna/examples.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblacuna-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libceres-dev, libcgal-dev, libeigen3-dev, libfmt-dev, libgoogle-glog-dev, libmetis-dev, \
libnanoflann-dev, libnlopt-dev, libopenblas-dev, libpcl-dev, libpng-dev, libsuitesparse-dev, \
libtet1.5-dev, libxxhash-dev, libyaml-cpp-dev, nlohmann-json3-dev, pkg-config, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"libraries of Lacuna, for programs that fit and predict
Static libraries and headers of Lacuna with which other programs predict the
motion of a finite-element model and fit its parameters to recordings.
.
find_package(Lacuna) provides the CMake target Lacuna::lacuna.")

if(TARGET lacuna_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lacuna)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  # The extension belongs to one version of Python.
  get_target_property(version lacuna_python python_version)  # 3.11
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" version ${version})
  math(EXPR next "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "lacuna (= ${PROJECT_VERSION}), python3 (>= ${version}), \
python3 (<< ${CMAKE_MATCH_1}.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"Python module that reads and makes runs of Lacuna
The module lacuna reads the results of Lacuna into NumPy arrays (parameters
with intervals, measured and predicted motion, diagnoses) and runs its
commands.")
endif()
include(CPack)
