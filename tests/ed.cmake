# Tests of this part; see hardbody_test in CMakeLists.txt. HARDBODY_FULL=1 in the environment raises the lengths.
hardbody_test(ed_unit_test unit
  unit/ed/bodies/custom_shape_test.cpp
  unit/ed/bodies/mixed_bodies_test.cpp
  unit/ed/bodies/pair_distance_test.cpp
  unit/ed/neighbours/envelopes_test.cpp
  unit/ed/neighbours/paper_envelopes_test.cpp
  unit/ed/loop/added_events_test.cpp
  unit/ed/loop/event_loop_test.cpp
  unit/ed/loop/kernel_trial_test.cpp
  unit/ed/loop/loop_parts_test.cpp
  unit/ed/loop/poll_test.cpp
  unit/ed/loop/prefetch_events_test.cpp
  unit/ed/neighbours/general_test.cpp
  unit/ed/start/lattice_test.cpp
  unit/ed/system/polydispersity_test.cpp
  unit/ed/loop/restart_test.cpp
  unit/ed/loop/simulation_test.cpp
  unit/ed/loop/simulation_refuses_test.cpp
  unit/ed/start/large_starts_test.cpp
  unit/ed/start/start_test.cpp
  unit/ed/system/system_test.cpp
  unit/ed/start/velocities_test.cpp)
hardbody_test(ed_observables_test unit
  unit/ed/observables/analysis_test.cpp
  unit/ed/observables/replicas_test.cpp
  unit/ed/observables/correlations_test.cpp
  unit/ed/observables/curves_test.cpp
  unit/ed/observables/equilibration_test.cpp
  unit/ed/observables/group_observables_test.cpp
  unit/ed/observables/mixtures_test.cpp
  unit/ed/observables/observables_test.cpp
  unit/ed/observables/order_test.cpp
  unit/ed/observables/ordered_states_test.cpp
  unit/ed/observables/snapshots_test.cpp
  unit/ed/observables/stored_frames_test.cpp
  unit/ed/observables/structure_test.cpp)
foreach(name conservation correlations counters equation_of_state free_rotor general_bodies core_bodies monte_carlo same_collisions scale
    time_reversal)
  hardbody_test(physics_${name}_test physics physics/${name}_test.cpp)
endforeach()
# Its tests judge the same runs.
hardbody_test(physics_state_points_test physics WHOLE physics/state_points_test.cpp)
# Its own program: it replaces operator new.
hardbody_test(physics_allocation_test physics physics/allocation_test.cpp)
hardbody_test(golden_test golden golden/golden_test.cpp)
hardbody_kernel_symbols_test(ed_kernel_symbols hardbody_ed vectors/kernels _ZN2ed8internal[0-9]+uniaxial_kernels_)
hardbody_kernel_symbols_test(ed_cell_kernel_symbols hardbody_ed cells/kernels _ZN2ed8internal[0-9]+cell_kernel_)
