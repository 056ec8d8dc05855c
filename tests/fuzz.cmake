# Fuzzing: tests/fuzz/<name>_fuzz.cpp is a libFuzzer target, built with HARDBODY_FUZZ (clang; preset "fuzz"). Everywhere
# else the same code runs over the corpus that libFuzzer starts from, and random changes of it: a smoke test.
#
#     cmake --preset fuzz && cmake --build --preset fuzz
#     python3 tests/fuzz/make_corpus.py corpus
#     build/fuzz/tests/line_fuzz -entropic=0 -dict=tests/fuzz/line.dict -max_len=1024 -runs=10000000 corpus/line
#     build/fuzz/tests/geom_fuzz -entropic=0 -max_len=192 -runs=10000000 corpus/geom
#     build/fuzz/tests/scene_fuzz -entropic=0 -max_len=256 -runs=10000000 corpus/scene
#     build/fuzz/tests/checkpoint_fuzz -max_len=512 -runs=1000000 corpus/checkpoint
#     build/fuzz/tests/gsd_fuzz -max_len=2048 -runs=1000000 corpus/gsd
#     build/fuzz/tests/lammps_fuzz -max_len=2048 -runs=1000000 corpus/lammps
#
# (libFuzzer's entropic scheduling would take a quarter of the time.)
function(hardbody_fuzzer name)
  add_library(${name}_fuzz_target OBJECT fuzz/${name}_fuzz.cpp)
  hardbody_target(${name}_fuzz_target)
  target_include_directories(${name}_fuzz_target PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${name}_fuzz_target PUBLIC hardbody::geom ${ARGN})

  add_executable(${name}_fuzz_replay fuzz/replay.cpp)
  hardbody_target(${name}_fuzz_replay)
  target_link_libraries(${name}_fuzz_replay PRIVATE ${name}_fuzz_target)
  add_test(NAME ${name}_fuzz_replay COMMAND ${name}_fuzz_replay ${CMAKE_CURRENT_BINARY_DIR}/corpus/${name} 50)
  set_tests_properties(${name}_fuzz_replay PROPERTIES LABELS unit FIXTURES_REQUIRED fuzz_corpus TIMEOUT 600)
  hardbody_needed_by(unit ${name}_fuzz_replay)

  if(HARDBODY_FUZZ)
    add_executable(${name}_fuzz $<TARGET_OBJECTS:${name}_fuzz_target>)
    target_link_libraries(${name}_fuzz PRIVATE ${name}_fuzz_target -fsanitize=fuzzer)
  endif()
endfunction()

if(HARDBODY_FUZZ AND NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "HARDBODY_FUZZ is for clang, which has libFuzzer; CMAKE_CXX_COMPILER is ${CMAKE_CXX_COMPILER}")
endif()
find_program(HARDBODY_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(HARDBODY_PYTHON python3 REQUIRED)
add_test(NAME fuzz_corpus COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/make_corpus.py
  ${CMAKE_CURRENT_BINARY_DIR}/corpus)
set_tests_properties(fuzz_corpus PROPERTIES LABELS unit FIXTURES_SETUP fuzz_corpus)

hardbody_fuzzer(geom)
hardbody_fuzzer(scene hardbody::ed)
if(TARGET hardbody_program)
  hardbody_fuzzer(line hardbody_program nlohmann_json::nlohmann_json)
  hardbody_fuzzer(checkpoint hardbody_program)
  hardbody_fuzzer(gsd hardbody_program)
  hardbody_fuzzer(lammps hardbody_program)
endif()
