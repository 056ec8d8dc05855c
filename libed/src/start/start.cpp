#include "base/poll.h"
#include "cells/grid.h"
#include "neighbours/limits.h"
#include "start/nematic.h"
#include "start/parts.h"
#include "start/tiles.h"

#include <ed/random.h>
#include <ed/shape.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using internal::NematicOrientations;

/// Packing fraction of the random insertion up to an aspect ratio of 10, where the excluded volume is 13 times a
/// body's. Beyond, it falls as the excluded volume grows, so that a position is found within a few tries.
constexpr double kDilute = 0.04;

double dilute_packing(const std::vector<Component>& components) {
  double least = 1;
  for (const auto& [species, number] : components) {
    least = std::min(least, 10 * inscribed_radius(species.shape) / bounding_radius(species.shape));
  }
  return kDilute * least;
}

/// Maximum number of tries to insert one body.
constexpr int kInsertions = 100000;

/// Collisions a body between two shrinkings of the box.
constexpr double kPauseCollisions = 0.03;

/// The compression is stuck when the packing fraction grows by less than this over kStuckRounds rounds.
constexpr double kStuckGrowth = 1e-5;
constexpr int kStuckRounds = 2000;

/// Maximum number of events between two calls of StartOptions::progress.
constexpr std::uint64_t kLookEvents = 1000000;

/// Returns a dilute box whose bodies are not placed yet.
System empty_box(const std::vector<Component>& components, double packing_fraction) {
  System system = internal::bodies_of(components);
  const double dilute = dilute_packing(components);
  system.box = std::max(box_for(components, std::min(packing_fraction, dilute)),
                        1.05 * internal::smallest_image_box(internal::largest_radius(components)));
  // A box at the wanted packing fraction is used unchanged, so that nothing is left to compress.
  if (packing_fraction <= dilute) system.box = box_for(components, packing_fraction);
  return system;
}

/// Reports the packing fraction that is reached. Throws std::runtime_error if the start is to stop.
void report(const StartOptions& options, double packing_fraction) {
  if (options.progress && !options.progress(packing_fraction)) {
    throw std::runtime_error("interrupted during the compression");
  }
}

/// Inserts bodies by random sequential insertion into a box large enough for it.
System insert_bodies(const std::vector<Component>& components, const StartOptions& options, Random& random) {
  System system = empty_box(components, options.packing_fraction);
  std::optional<NematicOrientations> nematic;
  if (options.nematic_order) nematic.emplace(*options.nematic_order);
  const double reach = 2 * internal::largest_radius(components);
  internal::CellGrid cells(system.size(), system.box, reach);
  std::vector<geom::Pose> poses;
  std::vector<internal::NearBody> near;
  const double share = packing_fraction(system) / system.size();
  for (int i = 0; i < system.size(); ++i) {
    internal::poll_at(i, [&] { report(options, i * share); });
    // Drawn once a body: if it were drawn again with each position, aligned bodies would be accepted more often.
    Matrix3d orientation;
    if (nematic) orientation = nematic->draw(internal::ordered_axis(system.species_of(i)), random);
    for (int attempt = 0;; ++attempt) {
      if (attempt == kInsertions) throw std::runtime_error("random start: no place found for a body");
      const double x = random.uniform() - 0.5;
      const double y = random.uniform() - 0.5;
      const double z = random.uniform() - 0.5;
      const geom::Pose pose(nematic ? orientation : random.rotation(), system.box * Vector3d(x, y, z));
      const auto others = cells.collect(pose.position(), reach, near);
      const bool blocked = std::any_of(others.begin(), others.end(), [&](const internal::NearBody& other) {
        const geom::Pose& X = poses[static_cast<std::size_t>(other.body)];
        return internal::overlaps(system.species_of(i).shape, pose, system.species_of(other.body).shape,
                                  geom::Pose(X.rotation(), pose.position() + other.r));
      });
      if (blocked) continue;
      poses.push_back(pose);
      cells.place(i, pose.position());
      break;
    }
  }
  for (int i = 0; i < system.size(); ++i) {
    Body& body = system.bodies[static_cast<std::size_t>(i)];
    body.position = poses[static_cast<std::size_t>(i)].position();
    body.rotation = poses[static_cast<std::size_t>(i)].rotation();
  }
  return system;
}

