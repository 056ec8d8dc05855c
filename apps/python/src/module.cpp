#include "base/exceptions.h"
#include "base/gil.h"
#include "geometry/bind.h"
#include "runs/bind.h"
#include "scene/bind.h"
#include "simulation/bind.h"

#include <base/version.h>

#include <nanobind/nanobind.h>

NB_MODULE(_core, module) {
  namespace python = hardbody::python;
  // Types and the hooks at the end of the interpreter are those of the process.
  if (PyInterpreterState_GetID(PyInterpreterState_Get()) != 0) {
    throw nanobind::import_error("hardbody cannot be imported in a subinterpreter; accepted: the main interpreter");
  }
  module.doc() = "Compiled part of the package hardbody, which has its public names.";
  module.attr("__version__") = hardbody::version();
  // Objects that global variables hold are alive at exit, and no leak; shapes that are written in Python may refer to
  // themselves through the module that defines them.
  nanobind::set_leak_warnings(false);
  python::register_exceptions();
  python::watch_end_of_interpreter();
  python::bind_shapes(module);
  python::bind_poses(module);
  python::bind_motions(module);
  python::bind_queries(module);
  python::bind_masses(module);
  python::bind_distances(module);
  python::bind_derivatives(module);
  python::bind_patches(module);
  python::bind_contacts(module);
  python::bind_body_queries(module);
  python::bind_custom_shapes(module);
  python::bind_scenes(module);
  python::bind_species(module);
  python::bind_outcomes(module);
  python::bind_systems(module);
  python::bind_starts(module);
  python::bind_observables(module);
  python::bind_simulations(module);
  python::bind_commands(module);
  python::bind_program(module);
  python::bind_plots(module);
}
