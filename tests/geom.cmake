# Tests of this part; see hardbody_test in CMakeLists.txt.
hardbody_test(geom_unit_test unit
  unit/geom/any_shape_test.cpp
  unit/geom/check_support_test.cpp
  unit/geom/enumerator_names_test.cpp
  unit/geom/batch/batch_pairs_test.cpp
  unit/geom/batch/batch_test.cpp
  unit/geom/by_elements_test.cpp
  unit/geom/cores/core_distance_test.cpp
  unit/geom/cores/core_queries_test.cpp
  unit/geom/cores/core_shapes_test.cpp
  unit/geom/cores/capsule_smooth_test.cpp
  unit/geom/cores/polytope_smooth_test.cpp
  unit/geom/cores/exact_side_test.cpp
  unit/geom/cores/half_space_test.cpp
  unit/geom/cores/round_distance_test.cpp
  unit/geom/cores/rotated_hulls_test.cpp
  unit/geom/cores/special_positions_test.cpp
  unit/geom/cores/swept_mass_test.cpp
  unit/geom/cores/polyhedron_test.cpp
  unit/geom/contact_elements_test.cpp
  unit/geom/derivatives/derivatives_test.cpp
  unit/geom/derivatives/flat_faces_test.cpp
  unit/geom/distance_test.cpp
  unit/geom/dual_newton_test.cpp
  unit/geom/ellipsoid_pairs_test.cpp
  unit/geom/ellipsoid_test.cpp
  unit/geom/extreme_input_test.cpp
  unit/geom/batch/lanes_test.cpp
  unit/geom/majorant_test.cpp
  unit/geom/mass_test.cpp
  unit/geom/newton_test.cpp
  unit/geom/obb_test.cpp
  unit/geom/perram_wertheim_test.cpp
  unit/geom/any/placed_test.cpp
  unit/geom/pose_test.cpp
  unit/geom/queries_test.cpp
  unit/geom/ray_cast_test.cpp
  unit/geom/ray_from_afar_test.cpp
  unit/geom/patch/contact_patch_depth_test.cpp
  unit/geom/patch/contact_patch_limits_test.cpp
  unit/geom/patch/contact_patch_test.cpp
  unit/geom/patch/contact_patch_thin_test.cpp
  unit/geom/scene/scene_far_test.cpp
  unit/geom/scene/scene_queries_test.cpp
  unit/geom/scene/scene_pairs_test.cpp
  unit/geom/solids_test.cpp
  unit/geom/sphere_search_test.cpp
  unit/geom/superellipsoid_test.cpp
  unit/geom/user_shape_test.cpp
  unit/geom/warm_start_test.cpp)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  find_package(hwy 1.0 REQUIRED CONFIG)
  target_sources(geom_unit_test PRIVATE unit/geom/batch/batch_roots_test.cpp unit/geom/batch/batch_roots_portable.cpp
    unit/geom/batch/batch_roots_avx2.cpp unit/geom/batch/batch_roots_avx512.cpp)
  target_include_directories(geom_unit_test SYSTEM PRIVATE $<TARGET_PROPERTY:hwy::hwy,INTERFACE_INCLUDE_DIRECTORIES>)
  set_source_files_properties(unit/geom/batch/batch_roots_portable.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_source_files_properties(unit/geom/batch/batch_roots_avx2.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON
    COMPILE_OPTIONS "${hardbody_avx2}")
  set_source_files_properties(unit/geom/batch/batch_roots_avx512.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON
    COMPILE_OPTIONS "${hardbody_avx512}")
else()
  list(APPEND unbuilt_tests unit/geom/batch/batch_roots_test.cpp)
endif()
hardbody_test(geom_allocation_test unit unit/geom/allocation_test.cpp)
hardbody_test(geom_batch_test property property/geom_batch_test.cpp)
hardbody_test(geom_resting_pile_test property property/resting_pile_test.cpp)
hardbody_test(geom_property_test property property/geom_distance_test.cpp
  property/geom_penetration_test.cpp
  property/geom_superellipsoid_depth_test.cpp
  property/geom_superellipsoid_distance_test.cpp)
hardbody_test(geom_accuracy_test accuracy accuracy/geom_cores_table_test.cpp accuracy/geom_distance_test.cpp accuracy/geom_extreme_test.cpp
  accuracy/geom_table_test.cpp)

hardbody_kernel_symbols_test(geom_kernel_symbols hardbody_geom batch/kernel _ZN4geom6kernel[0-9]+batch_kernels_)
# Signs are judged in quadruple precision: double is promoted everywhere, on purpose.
set_source_files_properties(unit/geom/cores/exact_side_test.cpp PROPERTIES
  COMPILE_OPTIONS -Wno-double-promotion SKIP_UNITY_BUILD_INCLUSION ON)
