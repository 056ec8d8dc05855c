cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

# Makes the Debian packages of a build tree, looks at what is in them, unpacks them to a temporary directory, runs the
# program there and builds the outside project against the libraries.
#
#   cmake -DBUILD_DIR=... -DWORK_DIR=... -DVERSION=0.1.0 -DCOMPILER=... -P deb.cmake
set(root ${WORK_DIR}/root)
file(REMOVE_RECURSE ${WORK_DIR})
must(${CMAKE_CPACK_COMMAND} --config ${BUILD_DIR}/CPackConfig.cmake -G DEB -B ${WORK_DIR}/packages)

function(must_match what text)
  foreach(pattern IN LISTS ARGN)
    if(NOT text MATCHES "${pattern}")
      message(SEND_ERROR "${what}: no \"${pattern}\" in\n${text}")
    endif()
  endforeach()
endfunction()

foreach(name hardbody libhardbody-dev)
  file(GLOB package_${name} ${WORK_DIR}/packages/${name}_${VERSION}-*.deb)
  list(LENGTH package_${name} count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "${count} packages ${name}; wanted: one")
  endif()
  set(file ${package_${name}})
  must_print(control dpkg-deb --field ${file})
  must_print(content dpkg-deb --contents ${file})
  message(STATUS "${control}\n${content}")
  must_match(${name} "${control}" "Package: ${name}\n" "Version: ${VERSION}-" "Maintainer: [^\n]+ <[^\n]+>"
    "Description: [^\n]+\n [^\n]+")
  # Debian policy, 3.4.1: at most 80 characters.
  string(REGEX MATCH "Description: ([^\n]+)" unused "${control}")
  string(LENGTH "${CMAKE_MATCH_1}" length)
  if(length GREATER 80)
    message(SEND_ERROR "${name}: a synopsis of ${length} characters")
  endif()
  must_match(${name} "${content}" "\\./usr/share/doc/${name}/copyright\n" "\\./usr/share/doc/${name}/changelog\\.gz\n"
    "\\./usr/share/doc/${name}/changelog\\.Debian\\.gz\n")
  # Everything under /usr, owned by root, writable by nobody else, no directory without permission to enter.
  string(REGEX REPLACE "\n$" "" lines "${content}")
  string(REPLACE "\n" ";" lines "${lines}")
  foreach(line IN LISTS lines)
    if(NOT line MATCHES "^(drwxr-xr-x|-rwxr-xr-x|-rw-r--r--) root/root .* \\./usr/")
      message(SEND_ERROR "${name}: ${line}")
    endif()
  endforeach()
  must(dpkg-deb --extract ${file} ${root})
endforeach()

must_print(control dpkg-deb --field ${package_hardbody})
must_match(hardbody "${control}" "Depends: [^\n]*libc6 \\(>= " "Depends: [^\n]*libstdc\\+\\+6 \\(>= ")
must_print(control dpkg-deb --field ${package_libhardbody-dev})
must_match(libhardbody-dev "${control}" "Depends: libeigen3-dev")
must_print(content dpkg-deb --contents ${package_libhardbody-dev})
if(content MATCHES "/bin/|/man/")
  message(SEND_ERROR "libhardbody-dev holds a program or a manual")
endif()

must_print(version ${root}/usr/bin/hardbody --version)
must_match("hardbody --version" "${version}" "^hardbody ${VERSION}\n")
must(gzip --test ${root}/usr/share/man/man1/hardbody.1.gz)
must_print(page gzip --decompress --stdout ${root}/usr/share/man/man1/hardbody.1.gz)
must_match(hardbody.1 "${page}" "\\.Dt HARDBODY 1\n")

set(PREFIX ${root}/usr)
set(COMPONENTS geom,ed)
set(HIDDEN fcl,ccd,octomap,CGAL)
# Shows that the libraries and all headers are there. What they answer is tested by package_static_geom and .._geom_ed.
build_consumer(${WORK_DIR}/build "${FLAGS}" no_exceptions quickstart user_shapes ed)
