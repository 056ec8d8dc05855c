# The program as a user meets it: its files, messages and exit statuses.
if(TARGET hardbody)
  # Debian's python3, no modules beyond its own; there may be another one first on the PATH.
  find_program(HARDBODY_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  find_program(HARDBODY_PYTHON python3 REQUIRED)
  add_test(NAME cli_test COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/cli/test_cli.py)
  set_tests_properties(cli_test PROPERTIES LABELS cli TIMEOUT 1200
    ENVIRONMENT "HARDBODY=$<TARGET_FILE:hardbody>;HARDBODY_DEMO=${PROJECT_SOURCE_DIR}/apps/demo.toml")
  add_test(NAME manual_test COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/cli/test_manual.py)
  set_tests_properties(manual_test PROPERTIES LABELS cli TIMEOUT 60 ENVIRONMENT "HARDBODY=$<TARGET_FILE:hardbody>")

  hardbody_test(program_test cli cli/program_test.cpp)
  target_link_libraries(program_test PRIVATE hardbody_program)
  target_compile_definitions(program_test PRIVATE HARDBODY_PROGRAM="$<TARGET_FILE:hardbody>")
  add_dependencies(program_test hardbody)
else()
  list(APPEND unbuilt_tests cli/program_test.cpp)
endif()
