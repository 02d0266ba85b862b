# SPDX-License-Identifier: MIT
#
# The scenes of examples/NAME/scene.yaml go into the program, for `cattaneo examples`, with the files that they name, which
# stand in examples/NAME/NAME: a C file is made of them.
file(GLOB scenes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/examples/*/scene.yaml)
set(companions "")
foreach(scene IN LISTS scenes)
  get_filename_component(folder ${scene} DIRECTORY)
  get_filename_component(name ${folder} NAME)
  file(GLOB files CONFIGURE_DEPENDS LIST_DIRECTORIES false ${folder}/${name}/*)
  list(APPEND companions ${files})
endforeach()
set(CATTANEO_EXAMPLES ${CMAKE_BINARY_DIR}/generated/examples_list.c)

add_custom_command(OUTPUT ${CATTANEO_EXAMPLES}
  COMMAND ${CMAKE_COMMAND} "-DSCENES=${scenes}" "-DFILES=${companions}" -DOUT=${CATTANEO_EXAMPLES}
    -P ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
  DEPENDS ${scenes} ${companions} ${CMAKE_SOURCE_DIR}/cmake/embed.cmake
  COMMENT "Embedding the examples"
  VERBATIM)
# Both programs compile it; one target makes it, so that they do not race.
add_custom_target(examples_list DEPENDS ${CATTANEO_EXAMPLES})
