#pragma once

#include "base/arguments.h"

#include <ed/contact_options.h>

#include <array>
#include <limits>
#include <string>

namespace hardbody::python {

inline constexpr std::array kFinders = {ed::Finder::certified, ed::Finder::bracketing};
inline constexpr std::array kDistances = {ed::DistanceMethod::dual, ed::DistanceMethod::newton8,
                                          ed::DistanceMethod::newton5};
inline constexpr std::array kRoots = {ed::ContactRoot::newton, ed::ContactRoot::one_dimensional};

/// Throws ValueError for an option of "bracketing" that is given with "certified", where it would have no effect.
inline void refuse_unused(const char* name, nb::handle value) {
  if (value.is_none()) return;
  throw nb::value_error((std::string(name) + " is given, but finder=\"certified\" has no " + name +
                         "; accepted: None, or finder=\"bracketing\"")
                            .c_str());
}

/// Reads the method of a contact search. None: what `options` has.
inline void read_method(ed::ContactOptions& options, nb::handle finder, nb::handle eps_d, nb::handle distance,
                        nb::handle root) {
  options.finder = choice(finder, "finder", kFinders);
  options.distance = choice(distance, "distance", kDistances);
  if (!root.is_none()) options.root = choice(root, "root", kRoots);
  if (!eps_d.is_none()) options.eps_d = positive(eps_d, "eps_d");
  if (options.finder != ed::Finder::certified) return;
  if (options.distance != ed::DistanceMethod::dual) {
    refuse_value("distance", '"' + std::string(to_string(options.distance)) + '"',
                 "\"dual\" with finder=\"certified\"; others with \"bracketing\"");
  }
  refuse_unused("root", root);
  refuse_unused("eps_d", eps_d);
}

/// Returns the options of a contact search that one pair and many pairs share.
inline ed::ContactOptions contact_options(nb::handle finder, nb::handle max_evaluations, nb::handle eps_d,
                                          nb::handle distance, nb::handle root) {
  ed::ContactOptions options;
  read_method(options, finder, eps_d, distance, root);
  options.max_evaluations =
      static_cast<int>(integer(max_evaluations, "max_evaluations", 1, std::numeric_limits<int>::max()));
  return options;
}

}  // namespace hardbody::python
