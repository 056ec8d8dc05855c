# Installs the libraries as the CMake package "hardbody" with one component a library.
include(CMakePackageConfigHelpers)

set(HARDBODY_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hardbody)

foreach(component geom ed)
  install(TARGETS hardbody_${component} EXPORT hardbody-${component}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY lib${component}/include/${component} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hardbody)
  install(EXPORT hardbody-${component} NAMESPACE hardbody:: FILE hardbody-${component}-targets.cmake
    DESTINATION ${HARDBODY_CMAKE_DIR})
endforeach()

configure_package_config_file(cmake/hardbody-config.cmake.in hardbody-config.cmake
  INSTALL_DESTINATION ${HARDBODY_CMAKE_DIR})
write_basic_package_version_file(hardbody-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hardbody-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/hardbody-config-version.cmake
  DESTINATION ${HARDBODY_CMAKE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
