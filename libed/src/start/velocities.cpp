#include "start/parts.h"

#include <ed/random.h>
#include <ed/start.h>
#include <ed/system.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns the axis about which each species is symmetric, or -1.
std::vector<int> symmetry_axes(const System& system) {
  std::vector<int> axes;
  for (const Species& species : system.species) axes.push_back(symmetry_axis(species).value_or(-1));
  return axes;
}

/// Returns the spheres among the bodies.
System spheres_of(const System& system) {
  System spheres;
  spheres.species = system.species;
  for (const Body& body : system.bodies) {
    if (is_sphere(system.species[static_cast<std::size_t>(body.species)].shape)) spheres.bodies.push_back(body);
  }
  return spheres;
}

/// Returns the factor of velocities that changes an energy to the wanted one; 0 for bodies at rest.
double factor(double wanted, double energy) {
  return energy > 0 ? std::sqrt(wanted / energy) : 0.0;
}

void remove_momentum(System& system) {
  double total_mass = 0;
  for (int i = 0; i < system.size(); ++i) total_mass += system.species_of(i).mass;
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < system.size(); ++i) {
    mean += system.bodies[static_cast<std::size_t>(i)].velocity / (total_mass / system.species_of(i).mass);
  }
  for (Body& body : system.bodies) body.velocity -= mean;
}

/// Sets the rotational kT of spheres, that of other bodies, and the spin kT to 1, each by one factor.
void rescale_rotation(System& system) {
  const KineticState now = kinetic_state(system);
  const std::vector<int> axes = symmetry_axes(system);
  // Spheres without friction never change their rotation: in a mixture it would be an isolated reservoir.
  const KineticState round = kinetic_state(spheres_of(system));
  const bool mixed = round.rotational_degrees_of_freedom != now.rotational_degrees_of_freedom;
  const double sphere_rotation =
      factor(0.5 * round.rotational_degrees_of_freedom, mixed ? round.rotational_energy : now.rotational_energy);
  const double rotation = mixed
                              ? factor(0.5 * (now.rotational_degrees_of_freedom - round.rotational_degrees_of_freedom),
                                       now.rotational_energy - round.rotational_energy)
                              : sphere_rotation;
  const double spin = factor(0.5 * now.spin_degrees_of_freedom, now.spin_energy);
  for (Body& body : system.bodies) {
    const auto kind = static_cast<std::size_t>(body.species);
    const double factor_here = is_sphere(system.species[kind].shape) ? sphere_rotation : rotation;
    if (axes[kind] < 0) {
      body.angular_velocity *= factor_here;
      continue;
    }
    const Vector3d u = body.rotation.col(axes[kind]);
    const double w = body.angular_velocity.dot(u);
    body.angular_velocity =
        factor_here * (body.angular_velocity - w * u) + (system.species[kind].spins ? spin * w : 0.0) * u;
  }
}

// ---- Groups

using Members = std::vector<std::size_t>;

/// Returns the bodies of each group: as many as `numbers` says, consecutively. Without numbers each species is a group,
/// and all species of one body each are one group together.
std::vector<Members> groups_of(const System& system, const std::vector<int>& numbers) {
  const auto size = static_cast<std::size_t>(system.size());
  std::vector<Members> groups;
  if (numbers.empty()) {
    groups.resize(system.species.size() + 1);
    for (std::size_t i = 0; i < size; ++i) groups[static_cast<std::size_t>(system.bodies[i].species)].push_back(i);
    for (std::size_t k = 0; k + 1 < groups.size(); ++k) {
      if (groups[k].size() == 1) groups.back().push_back(std::exchange(groups[k], {}).front());
    }
    std::erase_if(groups, [](const Members& group) { return group.empty(); });
    return groups;
  }
  std::size_t next = 0;
  for (const int number : numbers) {
    Members& group = groups.emplace_back();
    for (int k = 0; k < number; ++k) group.push_back(next++);
  }
  if (next == size && *std::min_element(numbers.begin(), numbers.end()) > 0) return groups;
  throw std::invalid_argument("groups: their numbers add up to " + std::to_string(next) +
                              "; accepted: numbers above 0 that add up to the number of bodies, " +
                              std::to_string(size));
}

