# SPDX-License-Identifier: MIT
#
# The libraries export what include/cattaneo.h lists in CF_PUBLIC_LIST and nothing else, and the symbols of the
# single-precision one start with cff_ (the header itself sees to that). A linker script for each library is made of
# that list.
set(public_header ${CMAKE_SOURCE_DIR}/include/cattaneo.h)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${public_header})

file(READ ${public_header} text)
string(REGEX REPLACE ".*#define CF_PUBLIC_LIST\\(F\\)" "" text "${text}")
string(REGEX REPLACE "\n#.*|\n/\\*.*" "" text "${text}")
string(REGEX MATCHALL "F\\([a-z0-9_]+\\)" names "${text}")
if(NOT names)
  message(FATAL_ERROR "no CF_PUBLIC_LIST in ${public_header}")
endif()

set(script "")
set(scriptf "")
foreach(name IN LISTS names)
  string(REGEX REPLACE "F\\((.*)\\)" "\\1" name ${name})
  string(APPEND script "    cf_${name};\n")
  string(APPEND scriptf "    cff_${name};\n")
endforeach()
# file(CONFIGURE) leaves a file alone that would not change.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/cattaneo.map
  CONTENT "{\n  global:\n${script}  local:\n    *;\n};\n" @ONLY)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/cattaneof.map
  CONTENT "{\n  global:\n${scriptf}  local:\n    *;\n};\n" @ONLY)
