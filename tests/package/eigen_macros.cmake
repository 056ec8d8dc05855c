# Headers refuse macros of Eigen's with which matrices are laid out otherwise than in the libraries, and take those that
# do not matter.
#
#   cmake -DSOURCE_DIR=... -DEIGEN_DIR=... -DWORK_DIR=... -DCOMPILER=... -P eigen_macros.cmake
cmake_minimum_required(VERSION 3.25)
file(MAKE_DIRECTORY ${WORK_DIR})

# compile(<name> <text> <flag>...): sets `status` and `errors`.
function(compile name text)
  file(WRITE ${WORK_DIR}/${name}.cpp "${text}")
  execute_process(COMMAND ${COMPILER} -std=c++20 -fsyntax-only ${ARGN} -I${SOURCE_DIR}/libgeom/include
    -I${SOURCE_DIR}/libgeom/seeds/include -I${SOURCE_DIR}/libed/include -isystem ${EIGEN_DIR} ${WORK_DIR}/${name}.cpp
    RESULT_VARIABLE status ERROR_VARIABLE errors)
  set(status ${status} PARENT_SCOPE)
  set(errors "${errors}" PARENT_SCOPE)
endfunction()

function(must_refuse name text wanted)
  compile(${name} "${text}" ${ARGN})
  if(status EQUAL 0 OR NOT errors MATCHES "hardbody: ${wanted}")
    message(FATAL_ERROR "${name}: wanted a compile error that says \"hardbody: ${wanted}\"; got ${status}\n${errors}")
  endif()
endfunction()

# Every public header, alone.
file(GLOB headers RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/libgeom/include/geom/*.h
  ${SOURCE_DIR}/libgeom/seeds/include/geom/*.h ${SOURCE_DIR}/libed/include/ed/*.h)
foreach(header IN LISTS headers)
  string(REGEX REPLACE "^.*/include/" "" included ${header})
  if(NOT included MATCHES "(tolerances|arithmetic).h$")  # numbers
    string(MAKE_C_IDENTIFIER ${included} name)
    must_refuse(${name} "#include <${included}>\n" "EIGEN_DEFAULT_TO_ROW_MAJOR is defined" -DEIGEN_DEFAULT_TO_ROW_MAJOR
      -Wfatal-errors)
  endif()
endforeach()

must_refuse(earlier "#define EIGEN_DEFAULT_TO_ROW_MAJOR\n#include <Eigen/Core>\n#undef EIGEN_DEFAULT_TO_ROW_MAJOR
#include <geom/pose.h>\n" "Eigen::Matrix3d is row-major")
file(WRITE ${WORK_DIR}/members.h "double one_more;\n")
must_refuse(plugin "#include <geom/pose.h>\n" "Eigen::Vector3d or Eigen::Matrix3d is not laid out"
  "-DEIGEN_MATRIX_PLUGIN=\"${WORK_DIR}/members.h\"")
foreach(macro EIGEN_DONT_ALIGN EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=0 EIGEN_DONT_VECTORIZE)
  compile(harmless "#include <geom/pose.h>\n" -D${macro})
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "-D${macro} is refused:\n${errors}")
  endif()
endforeach()
