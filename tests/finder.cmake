# Tests of this part; see hardbody_test in CMakeLists.txt. HARDBODY_FULL=1 in the environment raises the counts of the
# property tests tenfold, of support_contact fiftyfold.
hardbody_test(finder_unit_test unit
  unit/ed/loop/calendar_test.cpp
  unit/ed/cells/grid_test.cpp
  unit/ed/cells/levels_test.cpp
  unit/ed/contact/certified_test.cpp
  unit/ed/contact/contact_budget_test.cpp
  unit/ed/contact/core_kinds_test.cpp
  unit/ed/contact/contact_refusals_test.cpp
  unit/ed/contact/contact_scenes_test.cpp
  unit/ed/motion/axis_motion_test.cpp
  unit/ed/motion/elliptic_test.cpp
  unit/ed/bodies/first_looks_test.cpp
  unit/ed/motion/free_top_test.cpp
  unit/ed/motion/free_top_limits_test.cpp
  unit/ed/motion/textbook_top_test.cpp
  unit/ed/contact/general_contact_test.cpp
  unit/ed/contact/given_contact_test.cpp
  unit/ed/contact/scene_contact_test.cpp
  unit/ed/motion/given_motion_test.cpp
  unit/ed/motion/impulse_test.cpp
  unit/ed/vectors/overlapping_envelopes_test.cpp
  unit/ed/vectors/displacements_test.cpp
  unit/ed/vectors/products_test.cpp
  unit/ed/bodies/rotations_test.cpp
  unit/ed/motion/motion_test.cpp
  unit/ed/neighbours/lists_test.cpp
  unit/ed/base/random_test.cpp
  unit/ed/base/sincos_test.cpp
  unit/ed/contact/time_of_contact_test.cpp)
hardbody_test(finder_curvature_bound_test property property/curvature_bound_test.cpp)
hardbody_test(finder_missed_contacts_test property property/missed_contacts_test.cpp)
hardbody_test(finder_rounding_test property property/rounding_test.cpp)
# It judges in quadruple precision: double is promoted everywhere, on purpose.
set_source_files_properties(property/rounding_test.cpp PROPERTIES COMPILE_OPTIONS -Wno-double-promotion)
hardbody_test(finder_bracketing_test property property/bracketing_test.cpp)
hardbody_test(finder_convex_contact_test property property/convex_contact_test.cpp property/mixed_contact_test.cpp
  property/rod_contact_test.cpp)
hardbody_test(finder_given_contact_test property property/given_contact_test.cpp)
hardbody_test(finder_support_contact_test property property/support_contact_test.cpp)
