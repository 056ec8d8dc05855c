# Installs the libraries as the CMake package "hardbody" with one component a library, and the program with its manual.
#
# Two install components, which are the two Debian packages (HardbodyPackage.cmake): "dev", the default here, and
# "program".
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)

set(HARDBODY_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hardbody)

# hardbody_install(<component>): what was not built is not installed.
function(hardbody_install component)
  if(NOT TARGET hardbody_${component})
    return()
  endif()
  install(TARGETS hardbody_${component} EXPORT hardbody-${component}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT hardbody-${component} NAMESPACE hardbody:: FILE hardbody-${component}-targets.cmake
    DESTINATION ${HARDBODY_CMAKE_DIR})
endfunction()

set(HARDBODY_HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/hardbody)
hardbody_install(geom)
# *-inl.h are included by sources of these libraries only, and need Highway.
install(DIRECTORY libgeom/include/geom DESTINATION ${HARDBODY_HEADER_DIR} PATTERN "*-inl.h" EXCLUDE)
hardbody_install(ed)
install(DIRECTORY libed/include/ed DESTINATION ${HARDBODY_HEADER_DIR})
hardbody_install(geom_seeds)
hardbody_install(geom_cgal)
install(FILES libgeom/seeds/include/geom/kernel/support_body.h DESTINATION ${HARDBODY_HEADER_DIR}/geom/kernel)
if(HARDBODY_WITH_SEEDS)
  install(FILES libgeom/seeds/include/geom/seeds.h DESTINATION ${HARDBODY_HEADER_DIR}/geom)
endif()
if(HARDBODY_WITH_CGAL)
  install(FILES libgeom/seeds/include/geom/cgal.h DESTINATION ${HARDBODY_HEADER_DIR}/geom)
endif()

configure_package_config_file(cmake/hardbody-config.cmake.in hardbody-config.cmake
  INSTALL_DESTINATION ${HARDBODY_CMAKE_DIR})
write_basic_package_version_file(hardbody-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hardbody-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/hardbody-config-version.cmake
  DESTINATION ${HARDBODY_CMAKE_DIR})

if(TARGET hardbody)
  install(TARGETS hardbody RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(FILES docs/man/hardbody.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(DIRECTORY apps/workflow/ DESTINATION ${CMAKE_INSTALL_DATADIR}/hardbody/workflow COMPONENT program
    PATTERN CMakeLists.txt EXCLUDE)
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
