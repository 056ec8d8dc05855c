cmake_minimum_required(VERSION 3.25)

# Installs a build tree to a temporary prefix, and configures, builds and runs an outside project against it.
#
#   cmake -DBUILD_DIR=... -DWORK_DIR=... -DCOMPONENTS=geom,ed -DFLAGS=... -DCOMPILER=... -P run.cmake
set(prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${WORK_DIR})

function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${status}): ${command}")
  endif()
endfunction()

must(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
must(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK_DIR}/build "-DCOMPONENTS=${COMPONENTS}"
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
must(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
must(${WORK_DIR}/build/geom_consumer)
if(COMPONENTS MATCHES "geom_seeds")
  must(${WORK_DIR}/build/seeds_consumer)
endif()
if(COMPONENTS MATCHES "(^|,)ed(,|$)")
  must(${WORK_DIR}/build/ed_consumer)
endif()