/// Returns the system with masses of 1 and velocities scaled by sqrt(m), which keeps the temperature. The accessible
/// configurations do not depend on masses, and with equal masses no bodies are slower than others.
System with_unit_masses(System system) {
  for (Body& body : system.bodies) {
    const double faster = std::sqrt(system.species[static_cast<std::size_t>(body.species)].mass);
    body.velocity *= faster;
    body.angular_velocity *= faster;
  }
  for (Species& species : system.species) {
    species.inertia /= species.mass;
    species.mass = 1;
  }
  return system;
}

/// Reverses with_unit_masses.
System with_masses(System system, const std::vector<Species>& species) {
  system.species = species;
  for (int i = 0; i < system.size(); ++i) {
    Body& body = system.bodies[static_cast<std::size_t>(i)];
    const double faster = std::sqrt(system.species_of(i).mass);
    body.velocity /= faster;
    body.angular_velocity /= faster;
  }
  return system;
}

void clear(const StartOptions& options) {
  if (options.counters != nullptr) *options.counters = {};
  if (options.failures != nullptr) options.failures->clear();
}

System compress(const System& system, double target_box, const StartOptions& options) {
  const System light = with_unit_masses(system);
  const double longest_pause = time_unit(light);
  SimulationOptions methods;
  methods.poll = [&] { report(options, packing_fraction(light)); };
  Simulation simulation(light, methods);
  // The box shrinks at fixed times, not after a given number of collisions: right after a collision two bodies touch. A
  // pause of a few collisions moves the closest pair apart, which is all that the next step needs; its length follows
  // the collision rate.
  const double wanted = system.size() * kPauseCollisions;
  double pause = 0.1 * longest_pause;
  // Bodies that roll on each other in small hops leave almost no room for a while: a gain far below the usual one is
  // not worth the work, and would force them into smaller hops. The threshold is lowered only if no better gain occurs
  // for long.
  double usual_gain = 0;
  double checkpoint = simulation.box();
  const auto reached = [&] { return options.packing_fraction * std::pow(target_box / simulation.box(), 3); };
  const auto look_up = [&] { report(options, reached()); };
  for (int round = 1; simulation.box() > target_box; ++round) {
    const std::uint64_t before = simulation.counters().collisions;
    const double end = simulation.time() + pause;
    while (!simulation.run_until(end, ~std::uint64_t{0}, kLookEvents) && !simulation.stall()) look_up();
    if (simulation.stall()) throw std::runtime_error("the compression " + describe(*simulation.stall()));
    pause *= static_cast<double>(simulation.counters().collisions - before) > wanted ? 0.8 : 1.25;
    pause = std::min(pause, longest_pause);
    const double old_box = simulation.box();
    const double gain = 1 - simulation.shrink_box(target_box, 0.3 * usual_gain) / old_box;
    usual_gain += 0.1 * (gain > 0 ? gain - usual_gain : -0.02 * usual_gain);
    look_up();
    if (round % kStuckRounds == 0) {
      if (simulation.box() > checkpoint * (1 - kStuckGrowth)) {
        std::ostringstream message;
        message << "packing_fraction: the compression got stuck at " << reached() << " of " << options.packing_fraction
                << "; a lower value is needed for this shape, or another seed, or more bodies";
        throw std::runtime_error(message.str());
      }
      checkpoint = simulation.box();
    }
  }
  if (options.counters != nullptr) *options.counters = simulation.counters();
  if (options.failures != nullptr) *options.failures = simulation.failures();
  System result = with_masses(simulation.system(), system.species);
  result.box = target_box;
  return result;
}

System compressed_start(const std::vector<Component>& components, const StartOptions& options, Random& random) {
  const double target = box_for(components, options.packing_fraction);
  System system = insert_bodies(components, options, random);
  internal::draw_velocities(system, random);
  internal::rescale_together(system);
  return system.box > target ? compress(system, target, options) : system;
}

