# Our results against other libraries'; see hardbody_test in CMakeLists.txt. HARDBODY_FULL=1 raises the counts. Whatever
# may end the process runs in a child of its own (common/forked.h). Without those libraries, the tests are left out.
if(HARDBODY_WITH_SEEDS)
  find_package(fcl CONFIG REQUIRED)
  # FCL without our checks, in its own translation unit: without -march, with which the layout of its objects changes.
  add_library(fcl_raw STATIC oracle/fcl_raw.cpp)
  hardbody_target(fcl_raw BASELINE)
  target_include_directories(fcl_raw PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(fcl_raw PUBLIC hardbody::geom PRIVATE fcl)

  hardbody_test(oracle_fcl_distance_test oracle oracle/fcl_distance_test.cpp)
  target_link_libraries(oracle_fcl_distance_test PRIVATE fcl_raw)
else()
  list(APPEND unbuilt_tests oracle/fcl_distance_test.cpp)
endif()
if(HARDBODY_WITH_SEEDS AND HARDBODY_WITH_CGAL)
  hardbody_test(oracle_seeds_test oracle oracle/seeds_test.cpp)
  target_link_libraries(oracle_seeds_test PRIVATE hardbody::geom_seeds hardbody::geom_cgal)
else()
  list(APPEND unbuilt_tests oracle/seeds_test.cpp)
endif()
