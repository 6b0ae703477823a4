# What `cmake --install` installs, in three components: the programs with all that belongs to them,
# the libraries for other programs (development), and the Python module (src/python).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_CURRENT_LIST_DIR})

# --- Programs -----------------------------------------------------------------------------------

install(TARGETS lacuna lacuna-trials RUNTIME COMPONENT program)
set(documents ${PROJECT_BINARY_DIR}/src/app/documents)
install(FILES ${documents}/lacuna.1.gz ${documents}/lacuna-trials.1.gz
        DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
foreach(program lacuna lacuna-trials)
  install(FILES ${documents}/${program}.bash RENAME ${program}
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
endforeach()
install(FILES ${documents}/_lacuna ${documents}/_lacuna-trials
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)

# The demo and all other experiments. Runs write beside them, so that a user works on a copy.
set(examples ${CMAKE_INSTALL_DATADIR}/lacuna/examples)
install(DIRECTORY experiments configs DESTINATION ${examples} COMPONENT program)
install(PROGRAMS demo.sh DESTINATION ${examples} COMPONENT program)

install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY third_party_notes DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES src/report/page/LICENSES.txt DESTINATION ${CMAKE_INSTALL_DOCDIR}
        RENAME report_page_licences.txt COMPONENT program)

# --- Libraries ----------------------------------------------------------------------------------

# What fits and predicts, without the pictures and pages of `report` and what builds on them.
set(installed_modules core geometry search scan surface registration meshing record fem analysis
                      effects fit experiment prediction calibration)
foreach(module ${installed_modules})
  set_target_properties(lacuna_${module} PROPERTIES EXPORT_NAME ${module})
  install(TARGETS lacuna_${module} EXPORT LacunaTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/lacuna COMPONENT development)
  install(DIRECTORY src/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lacuna
          COMPONENT development FILES_MATCHING PATTERN "*.h")
endforeach()

# Lacuna::lacuna is all of them. Eigen's alignment, and with it the layout of our structs, would
# otherwise change with -march of the program that uses them.
add_library(lacuna_installed INTERFACE)
set_target_properties(lacuna_installed PROPERTIES EXPORT_NAME lacuna)
target_link_libraries(lacuna_installed INTERFACE lacuna_calibration)
target_compile_features(lacuna_installed INTERFACE cxx_std_20)
target_compile_definitions(lacuna_installed INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
install(TARGETS lacuna_installed EXPORT LacunaTargets)

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Lacuna)
install(EXPORT LacunaTargets NAMESPACE Lacuna:: DESTINATION ${config_folder} COMPONENT development)
configure_package_config_file(${package_folder}/LacunaConfig.cmake.in
  ${PROJECT_BINARY_DIR}/LacunaConfig.cmake INSTALL_DESTINATION ${config_folder})
# Before version 1 any release may change the headers.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/LacunaConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/LacunaConfig.cmake
              ${PROJECT_BINARY_DIR}/LacunaConfigVersion.cmake
        DESTINATION ${config_folder} COMPONENT development)

# --- What each Debian package must have ---------------------------------------------------------

file(READ LICENSE licence)
file(WRITE ${PROJECT_BINARY_DIR}/copyright "Copyright: the authors of Lacuna\n\n${licence}")
set(LACUNA_MAINTAINER "The authors of Lacuna <lacuna@localhost>" CACHE STRING
    "Who answers for the Debian packages: name and address")
configure_file(${package_folder}/changelog.in ${PROJECT_BINARY_DIR}/changelog @ONLY)
execute_process(COMMAND gzip -9nkf ${PROJECT_BINARY_DIR}/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(part program:lacuna development:liblacuna-dev python:python3-lacuna)
  string(REPLACE ":" ";" part ${part})
  list(GET part 0 component)
  list(GET part 1 package)
  if(component STREQUAL python AND NOT TARGET lacuna_python)
    continue()
  endif()
  install(FILES ${PROJECT_BINARY_DIR}/copyright ${PROJECT_BINARY_DIR}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()

# --- What must be built before ------------------------------------------------------------------

add_custom_target(installable DEPENDS lacuna_documents lacuna_calibration)
if(TARGET lacuna_python)
  add_dependencies(installable lacuna_python)
endif()

include(${package_folder}/package.cmake)
