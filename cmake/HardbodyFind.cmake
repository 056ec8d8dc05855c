# hardbody_find(<package> <Debian package> [arguments of find_package]): find_package(REQUIRED) whose error names the
# Debian package.
macro(hardbody_find package debian)
  find_package(${package} ${ARGN} QUIET)
  if(NOT ${package}_FOUND)
    hardbody_missing(${package} ${debian})
  endif()
endmacro()

# hardbody_missing(<what> <Debian package>): stops with a message that says what to install.
function(hardbody_missing what debian)
  message(FATAL_ERROR "hardbody: ${what} is not found (or too old).\n"
    "On Debian: apt-get install ${debian}; `tools/setup --python` installs all that the Python package needs, "
    "`tools/setup` all that the project needs.")
endfunction()

# hardbody_find_compiler(): stops if there is no C++ compiler at all; to be called before project().
function(hardbody_find_compiler)
  if(CMAKE_CXX_COMPILER OR DEFINED ENV{CXX})
    return()
  endif()
  find_program(HARDBODY_CXX NAMES c++ g++ clang++)
  mark_as_advanced(HARDBODY_CXX)
  if(NOT HARDBODY_CXX)
    hardbody_missing("a C++20 compiler (GCC 12 or clang 15, or later)" g++)
  endif()
endfunction()