/// Returns the bodies of a group as a separate system, for their rotation.
System part_of(const System& system, const Members& group) {
  System part;
  int last = -1;
  for (const std::size_t i : group) {
    const Body& body = system.bodies[i];
    if (body.species != last) part.species.push_back(system.species[static_cast<std::size_t>(body.species)]);
    last = body.species;
    part.bodies.push_back(body);
    part.bodies.back().species = static_cast<int>(part.species.size()) - 1;
  }
  return part;
}

/// Translation of a group: the motion of its centre of mass, and the motion about it.
struct GroupMotion {
  double number = 0;
  double mass = 0;
  Vector3d velocity = Vector3d::Zero();  ///< velocity of the centre of mass before rescaling
  Vector3d rescaled = Vector3d::Zero();  ///< velocity of the centre of mass after rescaling
  double internal_energy = 0;            ///< energy about the centre of mass before rescaling
  double wanted = 0;                     ///< energy at kT = 1
  double of_centre = 0;                  ///< part of `wanted` on the degrees of freedom of the centre of mass

  double centre_energy() const { return 0.5 * mass * rescaled.squaredNorm(); }
};

GroupMotion motion_of(const System& system, const Members& group) {
  const auto mass = [&](std::size_t i) { return system.species_of(static_cast<int>(i)).mass; };
  GroupMotion motion;
  motion.number = static_cast<double>(group.size());
  for (const std::size_t i : group) motion.mass += mass(i);
  for (const std::size_t i : group) motion.velocity += system.bodies[i].velocity * (mass(i) / motion.mass);
  for (const std::size_t i : group) {
    motion.internal_energy += 0.5 * mass(i) * (system.bodies[i].velocity - motion.velocity).squaredNorm();
  }
  if (group.size() == 1) motion.internal_energy = 0;
  return motion;
}

/// Sets the energies that each group has at kT = 1. Masses of the other groups are added up, not subtracted from the
/// total: one group may outweigh all others.
void set_wanted(std::vector<GroupMotion>& groups, double total_mass) {
  double before = 0;
  for (GroupMotion& group : groups) {
    group.of_centre = 1.5 * before / total_mass;
    before += group.mass;
  }
  double after = 0;
  for (auto group = groups.rbegin(); group != groups.rend(); ++group) {
    group->of_centre += 1.5 * after / total_mass;
    group->wanted = 1.5 * (group->number - 1) + group->of_centre;
    after += group->mass;
  }
}

/// Removes the mean velocity, and scales to the energy of all groups together. Returns whether scaling the motion about
/// each centre of mass can then give each group its energy.
bool scale_together(std::vector<GroupMotion>& groups, double total_mass) {
  Vector3d mean = Vector3d::Zero();
  for (const GroupMotion& group : groups) mean += group.velocity * (group.mass / total_mass);
  double energy = 0;
  double wanted = 0;
  for (GroupMotion& group : groups) {
    group.rescaled = group.velocity - mean;
    energy += group.internal_energy + group.centre_energy();
    wanted += group.wanted;
  }
  for (GroupMotion& group : groups) group.rescaled *= factor(wanted, energy);
  return std::all_of(groups.begin(), groups.end(), [](const GroupMotion& group) {
    return group.internal_energy > 0 && group.centre_energy() < group.wanted;
  });
}

