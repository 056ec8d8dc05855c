# Tests of this part; see hardbody_test in CMakeLists.txt. HARDBODY_FULL=1 in the environment raises the lengths.
hardbody_test(ed_unit_test unit
  unit/custom_shape_test.cpp
  unit/envelopes_test.cpp
  unit/event_loop_test.cpp
  unit/events_ahead_test.cpp
  unit/general_envelopes_test.cpp
  unit/lattice_start_test.cpp
  unit/polydispersity_test.cpp
  unit/restart_test.cpp
  unit/simulation_test.cpp
  unit/start_test.cpp
  unit/system_test.cpp
  unit/velocities_test.cpp)
hardbody_test(ed_observables_test unit
  unit/analysis_test.cpp
  unit/correlations_test.cpp
  unit/curves_test.cpp
  unit/equilibration_test.cpp
  unit/observables_test.cpp
  unit/snapshots_test.cpp
  unit/stored_frames_test.cpp
  unit/structure_test.cpp)
foreach(name conservation correlations counters equation_of_state free_rotor general_bodies same_collisions scale state_points time_reversal)
  hardbody_test(physics_${name}_test physics physics/${name}_test.cpp)
endforeach()
# Its own program: it replaces operator new.
hardbody_test(physics_allocation_test physics physics/allocation_test.cpp)
hardbody_test(golden_test golden golden/golden_test.cpp)
hardbody_kernel_symbols_test(ed_kernel_symbols hardbody_ed uniaxial_kernels _ZN2ed8internal[0-9]+uniaxial_kernels_)
hardbody_kernel_symbols_test(ed_cell_kernel_symbols hardbody_ed cell_kernels _ZN2ed8internal[0-9]+cell_kernel_)
