cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

# Configures, builds and runs an outside project against the package installed in PREFIX.
#
#   cmake -DPREFIX=... -DWORK_DIR=... -DCOMPONENTS=geom,ed -DPROGRAMS=quickstart,ed -DFLAGS=... -DCOMPILER=... -P run.cmake
#
# PROGRAMS: those of the project to build and run. OPTIONAL=geom_seeds: components that may be missing. HIDDEN=fcl,ccd:
# packages that cannot be found. REFUSED=text: find_package must fail, with that in its message.
# OTHER_FLAGS, COMPARED=geom: that program is built a second time, with these flags, and must give the same answers, bit for
# bit. HARDBODY_FULL=1: all of PROGRAMS are built and run with these flags, too.
# UNNEEDED=regex: what the dynamic linker must not load with the project's programs.
file(REMOVE_RECURSE ${WORK_DIR})
if(REFUSED)
  configure_consumer(status ${WORK_DIR}/build "${FLAGS}")
  string(REGEX REPLACE "[ \n]+" " " message "${configure_errors}")
  if(status EQUAL 0 OR NOT message MATCHES "${REFUSED}")
    message(FATAL_ERROR "wanted: a refusal that says \"${REFUSED}\"")
  endif()
  return()
endif()

string(REPLACE "," ";" PROGRAMS "${PROGRAMS}")
build_consumer(${WORK_DIR}/build "${FLAGS}" ${PROGRAMS})
if(UNNEEDED)
  foreach(program IN LISTS PROGRAMS)
    must_print(loaded ldd ${WORK_DIR}/build/${program}_consumer)
    message(STATUS "${program}_consumer loads\n${loaded}")
    if(loaded MATCHES "${UNNEEDED}")
      message(FATAL_ERROR "${program}_consumer loads ${CMAKE_MATCH_0}")
    endif()
  endforeach()
endif()
if(OTHER_FLAGS)
  set(others ${COMPARED})
  if("$ENV{HARDBODY_FULL}" STREQUAL "1")
    set(others ${PROGRAMS})
  endif()
  build_consumer(${WORK_DIR}/other "${FLAGS} ${OTHER_FLAGS}" ${others})
  set(program ${COMPARED}_consumer)
  must_print(wanted ${WORK_DIR}/build/${program} answers)
  must_print(got ${WORK_DIR}/other/${program} answers)
  string(LENGTH "${wanted}" length)
  if(length LESS 1000 OR NOT got STREQUAL wanted)
    file(WRITE ${WORK_DIR}/${program}.wanted "${wanted}")
    file(WRITE ${WORK_DIR}/${program}.got "${got}")
    message(FATAL_ERROR "${program} answers otherwise with ${OTHER_FLAGS}: diff ${WORK_DIR}/${program}.{wanted,got}")
  endif()
endif()
