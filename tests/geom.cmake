# Tests of this part; see hardbody_test in CMakeLists.txt.
hardbody_test(geom_unit_test unit
  unit/enumerator_names_test.cpp
  unit/geom_batch_test.cpp
  unit/geom_by_elements_test.cpp
  unit/geom_contact_elements_test.cpp
  unit/geom_distance_test.cpp
  unit/geom_dual_newton_test.cpp
  unit/geom_ellipsoid_pairs_test.cpp
  unit/geom_ellipsoid_test.cpp
  unit/geom_extreme_input_test.cpp
  unit/geom_lanes_test.cpp
  unit/geom_majorant_test.cpp
  unit/geom_mass_test.cpp
  unit/geom_newton_test.cpp
  unit/geom_obb_test.cpp
  unit/geom_perram_wertheim_test.cpp
  unit/geom_pose_test.cpp
  unit/geom_queries_test.cpp
  unit/geom_ray_from_afar_test.cpp
  unit/geom_sphere_search_test.cpp
  unit/geom_superellipsoid_test.cpp
  unit/geom_user_shape_test.cpp)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  find_package(hwy 1.0 REQUIRED CONFIG)
  target_sources(geom_unit_test PRIVATE unit/geom_batch_roots.cpp unit/geom_batch_roots_test.cpp)
  target_include_directories(geom_unit_test SYSTEM PRIVATE $<TARGET_PROPERTY:hwy::hwy,INTERFACE_INCLUDE_DIRECTORIES>)
  set_source_files_properties(unit/geom_batch_roots.cpp PROPERTIES COMPILE_OPTIONS "${hardbody_avx512}")
else()
  list(APPEND unbuilt_tests unit/geom_batch_roots_test.cpp)
endif()
hardbody_test(geom_allocation_test unit unit/geom_allocation_test.cpp)
hardbody_test(geom_batch_test property property/geom_batch_test.cpp)
hardbody_test(geom_property_test property property/geom_distance_test.cpp
  property/geom_penetration_test.cpp
  property/geom_superellipsoid_distance_test.cpp)
hardbody_test(geom_accuracy_test accuracy accuracy/geom_distance_test.cpp accuracy/geom_extreme_test.cpp
  accuracy/geom_table_test.cpp)

hardbody_kernel_symbols_test(geom_kernel_symbols hardbody_geom batch_kernel _ZN4geom8internal[0-9]+batch_kernels_)
