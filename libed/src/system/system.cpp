#include "base/power_of_two.h"
#include "contact/body_shapes.h"
#include "motion/checks.h"
#include "system/uniaxial.h"

#include <ed/system.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;

/// Returns whether the shape is one of revolution about this body axis.
bool is_of_revolution(const BodyShape& shape, int axis) {
  const auto symmetric = symmetry_axis(shape);
  if (!symmetric) return false;
  const bool round = bounding_radius(shape) == inscribed_radius(shape);  // a sphere: about every axis
  return *symmetric == axis || round;
}

[[noreturn]] void refuse_moments(const Vector3d& inertia, const std::string& why) {
  std::ostringstream message;
  message << "inertia is [" << inertia.x() << ", " << inertia.y() << ", " << inertia.z() << "]; accepted: " << why;
  throw std::invalid_argument(message.str());
}

/// Returns "I2 + I3 - I1 at most 0.5".
std::string bound_of_sum(int axis, double most) {
  constexpr std::array<const char*, 3> kSums = {"I2 + I3 - I1", "I3 + I1 - I2", "I1 + I2 - I3"};
  std::ostringstream text;
  text << kSums[static_cast<std::size_t>(axis)] << " at most " << most
       << ", twice the mass times the square of the body's half extent along body "
       << "xyz"[axis];
  return text.str();
}

/// Throws unless the moments are possible for mass within the shape, and not too small: the second moments S_x = <x^2>
/// m = (I_y + I_z - I_x) / 2, ... must be those of mass within the half extents, and their sum that of mass within the
/// bounding radius. Without spin the moment about the symmetry axis is ignored: for a body of revolution I = S_x + S_z
/// there, 2 S_x <= m (half extent)^2.
void check_moments(const Species& species, std::optional<int> symmetry_axis) {
  constexpr double kRounding = 1 + 1e-9;
  const Vector3d& I = species.inertia;
  const double m = species.mass;
  const double R = bounding_radius(species.shape);
  const double r = inscribed_radius(species.shape);
  const Vector3d h2 = half_extents(species.shape).cwiseAbs2();
  const double least = kLeastMoment * m * r * r;
  std::ostringstream range;
  if (!species.spins) {
    const int across = (*symmetry_axis + 1) % 3;
    const double most = m * std::min(R * R, 0.5 * h2[across] + h2[*symmetry_axis]);
    range << "moments from " << least << " to " << most << " across the axis, those of mass within the body";
    if (!(I[across] >= least && I[across] <= most * kRounding)) refuse_moments(I, range.str());
    return;
  }
  range << "moments from " << least << ", and a sum of at most " << 2 * m * R * R
        << ", that of all mass at the bounding radius";
  if (!(I.minCoeff() >= least && I.sum() <= 2 * m * R * R * kRounding)) refuse_moments(I, range.str());
  for (int k = 0; k < 3; ++k) {
    if (I.sum() - 2 * I[k] > 2 * m * h2[k] * kRounding) refuse_moments(I, bound_of_sum(k, 2 * m * h2[k]));
  }
}

}  // namespace

std::optional<int> symmetry_axis(const Species& species) {
  for (const int axis : {2, 0, 1}) {
    const bool equal_moments = species.inertia[(axis + 1) % 3] == species.inertia[(axis + 2) % 3];
    if (equal_moments && is_of_revolution(species.shape, axis)) return axis;
  }
  return std::nullopt;
}

void check_species(const Species& species) {
  internal::check_exponents(species.shape);
  if (!(species.mass > 0) || !std::isfinite(species.mass)) {
    throw std::invalid_argument("mass is not positive; accepted: a positive number");
  }
  const auto axis = symmetry_axis(species);
  if (species.spins) {
    internal::check_inertia(species.inertia);
    check_moments(species, axis);
    return;
  }
  if (!axis) {
    throw std::invalid_argument(
        "spins is false, but the body has no axis that shape and inertia are both symmetric about; accepted: true");
  }
  const double perpendicular = species.inertia[(*axis + 1) % 3];
  if (!(perpendicular > 0) || !std::isfinite(perpendicular)) {
    throw std::invalid_argument("inertia is not positive; accepted: positive moments");
  }
  check_moments(species, axis);
}

void check_species(const System& system) {
  if (system.species.empty()) throw std::invalid_argument("species: none; accepted: one or more");
  for (const Species& species : system.species) check_species(species);
  for (const Body& body : system.bodies) {
    if (body.species >= 0 && body.species < static_cast<int>(system.species.size())) continue;
    throw std::invalid_argument("species of a body is " + std::to_string(body.species) + "; accepted: 0 to " +
                                std::to_string(system.species.size() - 1));
  }
}

Species paper_species(const geom::Ellipsoid& shape, double mass) {
  if (!shape.symmetry_axis()) {
    std::ostringstream message;
    message << "inertia \"paper\" is that of ellipsoids of revolution, the semi-axes are "
            << shape.semi_axes().transpose() << "; accepted: two equal ones, or another inertia";
    throw std::invalid_argument(message.str());
  }
  const double r = shape.inscribed_radius();
  return {shape, mass, Vector3d::Constant(0.4 * mass * r * r), false};
}

