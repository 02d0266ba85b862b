# SPDX-License-Identifier: MIT
#
# The scenes of examples/*/scene.yaml go into the program, for `cattaneo examples`: a C file is made of them.
file(GLOB scenes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/examples/*/scene.yaml)
set(CATTANEO_EXAMPLES ${CMAKE_BINARY_DIR}/generated/examples_list.c)

add_custom_command(OUTPUT ${CATTANEO_EXAMPLES}
  COMMAND ${CMAKE_COMMAND} "-DSCENES=${scenes}" -DOUT=${CATTANEO_EXAMPLES}
    -P ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
  DEPENDS ${scenes} ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
  COMMENT "Embedding the examples"
  VERBATIM)
# Both programs compile it; one target makes it, so that they do not race.
add_custom_target(examples_list DEPENDS ${CATTANEO_EXAMPLES})
