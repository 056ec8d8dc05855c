# Tests of this part; see hardbody_test in CMakeLists.txt.
hardbody_test(geom_unit_test unit
  unit/geom_distance_test.cpp
  unit/geom_dual_newton_test.cpp
  unit/geom_ellipsoid_test.cpp
  unit/geom_newton_test.cpp
  unit/geom_obb_test.cpp
  unit/geom_perram_wertheim_test.cpp
  unit/geom_pose_test.cpp
  unit/geom_superellipsoid_test.cpp
  unit/geom_user_shape_test.cpp)
hardbody_test(geom_property_test property property/geom_distance_test.cpp
  property/geom_superellipsoid_distance_test.cpp)
hardbody_test(geom_accuracy_test accuracy accuracy/geom_distance_test.cpp)
