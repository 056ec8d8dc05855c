#pragma once

#include "base/arguments.h"

#include <ed/contact_options.h>

#include <array>
#include <limits>

namespace hardbody::python {

inline constexpr std::array kFinders = {ed::Finder::certified, ed::Finder::bracketing};
inline constexpr std::array kDistances = {ed::DistanceMethod::dual, ed::DistanceMethod::newton8,
                                          ed::DistanceMethod::newton5};
inline constexpr std::array kRoots = {ed::ContactRoot::newton, ed::ContactRoot::one_dimensional};

/// Returns the options of a contact search that one pair and many pairs share.
inline ed::ContactOptions contact_options(nb::handle finder, nb::handle max_evaluations, nb::handle eps_d,
                                          nb::handle distance, nb::handle root) {
  ed::ContactOptions options;
  options.finder = choice(finder, "finder", kFinders);
  options.max_evaluations =
      static_cast<int>(integer(max_evaluations, "max_evaluations", 1, std::numeric_limits<int>::max()));
  options.eps_d = positive(eps_d, "eps_d");
  options.distance = choice(distance, "distance", kDistances);
  options.root = choice(root, "root", kRoots);
  return options;
}

}  // namespace hardbody::python
