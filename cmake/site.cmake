# The target `site`: the pages of docs/ with formulas, a gallery of the examples and the interfaces of C++ and Python, in
# build/…/site/html. All it needs are tools of Debian; without them there is no such target.
find_program(SPHINX_BUILD NAMES sphinx-build)
find_program(DOXYGEN doxygen)
find_path(MATHJAX MathJax.js PATHS /usr/share/javascript/mathjax)
if(NOT (SPHINX_BUILD AND DOXYGEN AND MATHJAX AND ROSIN_PYTHON_PACKAGE))
  return()
endif()
set(site ${PROJECT_BINARY_DIR}/site)
add_custom_target(site ${CMAKE_COMMAND} -E env ROSIN_VERSION=${PROJECT_VERSION} ROSIN_DOXYGEN=${site}/doxygen/xml
                       ROSIN_PACKAGE=${PROJECT_BINARY_DIR}/python ROSIN_MATHJAX=${MATHJAX}
                       ${PROJECT_SOURCE_DIR}/docs/site/build.sh ${PROJECT_SOURCE_DIR} ${site} $<TARGET_FILE:rosin_command>
                  DEPENDS rosin_command rosin_module USES_TERMINAL VERBATIM)
