# Tests of this part; see hardbody_test in CMakeLists.txt. HARDBODY_FULL=1 in the environment raises the counts of the
# property tests tenfold, of support_contact fiftyfold.
hardbody_test(finder_unit_test unit
  unit/calendar_test.cpp
  unit/cell_grid_test.cpp
  unit/certified_contact_test.cpp
  unit/contact_budget_test.cpp
  unit/elliptic_test.cpp
  unit/first_looks_test.cpp
  unit/free_top_test.cpp
  unit/general_contact_test.cpp
  unit/impulse_test.cpp
  unit/meetings_test.cpp
  unit/motion_test.cpp
  unit/neighbour_lists_test.cpp
  unit/random_test.cpp
  unit/sincos_test.cpp
  unit/time_of_contact_test.cpp)
hardbody_test(finder_curvature_bound_test property property/curvature_bound_test.cpp)
hardbody_test(finder_missed_contacts_test property property/missed_contacts_test.cpp)
hardbody_test(finder_rounding_test property property/rounding_test.cpp)
# It judges in quadruple precision: double is promoted everywhere, on purpose.
set_source_files_properties(property/rounding_test.cpp PROPERTIES COMPILE_OPTIONS -Wno-double-promotion)
hardbody_test(finder_bracketing_test property property/bracketing_test.cpp)
hardbody_test(finder_support_contact_test property property/support_contact_test.cpp)