/// Gives each centre of mass the energy of its own degrees of freedom, 3/2 (1 - M_k / M), in directions that are
/// rotated until the momenta add up to zero. Their lengths L_k = sqrt(3 M_k (1 - M_k / M)) are the r.m.s. momenta of
/// thermal motion whose sum is zero, so that none is longer than the others together and such directions exist.
/// Rotating p_k by a small rotation w_k changes the sum by sum w_k x p_k; the smallest rotations that cancel it are w_k
/// = -p_k x c with sum (L_k^2 - p_k p_k^T) c = sum p_k. Momenta along one line that do not cancel cannot be rotated
/// this way and are left unchanged.
void set_centres(std::vector<GroupMotion>& groups) {
  constexpr int kMostSteps = 200;
  constexpr double kRounding = 1e-15;
  std::vector<Vector3d> momenta;
  double all = 0;
  for (const GroupMotion& group : groups) {
    const double length = std::sqrt(2 * group.mass * group.of_centre);
    momenta.emplace_back(length * group.rescaled.stableNormalized());
    all += length;
  }
  for (int step = 0; step < kMostSteps; ++step) {
    Vector3d sum = Vector3d::Zero();
    Matrix3d A = Matrix3d::Zero();
    for (const Vector3d& p : momenta) {
      sum += p;
      A += p.squaredNorm() * Matrix3d::Identity() - p * p.transpose();
    }
    if (sum.norm() <= kRounding * all) break;
    const Vector3d c = A.fullPivLu().solve(sum);
    double largest = 0;
    for (const Vector3d& p : momenta) largest = std::max(largest, p.cross(c).norm());
    const double share = std::min(1.0, 0.3 / largest);
    for (Vector3d& p : momenta) {
      const double length = p.norm();
      p = length * (p - share * (p.squaredNorm() * c - p * p.dot(c))).stableNormalized();
    }
  }
  for (std::size_t k = 0; k < groups.size(); ++k) groups[k].rescaled = momenta[k] / groups[k].mass;
}

/// Sets the translational kT of each group to 1 and the momentum to zero. A group of N_k bodies and mass M_k has 3 N_k
/// - 3 degrees of freedom about its centre of mass. The 3 degrees of freedom removed by zero momentum are divided among
/// the centres of mass by mass: 3 (1 - M_k / M) are left to each. Scaling the motion about a centre of mass changes no
/// momentum, so the centres keep their relative velocities if that is sufficient; a single body, which has no such
/// motion, gets a new speed.
void rescale_translation(System& system, const std::vector<Members>& members) {
  double total_mass = 0;
  for (int i = 0; i < system.size(); ++i) total_mass += system.species_of(i).mass;
  std::vector<GroupMotion> groups;
  groups.reserve(members.size());
  for (const Members& group : members) groups.push_back(motion_of(system, group));
  set_wanted(groups, total_mass);
  if (!scale_together(groups, total_mass)) set_centres(groups);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const GroupMotion& group = groups[k];
    const double scale = factor(std::max(0.0, group.wanted - group.centre_energy()), group.internal_energy);
    for (const std::size_t i : members[k]) {
      Vector3d& v = system.bodies[i].velocity;
      v = group.rescaled + scale * (v - group.velocity);
    }
  }
}

}  // namespace

namespace internal {

void draw_velocities(System& system, Random& random) {
  const std::vector<int> axes = symmetry_axes(system);
  for (Body& body : system.bodies) {
    const auto kind = static_cast<std::size_t>(body.species);
    const Species& species = system.species[kind];
    // Variance kT / m, and kT / I of the components along the body's axes; rescaled exactly afterwards.
    body.velocity = random.normal3() / std::sqrt(species.mass);
    const Vector3d w = random.normal3();
    Vector3d omega = w.cwiseQuotient(species.inertia.cwiseSqrt());
    if (!species.spins) omega[axes[kind]] = 0;
    body.angular_velocity = body.rotation * omega;
  }
}

void rescale_together(System& system) {
  remove_momentum(system);
  const double translation = factor(0.5 * (3 * system.size() - 3), kinetic_state(system).translational_energy);
  for (Body& body : system.bodies) body.velocity *= translation;
  rescale_rotation(system);
}

}  // namespace internal

void rescale_velocities(System& system, const std::vector<int>& groups) {
  const std::vector<Members> members = groups_of(system, groups);
  if (members.size() < 2) return internal::rescale_together(system);
  rescale_translation(system, members);
  for (const Members& group : members) {
    System part = part_of(system, group);
    rescale_rotation(part);
    for (std::size_t k = 0; k < group.size(); ++k) {
      system.bodies[group[k]].angular_velocity = part.bodies[k].angular_velocity;
    }
  }
}

}  // namespace ed
