#include "start/insertion.h"
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
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ed {
namespace {

using internal::dilute_packing;
using internal::has_size_classes;
using internal::report;

/// Collisions a body between two shrinkings of the box.
constexpr double kPauseCollisions = 0.03;

/// New envelopes a body between two shrinkings, at the most, where sizes differ by factors: there the closest pair, one
/// of a large body, decides about the step, and is soon another one.
constexpr double kPauseRebuilds = 0.1;

/// The compression is stuck when the packing fraction grows by less than this over kStuckRounds rounds.
constexpr double kStuckGrowth = 1e-5;
constexpr int kStuckRounds = 2000;

/// Maximum number of events between two calls of StartOptions::progress.
constexpr std::uint64_t kLookEvents = 1000000;

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

/// Adds the counts and failures of a compression.
void add(const Counters& counters, const std::vector<FailedPair>& failures, const StartOptions& options) {
  if (options.counters != nullptr) *options.counters += counters;
  if (options.failures == nullptr) return;
  options.failures->insert(options.failures->end(), failures.begin(), failures.end());
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
  const double most_rebuilds =
      has_size_classes(system) ? system.size() * kPauseRebuilds : std::numeric_limits<double>::infinity();
  double pause = 0.1 * longest_pause;
  // Bodies that roll on each other in small hops leave almost no room for a while: a gain far below the usual one is
  // not worth the work, and would force them into smaller hops. The threshold is lowered only if no better gain occurs
  // for long.
  double usual_gain = 0;
  double checkpoint = simulation.box();
  const double bodies = packing_fraction(light) * std::pow(light.box, 3);
  const auto reached = [&] { return bodies / std::pow(simulation.box(), 3); };
  const auto look_up = [&] { report(options, reached()); };
  for (int round = 1; simulation.box() > target_box; ++round) {
    const Counters before = simulation.counters();
    const double end = simulation.time() + pause;
    while (!simulation.run_until(end, ~std::uint64_t{0}, kLookEvents) && !simulation.stall()) look_up();
    if (simulation.stall()) throw std::runtime_error("the compression " + describe(*simulation.stall()));
    const Counters after = simulation.counters();
    const bool long_enough = static_cast<double>(after.collisions - before.collisions) > wanted ||
                             static_cast<double>(after.neighbour_rebuilds - before.neighbour_rebuilds) > most_rebuilds;
    pause *= long_enough ? 0.8 : 1.25;
    pause = std::min(pause, longest_pause);
    const double old_box = simulation.box();
    const double gain = 1 - simulation.shrink_box(target_box, 0.3 * usual_gain) / old_box;
    usual_gain += 0.1 * (gain > 0 ? gain - usual_gain : -0.02 * usual_gain);
    look_up();
    if (round % kStuckRounds == 0) {
      if (simulation.box() > checkpoint * (1 - kStuckGrowth)) {
        std::ostringstream message;
        message << "packing_fraction: the compression got stuck at " << reached() << " of "
                << bodies / std::pow(target_box, 3)
                << "; a lower value is needed for this shape, or another seed, or more bodies";
        throw std::runtime_error(message.str());
      }
      checkpoint = simulation.box();
    }
  }
  add(simulation.counters(), simulation.failures(), options);
  System result = with_masses(simulation.system(), system.species);
  result.box = target_box;
  return result;
}

/// Compresses the bodies that have been inserted so far.
void compress(internal::Insertion& insertion, double target, const StartOptions& options, Random& random) {
  System inserted = insertion.inserted();
  if (!(inserted.box > target)) return;
  if (inserted.size() == 1) {
    inserted.bodies[0].position *= target / inserted.box;
    inserted.box = target;
    insertion.set_inserted(inserted);
    return;
  }
  internal::draw_velocities(inserted, random);
  internal::rescale_together(inserted);
  insertion.set_inserted(compress(inserted, target, options));
}

System compressed_start(const std::vector<Component>& components, const StartOptions& options, Random& random) {
  const double target = box_for(components, options.packing_fraction);
  internal::Insertion insertion(components, options);
  // Where sizes differ by factors, the largest bodies are compressed before smaller ones are inserted between them.
  while (insertion.insert_class(random)) compress(insertion, insertion.next_box(target), options, random);
  System system = insertion.inserted();
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
  const internal::Tiling tiling = internal::tiling_of(components, options.packing_fraction, options.most_compressed);
  StartOptions of_tile = options;
  of_tile.packing_fraction = tiling.packing_fraction;
  return internal::Insertion(tiling.tile, of_tile).most_compressed(box_for(tiling.tile, tiling.packing_fraction));
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
