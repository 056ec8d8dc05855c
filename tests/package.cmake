# The installed package as an outside project meets it (package/consumer): static, or where the build has shared
# libraries, shared. And the Debian packages.
set(consumer_flags "")
if(HARDBODY_SANITIZE)
  set(consumer_flags "-fsanitize=${HARDBODY_SANITIZE}")
endif()
set(package_dir ${CMAKE_CURRENT_BINARY_DIR}/package)

function(hardbody_package_script name script)
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -DCOMPILER=${CMAKE_CXX_COMPILER}
    -DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} -DFLAGS=${consumer_flags} -DWORK_DIR=${package_dir}/${name} ${ARGN}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/package/${script})
  set_tests_properties(${name} PROPERTIES LABELS package TIMEOUT 600)
endfunction()

# hardbody_package_tests(<linkage>)
function(hardbody_package_tests linkage)
  set(prefix ${package_dir}/prefix)  # the same for both linkages: ccache then knows the consumers' object files
  hardbody_package_script(package_${linkage}_install install.cmake -DBUILD_DIR=${PROJECT_BINARY_DIR} -DPREFIX=${prefix})
  # All install from the same build tree.
  set_tests_properties(package_${linkage}_install PROPERTIES FIXTURES_SETUP package_${linkage} RESOURCE_LOCK install)

  # Whoever asks for no seeds needs none of their packages. The other flags take instructions that the library does not
  # use, and give inline functions of the headers symbols: the answers must stay the same. Every program is built with the
  # usual flags in one of the tests, and in several only where it compiles fast.
  set(hidden -DHIDDEN=fcl,ccd,octomap,CGAL)
  set(unneeded "-DUNNEEDED=lib(fcl|ccd|octomap|octomath|gmp|mpfr|hwy)")
  set(other_flags "-DOTHER_FLAGS=-march=native -fno-inline")
  hardbody_package_script(package_${linkage}_geom run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom ${hidden} ${unneeded}
    -DPROGRAMS=geom,no_exceptions,quickstart ${other_flags} -DCOMPARED=geom)
  hardbody_package_script(package_${linkage}_geom_ed run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom,ed ${hidden} ${unneeded}
    -DPROGRAMS=quickstart,user_shapes,ed ${other_flags} -DCOMPARED=ed)
  set_tests_properties(package_${linkage}_geom PROPERTIES COST 100)
  set(names geom geom_ed)
  if(HARDBODY_WITH_SEEDS)
    hardbody_package_script(package_${linkage}_geom_seeds run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom,geom_seeds
      -DPROGRAMS=quickstart,seeds -DHIDDEN=CGAL)
    # ... which proves that they are hidden above.
    hardbody_package_script(package_${linkage}_hidden run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom,geom_seeds
      ${hidden} "-DREFUSED=geom_seeds needs ccd, which was not found")
    hardbody_package_script(package_${linkage}_optional run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom
      -DPROGRAMS=quickstart -DOPTIONAL=geom_seeds ${hidden})
    list(APPEND names geom_seeds hidden optional)
    if(HARDBODY_WITH_CGAL)
      hardbody_package_script(package_${linkage}_geom_cgal run.cmake -DPREFIX=${prefix}
        -DCOMPONENTS=geom,geom_seeds,geom_cgal -DPROGRAMS=quickstart,seeds)
      list(APPEND names geom_cgal)
    endif()
  endif()
  hardbody_package_script(package_${linkage}_unknown run.cmake -DPREFIX=${prefix} -DCOMPONENTS=geom,optics
    "-DREFUSED=wanted: geom, optics.+this installation has: [a-z_, ]*geom")
  list(APPEND names unknown)
  list(TRANSFORM names PREPEND package_${linkage}_)
  set_tests_properties(${names} PROPERTIES FIXTURES_REQUIRED package_${linkage})
endfunction()

foreach(installed hardbody_geom hardbody_ed hardbody_geom_seeds hardbody_geom_cgal hardbody)
  if(TARGET ${installed})
    hardbody_needed_by(package ${installed})
  endif()
endforeach()
find_program(HARDBODY_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(BUILD_SHARED_LIBS)
  hardbody_package_tests(shared)
else()
  hardbody_package_tests(static)
endif()
if(BUILD_SHARED_LIBS AND HARDBODY_PYTHON)
  add_test(NAME package_exports COMMAND ${HARDBODY_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/package/exports.py
    ${package_dir}/prefix ${CMAKE_NM})
  set_tests_properties(package_exports PROPERTIES LABELS package TIMEOUT 60 FIXTURES_REQUIRED package_shared)
endif()

# How headers and libgeom compile with flags of others; nothing has to be built for that, and shared libraries are made of
# the same sources.
if(NOT BUILD_SHARED_LIBS)
  find_package(Eigen3 3.4 REQUIRED NO_MODULE)
  get_target_property(eigen_dir Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  foreach(name eigen_macros no_exceptions)
    hardbody_package_script(package_${name} ${name}.cmake -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DEIGEN_DIR=${eigen_dir})
  endforeach()
endif()

find_program(HARDBODY_DPKG_DEB dpkg-deb)
if(TARGET hardbody AND HARDBODY_DPKG_DEB AND NOT HARDBODY_SANITIZE AND NOT BUILD_SHARED_LIBS)
  hardbody_package_script(package_deb deb.cmake -DBUILD_DIR=${PROJECT_BINARY_DIR} -DVERSION=${PROJECT_VERSION})
  set_tests_properties(package_deb PROPERTIES RESOURCE_LOCK install)
endif()
