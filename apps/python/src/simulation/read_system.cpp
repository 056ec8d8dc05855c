#include "simulation/read_system.h"

#include "base/arrays.h"
#include "base/orientations.h"
#include "simulation/species.h"

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace hardbody::python {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Reads vectors into the bodies; None: as they are.
void read_vectors(nb::handle value, const char* name, ed::System& system, Vector3d ed::Body::*member) {
  if (value.is_none()) return;
  const RealRows rows(value, name, 3);
  check_rows(name, rows.size(), "positions", system.bodies.size());
  for (std::size_t k = 0; k < rows.size(); ++k) system.bodies[k].*member = rows.finite_vector(k);
}

/// Returns a rotation matrix with the bits given, if it is one to rounding, else the nearest rotation.
Matrix3d rotation_of(const Matrix3d& given) {
  const geom::Pose checked(given, Vector3d::Zero());
  const bool is_exact = ((given.transpose() * given) - Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 4e-15;
  return is_exact ? given : checked.rotation();
}

/// Reads orientations into the bodies; None: not rotated.
void read_orientations(nb::handle value, ed::System& system) {
  constexpr const char* kName = "orientations";
  if (value.is_none()) return;
  const Orientations given(value, kName);
  check_rows(kName, given.size(), "positions", system.bodies.size());
  for (std::size_t k = 0; k < given.size(); ++k) {
    try {
      system.bodies[k].rotation = given.are_matrices() ? rotation_of(given.matrix(k)) : given.pose(k).rotation();
    } catch (const std::invalid_argument& error) {
      throw nb::value_error((entry(kName, k) + ": " + error.what()).c_str());
    }
  }
}

void read_species(nb::handle value, nb::handle species_of_body, ed::System& system) {
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    std::size_t k = 0;
    for (const nb::handle one : value) system.species.push_back(species_of(one, entry("species", k++)));
  } else {
    system.species.push_back(species_of(value, "species"));
  }
  const std::size_t count = system.species.size();
  if (species_of_body.is_none()) {
    if (count == 1) return;
    if (count != system.bodies.size()) {
      throw nb::value_error(("species has " + std::to_string(count) + " elements for " +
                             std::to_string(system.bodies.size()) +
                             " bodies; accepted: one, one a body, or any number with species_of")
                                .c_str());
    }
    for (std::size_t k = 0; k < count; ++k) system.bodies[k].species = static_cast<int>(k);
    return;
  }
  const IndexRows indices(species_of_body, "species_of", 1);
  check_rows("species_of", indices.size(), "positions", system.bodies.size());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    system.bodies[k].species = static_cast<int>(indices.at(k, 0, count, "species"));
  }
}

/// Largest share of an angular velocity that may be about the axis of a body without spin. The axis is that of an
/// orientation accepted within geom::kPoseTolerance, and rounded as the angular velocity is, to single precision
/// perhaps.
constexpr double kLargestSpin = 4 * geom::kPoseTolerance;

/// Refuses rotation about the axis of a body that has none by its species: it would be dropped.
void check_spins(const ed::System& system) {
  for (std::size_t k = 0; k < system.bodies.size(); ++k) {
    const ed::Body& body = system.bodies[k];
    const ed::Species& species = system.species[static_cast<std::size_t>(body.species)];
    const std::optional<int> axis = ed::symmetry_axis(species);
    if (!axis || species.spins) continue;
    const Vector3d& w = body.angular_velocity;
    const double spin = w.stableNormalized().dot(body.rotation.col(*axis));
    if (!(std::abs(spin) > kLargestSpin)) continue;
    throw nb::value_error((entry("angular_velocities", k) + " is " + shown(w) + ", which turns body " +
                           std::to_string(k) + " about its axis " + shown(body.rotation.col(*axis)) +
                           "; accepted: across the axis, or Species(..., spins=True)")
                              .c_str());
  }
}

std::vector<int> read_groups(nb::handle value, const ed::System& system) {
  if (value.is_none()) return groups_of(system);
  const IndexRows rows(value, "groups", 1);
  std::vector<int> groups;
  std::size_t sum = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::size_t number = rows.at(k, 0, system.bodies.size() + 1);
    if (number == 0) refuse_value(entry("groups", k), "0", "at least 1");
    sum += number;
    groups.push_back(static_cast<int>(number));
  }
  if (sum == system.bodies.size()) return groups;
  refuse_value("sum of groups", std::to_string(sum), std::to_string(system.bodies.size()) + ", the number of bodies");
}

}  // namespace

BodySystem make_system(const SystemArguments& given) {
  BodySystem made;
  ed::System& system = made.system;
  system.box = positive(given.box, "box");
  if (system.box > geom::kMaxCoordinate) refuse_value("box", shown(system.box), "at most 1e100");
  const RealRows rows(given.positions, "positions", 3);
  if (rows.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    refuse_value("number of bodies", std::to_string(rows.size()), "at most 2147483647");
  }
  system.bodies.resize(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vector3d position = rows.finite_vector(k);
    // Wrapped as the trajectories are: images beyond would lose digits.
    if (position.cwiseAbs().maxCoeff() > 1e9 * system.box) {
      refuse_value(entry("positions", k), shown(position), "within 1e9 boxes of the origin");
    }
    system.bodies[k].position = position;
  }
  read_orientations(given.orientations, system);
  read_vectors(given.velocities, "velocities", system, &ed::Body::velocity);
  read_vectors(given.angular_velocities, "angular_velocities", system, &ed::Body::angular_velocity);
  read_species(given.species, given.species_of, system);
  check_spins(system);
  made.groups = read_groups(given.groups, system);
  return made;
}

}  // namespace hardbody::python