Species uniform_species(const BodyShape& shape, double mass) {
  const auto inertia = [&](const auto& s) -> Vector3d {
    if constexpr (requires { s.is_in_principal_frame(); }) {
      if (!s.is_in_principal_frame()) {
        throw std::invalid_argument("the frame of shape " + describe(shape) +
                                    " is not that of its principal axes, from its centre of mass; accepted: a shape "
                                    "of in_principal_frame (of a polyhedron or cone)");
      }
    }
    if constexpr (requires { s.inertia(mass); }) return s.inertia(mass);
    throw std::invalid_argument("the moments of inertia of shape " + describe(shape) +
                                " are not known; accepted: a Species with its own");
  };
  return {shape, mass, std::visit(inertia, shape), true};
}

double thermal_time(const Species& species) {
  constexpr double kUnitBall = 4.18879020478639098;  // 4 pi / 3
  return std::cbrt(volume(species.shape) / kUnitBall) * std::sqrt(species.mass);
}

double time_unit(const std::vector<Component>& components) {
  double sum = 0;
  double number = 0;
  for (const Component& component : components) {
    sum += component.number * thermal_time(component.species);
    number += component.number;
  }
  return number > 0 ? internal::nearest_power_of_two(sum / number) : 1;
}

double time_unit(const System& system) {
  double sum = 0;
  for (int i = 0; i < system.size(); ++i) sum += thermal_time(system.species_of(i));
  return system.size() > 0 ? internal::nearest_power_of_two(sum / system.size()) : 1;
}

double packing_fraction(const System& system) {
  std::vector<int> number(system.species.size(), 0);
  for (const Body& body : system.bodies) ++number[static_cast<std::size_t>(body.species)];
  double all = 0;
  for (std::size_t k = 0; k < number.size(); ++k) all += number[k] * volume(system.species[k].shape);
  return all / (system.box * system.box * system.box);
}

double box_for(const BodyShape& shape, int number, double packing_fraction) {
  return std::cbrt(number * volume(shape) / packing_fraction);
}

double box_for(const std::vector<Component>& components, double packing_fraction) {
  double all = 0;
  for (const Component& component : components) all += component.number * volume(component.species.shape);
  return std::cbrt(all / packing_fraction);
}

const char* to_string(Neighbours neighbours) {
  switch (neighbours) {
    case Neighbours::dilated:
      return "dilated";
    case Neighbours::obp:
      return "obp";
    case Neighbours::cells:
      return "cells";
  }
  return "unknown";
}

bool internal::has_uniaxial_shape(const BodyShape& shape) {
  return is_spheroid(shape) || std::holds_alternative<geom::Sphere>(shape) ||
         std::holds_alternative<geom::Capsule>(shape);
}

bool internal::has_rods(const std::vector<Species>& species) {
  const auto is_capsule = [](const Species& one) { return std::holds_alternative<geom::Capsule>(one.shape); };
  const auto is_sphere = [](const Species& one) { return std::holds_alternative<geom::Sphere>(one.shape); };
  return std::any_of(species.begin(), species.end(), is_capsule) ||
         std::all_of(species.begin(), species.end(), is_sphere);
}

bool internal::are_uniaxial(const std::vector<Species>& species) {
  return std::all_of(species.begin(), species.end(),
                     [](const Species& one) { return has_uniaxial_shape(one.shape) && symmetry_axis(one); });
}

KineticState kinetic_state(const System& system) {
  KineticState state;
  std::vector<int> axes;
  for (const Species& species : system.species) axes.push_back(symmetry_axis(species).value_or(-1));
  for (const Body& body : system.bodies) {
    const Species& species = system.species[static_cast<std::size_t>(body.species)];
    const int axis = axes[static_cast<std::size_t>(body.species)];
    state.translational_energy += 0.5 * species.mass * body.velocity.squaredNorm();
    state.momentum += species.mass * body.velocity;
    const Vector3d w = body.rotation.transpose() * body.angular_velocity;
    Vector3d energy = 0.5 * species.inertia.cwiseProduct(w.cwiseProduct(w));
    if (axis >= 0 && !species.spins) energy[axis] = 0;  // excluded, whatever the moment about it is
    state.axis_energy += energy;
    if (axis < 0) {
      state.rotational_energy += energy.sum();
      state.rotational_degrees_of_freedom += 3;
      continue;
    }
    const Vector3d u = body.rotation.col(axis);
    const double spin = body.angular_velocity.dot(u);
    const double perpendicular = species.inertia[(axis + 1) % 3];
    state.rotational_energy += 0.5 * perpendicular * (body.angular_velocity - spin * u).squaredNorm();
    if (species.spins) state.spin_energy += 0.5 * species.inertia[axis] * spin * spin;
    state.rotational_degrees_of_freedom += 2;
    state.spin_degrees_of_freedom += species.spins ? 1 : 0;
  }
  state.translational_kT = 2 * state.translational_energy / std::max(1, 3 * system.size() - 3);
  state.rotational_kT = 2 * state.rotational_energy / std::max(1, state.rotational_degrees_of_freedom);
  return state;
}

}  // namespace ed
