# Kernels for several instruction sets (docs/decisions/008-batches.md).

# Exactly what find_kernels in libgeom/src/batch/batch.cpp asks the processor for. They come behind HARDBODY_ARCH.
set(hardbody_avx2 -mavx2 -mfma -mbmi -mbmi2)
set(hardbody_avx512 ${hardbody_avx2} -mavx512f -mavx512vl -mavx512dq -mavx512bw)

# hardbody_kernels(<target> <kernel>) adds src/<kernel>_portable.cpp and, on x86-64, src/<kernel>_avx2.cpp and
# src/<kernel>_avx512.cpp, each compiled for its instruction set. Sources that ask the processor for them find them
# where __x86_64__ is defined.
#
# Only headers of Highway are used: linking hwy::hwy, even privately, would make consumers of the static libraries look
# for it.
function(hardbody_kernels target kernel)
  hardbody_find(hwy libhwy-dev 1.0 CONFIG)
  target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:hwy::hwy,INTERFACE_INCLUDE_DIRECTORIES>)
  target_sources(${target} PRIVATE src/${kernel}_portable.cpp)
  set_source_files_properties(src/${kernel}_portable.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(HARDBODY_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Optimising vectors of loops with all that the sanitizers add takes ten minutes.
    set_source_files_properties(src/${kernel}_portable.cpp PROPERTIES COMPILE_OPTIONS -O0)
  endif()
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    return()
  endif()
  target_sources(${target} PRIVATE src/${kernel}_avx2.cpp src/${kernel}_avx512.cpp)
  set_source_files_properties(src/${kernel}_avx2.cpp PROPERTIES COMPILE_OPTIONS "${hardbody_avx2}")
  set_source_files_properties(src/${kernel}_avx512.cpp PROPERTIES COMPILE_OPTIONS "${hardbody_avx512}")
endfunction()
