#include "start/velocities.h"

#include "base/errors.h"

#include <ed/random.h>
#include <ed/start.h>

#include <fmt/format.h>
#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Kinds of motion that do not exchange energy, or may be known separately.
enum Kind : std::size_t { kTranslation, kRotation, kSpin, kKinds };
constexpr std::array<const char*, kKinds> kKindNames = {"translation", "rotation", "spin"};

/// Relative difference of masses, moments and energies that counts as rounding.
constexpr double kVelocityRounding = 1e-12;

/// Returns the angular velocity of a body whose angular momentum the frame contains, with the moments of the config.
Vector3d angular_velocity_of(const Frame& frame, const FrameBody& from, const ed::Body& body,
                             const ed::Species& species) {
  const bool by_momentum = frame.angular_momenta && !(from.inertia.minCoeff() > 0);
  if (!by_momentum) return from.angular_velocity;
  return body.rotation * (body.rotation.transpose() * from.angular_momentum).cwiseQuotient(species.inertia);
}

/// Draws Maxwell's velocities at kT = 1.
void draw_thermal(ed::System& system, std::uint64_t seed) {
  ed::Random random(seed);
  for (int i = 0; i < system.size(); ++i) {
    const ed::Species& species = system.species_of(i);
    ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    body.velocity = random.normal3() / std::sqrt(species.mass);
    body.angular_velocity = body.rotation * random.normal3().cwiseQuotient(species.inertia.cwiseSqrt());
  }
}

/// Returns whether the same velocities have the same energy; moments that two formulas give for one body differ by
/// rounding.
bool move_alike(const ed::Species& a, const ed::Species& b) {
  return a.spins == b.spins && std::abs(a.mass - b.mass) <= kVelocityRounding * b.mass &&
         (a.inertia - b.inertia).cwiseAbs().maxCoeff() <= kVelocityRounding * b.inertia.maxCoeff();
}

/// Bodies [begin, end) of a system: one species of the config.
struct SpeciesRange {
  std::size_t begin;
  std::size_t end;
};

/// Returns whether the bodies of a range move relative to each other; for a single body, relative to `drift`.
bool translates(const ed::System& system, SpeciesRange range, Vector3d drift) {
  const bool single = range.end - range.begin == 1;
  if (!single) drift.setZero();
  double mass = 0;
  for (std::size_t i = range.begin; i < range.end && !single; ++i) {
    const double m = system.species_of(static_cast<int>(i)).mass;
    mass += m;
    drift += (m / mass) * (system.bodies[i].velocity - drift);
  }
  double whole = 0;
  double relative = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const double m = system.species_of(static_cast<int>(i)).mass;
    whole += m * system.bodies[i].velocity.squaredNorm();
    relative += m * (system.bodies[i].velocity - drift).squaredNorm();
  }
  return whole > 0 && relative > kVelocityRounding * whole;
}

/// Returns the kinds of motion that the bodies of a range have; `drift`: mean velocity of all bodies. Rotation and spin
/// are separated up to rounding: that of six digits is 1e-9 of the energy of thin bodies.
std::array<bool, kKinds> motion_of(const ed::System& system, SpeciesRange range, const Vector3d& drift) {
  constexpr double kSeparation = 1e-8;
  ed::System part;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    part.species.push_back(system.species_of(static_cast<int>(i)));
    part.bodies.push_back(system.bodies[i]);
    part.bodies.back().species = static_cast<int>(part.species.size()) - 1;
  }
  const ed::KineticState now = ed::kinetic_state(part);
  const double rest = kSeparation * (now.rotational_energy + now.spin_energy);
  return {translates(system, range, drift), now.rotational_degrees_of_freedom == 0 || now.rotational_energy > rest,
          now.spin_degrees_of_freedom == 0 || now.spin_energy > rest};
}

Vector3d mean_velocity(const ed::System& system) {
  double mass = 0;
  for (int i = 0; i < system.size(); ++i) mass += system.species_of(i).mass;
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < system.size(); ++i) {
    mean += system.bodies[static_cast<std::size_t>(i)].velocity * (system.species_of(i).mass / mass);
  }
  return mean;
}