/// Relative difference of boxes that are regarded as the same.
constexpr double kSameBox = 1e-12;

/// Returns each body as a component of its own.
std::vector<Component> components_of(const System& system) {
  std::vector<Component> components;
  components.reserve(system.bodies.size());
  for (int i = 0; i < system.size(); ++i) components.push_back({system.species_of(i), 1});
  return components;
}

void check_packing(const std::vector<Component>& components, double packing_fraction) {
  const double densest = densest_start(components);
  if (packing_fraction > 0 && packing_fraction <= densest) return;
  std::ostringstream message;
  message << "packing_fraction is " << packing_fraction << "; accepted: above 0, at most " << densest << " for "
          << (components.size() == 1 ? "this shape" : "these shapes");
  throw std::invalid_argument(message.str());
}

}  // namespace

double densest_start(const BodyShape& shape) {
  const double ratio = bounding_radius(shape) / inscribed_radius(shape);
  return 0.68 - 0.06 * std::max(0.0, 1 - (ratio - 1) / 0.4);
}

double densest_start(const std::vector<Component>& components) {
  double densest = 1;
  for (const Component& component : components) densest = std::min(densest, densest_start(component.species.shape));
  return densest;
}

System random_start(const Species& species, const StartOptions& options) {
  check_species(species);
  check_packing(std::vector<Component>{{species, options.number}}, options.packing_fraction);
  const int least = smallest_number(species.shape, options.packing_fraction);
  if (options.number < least) {
    std::ostringstream message;
    message << "number is " << options.number << ": the box at this packing fraction is then too small for bodies of "
            << "bounding radius " << bounding_radius(species.shape) << " (a body could meet two images of another); "
            << "accepted: at least " << least;
    throw std::invalid_argument(message.str());
  }
  return random_start(std::vector<Component>{{species, options.number}}, options);
}

int compressed_together(const std::vector<Component>& components, const StartOptions& options) {
  if (options.packing_fraction <= dilute_packing(components)) return 0;
  int number = 0;
  for (const Component& component :
       internal::tiling_of(components, options.packing_fraction, options.most_compressed).tile) {
    number += component.number;
  }
  return number;
}

System random_start(const std::vector<Component>& components, const StartOptions& options) {
  internal::check_components(components);
  check_packing(components, options.packing_fraction);
  internal::check_target(components, box_for(components, options.packing_fraction));
  clear(options);
  Random random(options.seed);
  const bool dilute = options.packing_fraction <= dilute_packing(components);
  const internal::Tiling tiling =
      dilute ? internal::Tiling{1, components, {}, options.packing_fraction}
             : internal::tiling_of(components, options.packing_fraction, options.most_compressed);
  StartOptions of_tile = options;
  of_tile.packing_fraction = tiling.packing_fraction;
  System system = compressed_start(tiling.tile, of_tile, random);
  if (tiling.along > 1) {
    system = internal::repeat(system, tiling, components, random);
    internal::draw_velocities(system, random);
    internal::rescale_together(system);
  }
  internal::number_along_curve(system);
  rescale_velocities(system, options.groups);
  return system;
}

System compressed(const System& system, double packing_fraction, const std::function<bool(double)>& progress,
                  Counters* counters, std::vector<FailedPair>* failures, const std::vector<int>& groups) {
  const std::vector<Component> components = components_of(system);
  internal::check_components(components);
  check_packing(components, packing_fraction);
  const double target = system.box * std::cbrt(ed::packing_fraction(system) / packing_fraction);
  if (target > system.box * (1 + kSameBox)) {
    std::ostringstream message;
    message << "packing_fraction is " << packing_fraction << ", below that of the state; accepted: at least "
            << ed::packing_fraction(system);
    throw std::invalid_argument(message.str());
  }
  internal::check_target(components, target);
  StartOptions options;
  options.packing_fraction = packing_fraction;
  options.progress = progress;
  options.counters = counters;
  options.failures = failures;
  clear(options);
  System result = target < system.box * (1 - kSameBox) ? compress(system, target, options) : system;
  rescale_velocities(result, groups);
  return result;
}

}  // namespace ed
