#pragma once

/// Species of bodies, and how many of each.

#include "base/arguments.h"

#include <ed/polydispersity.h>
#include <ed/system.h>

#include <nanobind/nanobind.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Bodies of one species whose sizes are distributed.
struct Polydisperse {
  ed::Species species;  ///< species of nominal size
  int number = 0;
  double width = 0;
  ed::SizeDistribution sizes = ed::SizeDistribution::gaussian;
  std::optional<std::uint64_t> seed;  ///< nullopt: that of the start
};

/// Bodies of a start that form a group: a species, or one with sizes.
struct ComponentGroup {
  ed::Species species;  ///< species of nominal size
  int number = 0;
  std::vector<double> factors;  ///< size of each body relative to the nominal one; empty: all 1
};

/// Returns the components of a start, in the order of its bodies; of distributed sizes one a body.
std::vector<ed::Component> component_list(const std::vector<ComponentGroup>& groups);
/// Returns the numbers of bodies of the groups.
std::vector<int> numbers_of(const std::vector<ComponentGroup>& groups);

/// Returns the species of a Species or of a shape, then of mass 1. Throws TypeError if the value is neither.
ed::Species species_of(nb::handle value, const std::string& name);

/// Returns whether a value is a Species or a shape.
bool is_species(nb::handle value);

/// Number of bodies of a start whose components are a single species without a number.
inline constexpr int kDefaultNumber = 512;

/// Returns the bodies of a Species, a shape or a Polydisperse, or of a list of those with their numbers. `number`: that
/// of a single species, None for `usual_number` or if it has one of its own. Sizes are those that the program draws
/// with the same seed.
std::vector<ComponentGroup> components_of(nb::handle value, nb::handle number, std::uint64_t seed,
                                          int usual_number = kDefaultNumber);

/// Returns the random seed of an argument.
std::uint64_t seed_of(nb::handle value, const char* name);

}  // namespace hardbody::python