/// Copies the kinds of motion of `range` that are not kept from another system.
void replace(ed::System& system, const ed::System& drawn, SpeciesRange range, const std::array<bool, kKinds>& kept) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    ed::Body& body = system.bodies[i];
    const ed::Body& other = drawn.bodies[i];
    if (!kept[kTranslation]) body.velocity = other.velocity;
    const std::optional<int> axis = ed::symmetry_axis(system.species[static_cast<std::size_t>(body.species)]);
    if (!axis) {
      if (!kept[kRotation]) body.angular_velocity = other.angular_velocity;
      continue;
    }
    const Vector3d u = body.rotation.col(*axis);
    const Vector3d along = (kept[kSpin] ? body : other).angular_velocity.dot(u) * u;
    const Vector3d& turn = (kept[kRotation] ? body : other).angular_velocity;
    if (kept[kSpin] != kept[kRotation] || !kept[kSpin]) body.angular_velocity = turn - turn.dot(u) * u + along;
  }
}

/// Returns "translation rescaled to kT = 1", "spin drawn", "rotation drawn for species 2, otherwise rescaled to kT =
/// 1".
std::string kind_text(Kind kind, const std::vector<std::array<bool, kKinds>>& kept) {
  std::vector<std::size_t> drawn;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (!kept[k][kind]) drawn.push_back(k + 1);
  }
  constexpr const char* kRescaled = "rescaled to kT = 1";
  if (drawn.empty()) return fmt::format("{} {}", kKindNames[kind], kRescaled);
  if (drawn.size() == kept.size()) return fmt::format("{} drawn", kKindNames[kind]);
  return fmt::format("{} drawn for species {}, otherwise {}", kKindNames[kind], fmt::join(drawn, ", "), kRescaled);
}

std::string report_of(const std::vector<std::array<bool, kKinds>>& kept, const std::array<bool, kKinds>& has) {
  bool all = true;
  bool none = true;
  for (const std::array<bool, kKinds>& of_species : kept) {
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      if (!has[kind]) continue;
      (of_species[kind] ? none : all) = false;
    }
  }
  if (all) return "velocities rescaled to kT = 1";
  if (none) return "velocities drawn";
  std::vector<std::string> parts;
  for (const Kind kind : {kTranslation, kRotation, kSpin}) {
    if (has[kind]) parts.push_back(kind_text(kind, kept));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Takes the frame's velocities; returns whether the bodies are the same bit for bit.
bool take_velocities(ed::System& system, const Frame& frame, const std::vector<std::size_t>& order) {
  bool same = frame.exact.has_value();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const FrameBody& from = frame.bodies[order[k]];
    ed::Body& body = system.bodies[k];
    const ed::Species& species = system.species_of(static_cast<int>(k));
    body.velocity = from.velocity;
    body.angular_velocity = angular_velocity_of(frame, from, body, species);
    same = same && move_alike(frame.exact->species[from.type], species);
  }
  return same;
}

}  // namespace

std::string set_velocities(ed::System& system, const Config& config, const Frame& frame,
                           const std::vector<std::size_t>& order) {
  const bool same = take_velocities(system, frame, order);
  if (!std::isfinite(ed::kinetic_state(system).energy())) {
    throw InputError(fmt::format("{}: its velocities are too large for kinetic energies; accepted: finite ones",
                                 config.start_file->file));
  }
  if (same) return "velocities unchanged";
  ed::System drawn = system;
  draw_thermal(drawn, static_cast<std::uint64_t>(config.seed));
  const ed::KineticState kinetic = ed::kinetic_state(system);
  const std::array<bool, kKinds> has = {true, kinetic.rotational_degrees_of_freedom > 0,
                                        kinetic.spin_degrees_of_freedom > 0};
  const bool turns = frame.angular_velocities || frame.angular_momenta;
  const Vector3d drift = mean_velocity(system);
  const std::vector<int> numbers = config.numbers();
  std::vector<std::array<bool, kKinds>> kept;
  std::vector<SpeciesRange> ranges;
  std::size_t begin = 0;
  for (const int number : numbers) {
    ranges.push_back({begin, begin + static_cast<std::size_t>(number)});
    begin = ranges.back().end;
    const std::array<bool, kKinds> moves = motion_of(system, ranges.back(), drift);
    kept.push_back({frame.velocities && moves[kTranslation], turns && moves[kRotation], turns && moves[kSpin]});
  }
  for (std::size_t k = 0; k < kept.size(); ++k) replace(system, drawn, ranges[k], kept[k]);
  ed::rescale_velocities(system, numbers);
  return report_of(kept, has);
}

}  // namespace hardbody
