# SPDX-License-Identifier: MIT
#
# `cmake --install`: the two programs, the two libraries, the header, the manual page, and what makes
# find_package(cattaneo) and pkg-config find them. Outside projects link cattaneo::cattaneo (double) or
# cattaneo::cattaneof (single).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# From the folder of the .pc files up to the prefix, so that an installed tree may be moved.
file(RELATIVE_PATH PC_UP /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" PC_UP ${PC_UP})

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/cattaneo)
foreach(precision IN ITEMS double single)
  set(suffix "")
  set(define "")
  if(precision STREQUAL single)
    set(suffix f)
    set(define "-DCF_SINGLE")
    target_compile_definitions(cattaneof INTERFACE CF_SINGLE)
  endif()
  install(TARGETS cattaneo${suffix} EXPORT cattaneo
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(TARGETS cattaneo_program_${precision} DESTINATION ${CMAKE_INSTALL_BINDIR})
  set(PC_NAME cattaneo${suffix})
  set(PC_PRECISION ${precision})
  set(PC_DEFINE ${define})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/cattaneo.pc.in ${CMAKE_BINARY_DIR}/generated/${PC_NAME}.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/generated/${PC_NAME}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/include/*.h)
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT cattaneo FILE cattaneo-targets.cmake NAMESPACE cattaneo:: DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/cattaneo-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_SOURCE_DIR}/cmake/cattaneo-config.cmake
  ${CMAKE_BINARY_DIR}/generated/cattaneo-config-version.cmake DESTINATION ${package_folder})

# The manual page says what --help says: the program writes it.
set(manual ${CMAKE_BINARY_DIR}/generated/cattaneo.1)
add_custom_command(OUTPUT ${manual}
  COMMAND cattaneo_program_double help --manual > ${manual}
  DEPENDS cattaneo_program_double
  COMMENT "Writing cattaneo.1"
  VERBATIM)
add_custom_target(manual ALL DEPENDS ${manual})
install(FILES ${manual} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
