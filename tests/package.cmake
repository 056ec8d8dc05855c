# The installed package as an outside project meets it. FLAGS: a consumer may compile with another -march than the
# libraries were built with.
set(consumer_flags "")
if(HARDBODY_SANITIZE)
  set(consumer_flags "-fsanitize=${HARDBODY_SANITIZE}")
endif()
function(hardbody_package_test name components flags)
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -DBUILD_DIR=${PROJECT_BINARY_DIR}
    -DWORK_DIR=${CMAKE_CURRENT_BINARY_DIR}/${name} "-DCOMPONENTS=${components}" -DCOMPILER=${CMAKE_CXX_COMPILER}
    "-DFLAGS=${consumer_flags} ${flags}" -P ${CMAKE_CURRENT_SOURCE_DIR}/package/run.cmake)
  set_tests_properties(${name} PROPERTIES LABELS package TIMEOUT 300
    RESOURCE_LOCK install)  # all install from the same build tree
endfunction()

hardbody_package_test(package_geom_and_ed "geom,ed" "")
hardbody_package_test(package_geom_alone "geom" "")
hardbody_package_test(package_other_march "geom,ed" "-march=native")
if(HARDBODY_WITH_SEEDS AND HARDBODY_WITH_CGAL)
  hardbody_package_test(package_seeds "geom,geom_seeds,geom_cgal" "")
endif()
