# Writes the texts that a report is made of as one C++ file: cmake -DOUT=… -DSTYLE=… -DSCRIPT=… -DLIBRARY=a.js,b.js -P embed.cmake
# The scripts' and the style's checksums stand in the page's security policy, so that a browser runs these and no others.
string(REPLACE "," ";" parts "${LIBRARY}")
set(library "")
foreach(part IN LISTS parts)
  file(READ "${part}" text)
  string(APPEND library "${text}\n")
endforeach()
file(READ "${STYLE}" style)
file(READ "${SCRIPT}" script)

set(code "/// Made by cmake/embed.cmake.\n#include \"app/report/assets.hpp\"\n\nnamespace rosin::app::report {\n\n")
foreach(asset library script style)
  # A script or style ends where these stand, even within a text of it.
  if("${${asset}}" MATCHES "</[Ss][Cc][Rr]|</[Ss][Tt][Yy]|<!--|\\)rosin\"|\r")
    message(FATAL_ERROR "The ${asset} of reports holds '${CMAKE_MATCH_0}', which cannot stand in a page")
  endif()
  string(SHA256 sum "${${asset}}")
  string(APPEND code "const Asset ${asset}{R\"rosin(${${asset}})rosin\", \"${sum}\"};\n")
endforeach()
file(WRITE "${OUT}" "${code}\n}  // namespace rosin::app::report\n")
