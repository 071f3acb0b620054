# What `cmake --install` brings and what the packages of CPack hold: the command with its pages, examples and cases, and
# the library with its headers, for CMake's find_package and for pkg-config.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME command)

if(TARGET rosin_command)
  set(pages rosin.1 rosin.bash _rosin rosin.fish)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/pages)
  list(TRANSFORM pages PREPEND ${PROJECT_BINARY_DIR}/pages/)
  add_custom_command(OUTPUT ${pages} COMMAND rosin_pages ${PROJECT_BINARY_DIR}/pages DEPENDS rosin_pages VERBATIM)
  add_custom_target(pages ALL DEPENDS ${pages})
  install(TARGETS rosin_command)
  install(DIRECTORY cases DESTINATION ${CMAKE_INSTALL_DATADIR}/rosin)
  install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/rosin
          FILES_MATCHING PATTERN *.toml PATTERN *.csv PATTERN *.cpp PATTERN *.py PATTERN *.m PATTERN *.in PATTERN out EXCLUDE)
  install(FILES README.md LICENSE TYPE DOC)
  install(DIRECTORY docs TYPE DOC PATTERN *.sh EXCLUDE PATTERN *.py EXCLUDE PATTERN site EXCLUDE)
  install(FILES ${PROJECT_BINARY_DIR}/pages/rosin.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${PROJECT_BINARY_DIR}/pages/rosin.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rosin)
  install(FILES ${PROJECT_BINARY_DIR}/pages/_rosin DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(FILES ${PROJECT_BINARY_DIR}/pages/rosin.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()

# Headers say "core/…", which in a user's project would be found in a folder core/ of the user's: installed ones say
# "rosin/core/…".
list(JOIN ROSIN_FOLDERS "|" folders)
install(DIRECTORY ${ROSIN_FOLDERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rosin COMPONENT development
        FILES_MATCHING PATTERN *.hpp)
install(CODE "
  file(GLOB_RECURSE headers \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/rosin/*.hpp\")
  foreach(header \${headers})
    file(READ \${header} text)
    string(REGEX REPLACE \"#include \\\"(${folders})/\" \"#include \\\"rosin/\\\\1/\" text \"\${text}\")
    file(WRITE \${header} \"\${text}\")
  endforeach()" COMPONENT development)

set(config ${CMAKE_INSTALL_LIBDIR}/cmake/rosin)
install(TARGETS rosin EXPORT rosin COMPONENT development)
install(EXPORT rosin FILE rosinTargets.cmake NAMESPACE rosin:: DESTINATION ${config} COMPONENT development)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rosinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/rosinConfig.cmake ${PROJECT_BINARY_DIR}/rosinConfigVersion.cmake DESTINATION ${config} COMPONENT development)
file(RELATIVE_PATH ROSIN_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" ROSIN_PREFIX ${ROSIN_PREFIX})
list(JOIN ROSIN_OPTIONS " " ROSIN_PC_OPTIONS)
configure_file(cmake/rosin.pc.in rosin.pc.in @ONLY)
file(GENERATE OUTPUT rosin.pc INPUT ${PROJECT_BINARY_DIR}/rosin.pc.in TARGET rosin)
install(FILES ${PROJECT_BINARY_DIR}/rosin.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The authors of rosin <rosin@localhost>")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL command development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_layout.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME rosin)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_COMPONENT_COMMAND_DESCRIPTION "The command rosin with its examples, and cases to verify it by.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME librosin-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libeigen3-dev, libfmt-dev, libsundials-dev, libudunits2-dev, libfftw3-dev, libgsl-dev, pkgconf")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers and the static library of rosin, for CMake and pkg-config.")
if(ROSIN_PYTHON_PACKAGE)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-rosin)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  math(EXPR next "${Python_VERSION_MINOR} + 1") # the module is for one version of Python
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next}), \
python3-numpy, python3-xarray, python3-netcdf4")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-tqdm, rosin")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/python3-rosin/postinst
      ${PROJECT_SOURCE_DIR}/cmake/python3-rosin/prerm)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python package rosin: the verbs of the command as methods of scenes, results as
xarray datasets, pictures by matplotlib.")
endif()
include(CPack)
