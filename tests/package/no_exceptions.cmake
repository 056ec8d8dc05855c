# libgeom compiles with -fno-exceptions; what it would throw it then writes to standard error, and aborts.
#
#   cmake -DSOURCE_DIR=... -DEIGEN_DIR=... -DWORK_DIR=... -DCOMPILER=... -P no_exceptions.cmake
cmake_minimum_required(VERSION 3.25)
file(MAKE_DIRECTORY ${WORK_DIR})
set(compile ${COMPILER} -std=c++20 -fno-exceptions -I${SOURCE_DIR}/libgeom/include -I${SOURCE_DIR}/libgeom/src
  -isystem ${EIGEN_DIR})

include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

# All sources as one, to read Eigen once.
file(GLOB_RECURSE sources ${SOURCE_DIR}/libgeom/src/*.cpp)
list(FILTER sources EXCLUDE REGEX "batch/kernel_")  # Highway's
if(NOT sources)
  message(FATAL_ERROR "no sources in ${SOURCE_DIR}/libgeom/src")
endif()
set(text "")
foreach(source IN LISTS sources)
  string(APPEND text "#include \"${source}\"\n")
endforeach()
file(WRITE ${WORK_DIR}/sources.cpp "${text}")
must(${compile} -fsyntax-only ${WORK_DIR}/sources.cpp)

file(WRITE ${WORK_DIR}/main.cpp "#include <geom/ellipsoid.h>
int main(int argc, char**) { return geom::Ellipsoid({1.0, 2.0, argc == 1 ? 3.0 : -3.0}).bounding_radius() != 3.0; }\n")
must(${compile} ${WORK_DIR}/main.cpp ${SOURCE_DIR}/libgeom/src/shapes/ellipsoid.cpp ${SOURCE_DIR}/libgeom/src/shapes/refuse.cpp
  -o ${WORK_DIR}/program)
must(${WORK_DIR}/program)
execute_process(COMMAND ${WORK_DIR}/program bad RESULT_VARIABLE status ERROR_VARIABLE message)
if(status EQUAL 0 OR NOT message MATCHES "hardbody: Ellipsoid: semi-axis z is -3; accepted: ")
  message(FATAL_ERROR "wanted: the message and an abort; got ${status}: ${message}")
endif()
