# SPDX-License-Identifier: MIT
#
# The commit that is built, as CF_GIT_HASH, and the version, as CF_VERSION, for src/base/version.c alone. They
# come through a small header that is renewed at every build but only touched when it changes, so a commit
# recompiles one file.
set(stamp ${CMAKE_BINARY_DIR}/generated/stamp.h)
find_package(Git QUIET)

add_custom_target(stamp
  COMMAND ${CMAKE_COMMAND} -DGIT=${GIT_EXECUTABLE} -DSOURCE=${CMAKE_SOURCE_DIR} -DVERSION=${PROJECT_VERSION}
    -DOUT=${stamp} -P ${CMAKE_SOURCE_DIR}/cmake/stamp.cmake
  BYPRODUCTS ${stamp}
  COMMENT "Looking which commit this is")
set_source_files_properties(${CMAKE_SOURCE_DIR}/src/base/version.c PROPERTIES
  COMPILE_OPTIONS "-include;${stamp}"
  OBJECT_DEPENDS ${stamp})
foreach(precision IN ITEMS double single)
  add_dependencies(base_${precision} stamp)
endforeach()
