# Compile options that every target of this project shares.
#
# hardbody_target(<target> [BASELINE] [COLD]) applies them; BASELINE leaves HARDBODY_ARCH out, COLD takes -O1, for code
# where no time is spent, which compiles in a quarter less time than with -O2. None of them is exported: a consumer
# compiles with its own flags, which is safe because no object that inline functions share depends on -march
# (docs/decisions/017). With HARDBODY_SANITIZE_FAST targets that are COMPILED_ONLY are not instrumented, and those that
# are NUMERICAL are optimised (-O1).

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES AND PROJECT_IS_TOP_LEVEL)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(HARDBODY_CCACHE ccache)
if(HARDBODY_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND PROJECT_IS_TOP_LEVEL)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${HARDBODY_CCACHE})
endif()

# Shared libraries are found from each other and from the program wherever the prefix is moved to.
if(BUILD_SHARED_LIBS AND NOT DEFINED CMAKE_INSTALL_RPATH)
  set(CMAKE_INSTALL_RPATH "$ORIGIN;$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
endif()

function(hardbody_target target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "BASELINE;COLD;COMPILED_ONLY;NUMERICAL" "" "")
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON
    # Static and shared libraries are made of the same object files: no macro tells them apart, and ccache knows them.
    DEFINE_SYMBOL "")
  target_compile_options(${target} PRIVATE
    # No contraction: the same source gives the same bits with and without FMA in the instruction set.
    -ffp-contract=off
    # Nobody reads errno or the floating-point flags; without these sqrt is a call.
    -fno-math-errno -fno-trapping-math
    $<$<BOOL:${HARDBODY_WERROR}>:-Werror>
    # GCC collects its garbage from 0.5 GB on instead of 0.13: a tenth of its time.
    $<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=524288>
    # RelWithDebInfo is -O2 by default; the kernels want -O3 there too.
    $<$<CONFIG:Release,RelWithDebInfo>:$<IF:$<BOOL:${arg_COLD}>,-O1,-O3>>)
  if(HARDBODY_WARNINGS)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
      -Wdouble-promotion -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast)
  else()
    target_compile_options(${target} PRIVATE -w)
  endif()
  if(HARDBODY_ARCH AND NOT arg_BASELINE)
    target_compile_options(${target} PRIVATE -march=${HARDBODY_ARCH})
  endif()
  if(HARDBODY_SANITIZE AND HARDBODY_SANITIZE_FAST AND arg_NUMERICAL)
    target_compile_options(${target} PRIVATE -O1)
  endif()
  if(HARDBODY_SANITIZE AND HARDBODY_SANITIZE_FAST AND arg_COMPILED_ONLY)
    target_compile_options(${target} PRIVATE -g0)
    target_link_options(${target} PUBLIC -fsanitize=${HARDBODY_SANITIZE})
  elseif(HARDBODY_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${HARDBODY_SANITIZE} -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${HARDBODY_SANITIZE})
  endif()
endfunction()

set(HARDBODY_UNITY_BATCH 16 CACHE STRING "Sources of the program and of the extension in a group, with HARDBODY_UNITY")
set(HARDBODY_UNITY_TESTS_BATCH 8 CACHE STRING "Sources of a test program in a group, with HARDBODY_UNITY")
set(HARDBODY_UNITY_LIBRARY_BATCH 8 CACHE STRING "Sources of the libraries in a group, with HARDBODY_UNITY=ALL")

# hardbody_grouped(<target> [LIBRARY | TESTS]): compiles its sources in groups, so that Eigen and the kernels are read
# and instantiated once for all of a group; those of the program, of the extension and of the tests with
# HARDBODY_UNITY=ON, those of the libraries only with HARDBODY_UNITY=ALL (docs/decisions/031).
function(hardbody_grouped target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "LIBRARY;TESTS" "" "")
  if(HARDBODY_UNITY STREQUAL "ALL" OR (HARDBODY_UNITY AND NOT arg_LIBRARY))
    set(batch ${HARDBODY_UNITY_BATCH})
    if(arg_TESTS)
      set(batch ${HARDBODY_UNITY_TESTS_BATCH})
    elseif(arg_LIBRARY)
      set(batch ${HARDBODY_UNITY_LIBRARY_BATCH})
      # GCC takes the anonymous namespace of a source that is included for one of a header.
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
  endif()
endfunction()
