# The HTML report, as a browser shows it. Debian's chromium, chromium-driver and python3-selenium (tools/setup).
if(TARGET hardbody)
  # The program as it is where there was no npm: its own objects, with a front end that is empty.
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/empty.txt)
  set(no_front_end ${CMAKE_CURRENT_BINARY_DIR}/no_front_end.cpp)
  file(WRITE ${empty} "")
  set(report_source ${PROJECT_SOURCE_DIR}/apps/report)
  add_custom_command(OUTPUT ${no_front_end}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${no_front_end} -DHEADER=report/assets.h
      -DNAMES=report_script,report_style,report_static_style -Dreport_script=${empty} -Dreport_style=${empty}
      -Dreport_static_style=${report_source}/src/base.css -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
    DEPENDS ${report_source}/src/base.css ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
  add_executable(hardbody_static_report $<TARGET_OBJECTS:hardbody> ${no_front_end})
  hardbody_target(hardbody_static_report)
  target_link_libraries(hardbody_static_report PRIVATE hardbody_command_line)
  hardbody_needed_by(report hardbody hardbody_static_report)

  hardbody_test(report_test report report/report_test.cpp)
  target_link_libraries(report_test PRIVATE hardbody_program nlohmann_json::nlohmann_json)

  # One entry for all pages: they share runs, and a browser, which takes long to start.
  add_test(NAME report_pages COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/report/test_report.py)
  set_tests_properties(report_pages PROPERTIES LABELS report TIMEOUT 1800 COST 200
    ENVIRONMENT "HARDBODY=$<TARGET_FILE:hardbody>;HARDBODY_STATIC=$<TARGET_FILE:hardbody_static_report>;HARDBODY_INTERACTIVE=$<BOOL:${HARDBODY_REPORT_IS_INTERACTIVE}>")
else()
  list(APPEND unbuilt_tests report/report_test.cpp)
endif()
