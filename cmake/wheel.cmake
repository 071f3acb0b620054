# The wheel of the Python package, which CPack lays beside the Debian packages when it has made them.
if("python" IN_LIST CPACK_COMPONENTS_ALL)
  execute_process(COMMAND ${CPACK_WHEEL_PYTHON} -B ${CPACK_WHEEL_MAKER} ${CPACK_WHEEL_BUILD} ${CPACK_PACKAGE_DIRECTORY}
                  COMMAND_ERROR_IS_FATAL ANY)
endif()
