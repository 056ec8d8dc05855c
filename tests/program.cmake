# The program as a user meets it: its files, messages and exit statuses.
if(TARGET hardbody)
  # Debian's python3 and its packages; there may be another one first on the PATH.
  find_program(HARDBODY_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  find_program(HARDBODY_PYTHON python3 REQUIRED)
  # One entry a class, so that they run side by side; every class of the files but the bases has one.
  set(cli_environment "HARDBODY=$<TARGET_FILE:hardbody>;HARDBODY_DEMO=${PROJECT_SOURCE_DIR}/apps/demo.toml")
  # Sanitizers want to be preloaded before anything else.
  if(NOT HARDBODY_SANITIZE)
    add_library(cli_clock MODULE cli/clock.cpp)
    hardbody_target(cli_clock)
    list(APPEND cli_environment "HARDBODY_CLOCK=$<TARGET_FILE:cli_clock>")
    hardbody_needed_by(cli cli_clock)
  endif()
  foreach(file test_cli test_check test_checks test_restart test_extend test_trajectory test_reading test_cases test_conventions test_shapes test_kinds test_queries
          test_starts test_mdanalysis test_sweep test_replicas test_paper test_quickstart)
    set(cli_tests ${CMAKE_CURRENT_SOURCE_DIR}/cli/${file}.py)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${cli_tests})
    file(STRINGS ${cli_tests} class_lines REGEX "^class ")
    foreach(line IN LISTS class_lines)
      string(REGEX MATCH "^class ([A-Za-z0-9_]+)" name "${line}")
      set(name ${CMAKE_MATCH_1})
      if(name MATCHES "^(Case|Restart|Extending|Frames|Trajectories|FilesCase|Analyses|StartCase|Way|SweepCase|Here|KindsCase)$")
        continue()
      endif()
      add_test(NAME cli_${name} COMMAND ${HARDBODY_PYTHON} ${cli_tests} ${name})
      set_tests_properties(cli_${name} PROPERTIES LABELS cli TIMEOUT 1200 ENVIRONMENT "${cli_environment}")
      if(name MATCHES "^(Kills|Killed|Stops|Faults|Resumed|Shapes)$")  # long, and mostly asleep: begun first
        set_tests_properties(cli_${name} PROPERTIES COST 100)
      endif()
    endforeach()
  endforeach()
  hardbody_needed_by(cli hardbody)
  add_test(NAME trajectory_fuzz COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/trajectories.py --inputs 100
    --keep ${CMAKE_CURRENT_BINARY_DIR}/trajectory_fuzz)
  set_tests_properties(trajectory_fuzz PROPERTIES LABELS cli TIMEOUT 600 ENVIRONMENT "HARDBODY=$<TARGET_FILE:hardbody>")
  add_test(NAME manual_test COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/cli/test_manual.py)
  set_tests_properties(manual_test PROPERTIES LABELS cli TIMEOUT 60 ENVIRONMENT "HARDBODY=$<TARGET_FILE:hardbody>")

  hardbody_test(sweep_test unit unit/app/sweep_test.cpp unit/app/replicas_test.cpp unit/app/config_keys_test.cpp
    unit/app/guest_test.cpp)
  target_link_libraries(sweep_test PRIVATE hardbody_program)

  hardbody_test(registry_test unit unit/app/registry_test.cpp)
  target_link_libraries(registry_test PRIVATE hardbody_program nlohmann_json::nlohmann_json)
  target_compile_definitions(registry_test PRIVATE HARDBODY_DOCS="${PROJECT_SOURCE_DIR}/docs")

  hardbody_test(program_test cli cli/program_test.cpp cli/checkpoint_test.cpp cli/check_test.cpp
    cli/events_file_test.cpp)
  target_link_libraries(program_test PRIVATE hardbody_program)
  target_compile_definitions(program_test PRIVATE HARDBODY_PROGRAM="$<TARGET_FILE:hardbody>"
    HARDBODY_OLD_CHECKPOINT="${CMAKE_CURRENT_SOURCE_DIR}/cli/checkpoint_v1.bin")
  add_dependencies(program_test hardbody)

  hardbody_test(trajectory_test cli cli/trajectory_test.cpp)
  target_link_libraries(trajectory_test PRIVATE hardbody_program)
else()
  list(APPEND unbuilt_tests cli/program_test.cpp cli/checkpoint_test.cpp cli/check_test.cpp cli/events_file_test.cpp
    cli/trajectory_test.cpp unit/app/registry_test.cpp unit/app/sweep_test.cpp unit/app/replicas_test.cpp
    unit/app/config_keys_test.cpp unit/app/guest_test.cpp)
endif()
