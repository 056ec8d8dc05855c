# Debian packages, by `cmake --build build/release --target package` (docs/decisions/009-packages.md):
#
#   hardbody         the program and its manual
#   libhardbody-dev  headers, static libraries, CMake package
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hardbody)
set(CPACK_PACKAGE_VENDOR "the hardbody authors")
set(CPACK_PACKAGE_CONTACT "the hardbody authors <maintainers@hardbody.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program dev)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME hardbody)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "Event-driven dynamics of hard ellipsoids
The program hardbody simulates hard rigid bodies by event-driven molecular
dynamics that misses no collision, measures diffusion coefficients and other
observables with error bars, and answers distances of convex bodies.")
# The libraries that the program is linked to, with the versions that it needs, from dpkg-shlibdeps.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libhardbody-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "Exact distances and contact times of smooth convex bodies
C++20 libraries: libgeom (signed distance of ellipsoids, superellipsoids and
any convex shape with a support function, exact to rounding) and libed
(event-driven dynamics of hard bodies). Static libraries and a CMake package
with the components geom, ed, geom_seeds and geom_cgal.")
# Components geom and ed need Eigen; each of the others what it takes its seeds from.
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4)")
set(suggests "")
if(HARDBODY_WITH_SEEDS)
  list(APPEND suggests libfcl-dev libccd-dev)
endif()
if(HARDBODY_WITH_CGAL)
  list(APPEND suggests libcgal-dev)
endif()
list(JOIN suggests ", " CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS)

# Files that Debian requires beyond a plain installation: copyright, compressed manual and changelog.
set(HARDBODY_COPYRIGHT ${PROJECT_BINARY_DIR}/debian-copyright)
set(combined_licence "")
if(HARDBODY_WITH_CGAL)
  set(combined_licence "Comment: The binaries with CGAL's Polytope_distance_d in them, hardbody and\n\
 libhardbody_geom_cgal.a, are as a whole under the terms of the GNU General\n\
 Public License, version 3 or later; see /usr/share/common-licenses/GPL-3.\n")
endif()
file(READ LICENSE licence)
string(REGEX REPLACE "^BSD 3-Clause License\n\nCopyright[^\n]*\n\n" "" licence "${licence}")
string(STRIP "${licence}" licence)
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REGEX REPLACE "\n" "\n " licence "${licence}")
file(CONFIGURE OUTPUT ${HARDBODY_COPYRIGHT} @ONLY CONTENT
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: hardbody

Files: *
Copyright: 2026, the hardbody authors
License: BSD-3-clause
@combined_licence@
License: BSD-3-clause
 @licence@
")
set(CPACK_HARDBODY_COPYRIGHT ${HARDBODY_COPYRIGHT})
set(CPACK_HARDBODY_CHANGELOG ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/HardbodyDebianDocs.cmake)

include(CPack)
