#include "cell_grid.h"
#include "dilated_envelopes.h"

#include <ed/random.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <geom/queries.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;

/// Packing fraction of the random insertion up to an aspect ratio of 10, where the excluded volume is 13 times a
/// body's; beyond, it falls as the excluded volume grows. Low enough that a place is found within a few tries.
constexpr double kDilute = 0.04;

double dilute_packing(const geom::Ellipsoid& shape) {
  return kDilute * std::min(1.0, 10 * shape.inscribed_radius() / shape.bounding_radius());
}

/// Tries to insert one body before giving up.
constexpr int kInsertions = 100000;

/// Collisions a body between two shrinkings of the box.
constexpr double kPauseCollisions = 0.03;

/// The compression is stuck when the packing fraction grows by less than this over kStuckRounds rounds.
constexpr double kStuckGrowth = 1e-5;
constexpr int kStuckRounds = 2000;

bool overlaps(const geom::Ellipsoid& shape, const geom::Pose& a, const geom::Pose& b) {
  return geom::overlap(shape, a, shape, b) != geom::Answer::no;
}

/// Random sequential insertion into a box large enough for it.
System insert_bodies(const Species& species, int number, double packing_fraction, Random& random) {
  const geom::Ellipsoid& shape = species.shape;
  System system;
  system.species = species;
  system.box = std::max(box_for(shape, number, std::min(packing_fraction, dilute_packing(shape))),
                        1.05 * internal::smallest_box(shape.bounding_radius()));
  // A box at the wanted packing fraction is taken as it is, so that nothing is left to compress.
  if (packing_fraction <= dilute_packing(shape)) system.box = box_for(shape, number, packing_fraction);
  const double reach = 2 * shape.bounding_radius();
  internal::CellGrid cells(number, system.box, reach);
  std::vector<geom::Pose> poses;
  std::vector<internal::NearBody> near;
  for (int i = 0; i < number; ++i) {
    for (int attempt = 0;; ++attempt) {
      if (attempt == kInsertions) throw std::runtime_error("random start: no place found for a body");
      const double x = random.uniform() - 0.5;
      const double y = random.uniform() - 0.5;
      const double z = random.uniform() - 0.5;
      const geom::Pose pose(random.rotation(), system.box * Vector3d(x, y, z));
      const auto others = cells.collect(pose.position(), reach, near);
      const bool blocked = std::any_of(others.begin(), others.end(), [&](const internal::NearBody& other) {
        const geom::Pose& X = poses[static_cast<std::size_t>(other.body)];
        return overlaps(shape, pose, geom::Pose(X.rotation(), pose.position() + other.r));
      });
      if (blocked) continue;
      poses.push_back(pose);
      cells.place(i, pose.position());
      break;
    }
  }
  for (const geom::Pose& pose : poses) {
    system.bodies.push_back({pose.position(), pose.rotation(), Vector3d::Zero(), Vector3d::Zero()});
  }
  return system;
}

void draw_velocities(System& system, Random& random) {
  const int axis = *system.species.shape.symmetry_axis();
  for (Body& body : system.bodies) {
    body.velocity = random.normal3();
    const Vector3d w = random.normal3();
    // Body-frame components with variance kT / I; rescaled exactly afterwards.
    Vector3d omega = w.cwiseQuotient(system.species.inertia.cwiseSqrt());
    if (!system.species.spins) omega[axis] = 0;
    body.angular_velocity = body.rotation * omega;
  }
  rescale_velocities(system);
}

System compress(const System& system, double target_box, const StartOptions& options) {
  Simulation simulation(system);
  // The box shrinks at fixed times, not after a given number of collisions: right after a collision two bodies touch. A
  // pause of a few collisions moves the closest pair apart, which is all that the next step needs; its length follows
  // the collision rate.
  const double wanted = system.size() * kPauseCollisions;
  double pause = 0.1;
  // Bodies that roll on each other in small hops leave next to no room for a while: a gain far below the usual one is
  // not worth the work, and would squeeze them into smaller hops. The threshold falls only if nothing better comes for
  // long.
  double usual_gain = 0;
  double checkpoint = simulation.box();
  for (int round = 1; simulation.box() > target_box; ++round) {
    const std::uint64_t before = simulation.counters().collisions;
    simulation.run_until(simulation.time() + pause);
    pause *= static_cast<double>(simulation.counters().collisions - before) > wanted ? 0.8 : 1.25;
    pause = std::min(pause, 1.0);
    const double old_box = simulation.box();
    const double gain = 1 - simulation.shrink_box(target_box, 0.3 * usual_gain) / old_box;
    usual_gain += 0.1 * (gain > 0 ? gain - usual_gain : -0.02 * usual_gain);
    if (options.progress && round % 50 == 0) {
      const double phi = options.packing_fraction * std::pow(target_box / simulation.box(), 3);
      if (!options.progress(phi)) throw std::runtime_error("interrupted during the compression");
    }
    if (round % kStuckRounds == 0) {
      if (simulation.box() > checkpoint * (1 - kStuckGrowth)) {
        std::ostringstream message;
        message << "packing_fraction: the compression got stuck at "
                << options.packing_fraction * std::pow(target_box / simulation.box(), 3) << " of "
                << options.packing_fraction << "; a lower value is needed for this shape";
        throw std::runtime_error(message.str());
      }
      checkpoint = simulation.box();
    }
  }
  System result = simulation.system();
  result.box = target_box;
  return result;
}

}  // namespace

double densest_start(const geom::Ellipsoid& shape) {
  const double ratio = shape.bounding_radius() / shape.inscribed_radius();
  return 0.68 - 0.06 * std::max(0.0, 1 - (ratio - 1) / 0.4);
}

void rescale_velocities(System& system) {
  const int n = system.size();
  Vector3d mean = Vector3d::Zero();
  for (const Body& body : system.bodies) mean += body.velocity / n;
  for (Body& body : system.bodies) body.velocity -= mean;
  const KineticState now = kinetic_state(system);  // refuses bodies that are not of revolution
  const int axis = *system.species.shape.symmetry_axis();
  const auto factor = [](double wanted, double energy) { return energy > 0 ? std::sqrt(wanted / energy) : 0.0; };
  const double translation = factor(0.5 * (3 * n - 3), now.translational_energy);
  const double rotation = factor(0.5 * 2 * n, now.rotational_energy);
  const double spin = factor(0.5 * n, now.spin_energy);
  for (Body& body : system.bodies) {
    const Vector3d u = body.rotation.col(axis);
    const double w = body.angular_velocity.dot(u);
    body.velocity *= translation;
    body.angular_velocity = rotation * (body.angular_velocity - w * u) + (system.species.spins ? spin * w : 0.0) * u;
  }
}

System random_start(const Species& species, const StartOptions& options) {
  if (!species.shape.symmetry_axis()) {
    throw std::invalid_argument("semi_axes: three different semi-axes are not available yet; accepted: two equal ones");
  }
  const double densest = densest_start(species.shape);
  if (!(options.packing_fraction > 0 && options.packing_fraction <= densest)) {
    std::ostringstream message;
    message << "packing_fraction is " << options.packing_fraction << "; accepted: above 0, at most " << densest
            << " for this shape";
    throw std::invalid_argument(message.str());
  }
  const int least = smallest_number(species.shape, options.packing_fraction);
  if (options.number < least) {
    std::ostringstream message;
    message << "number is " << options.number << ": the box at this packing fraction is then too small for bodies of "
            << "bounding radius " << species.shape.bounding_radius() << " (a body could meet two images of another); "
            << "accepted: at least " << least;
    throw std::invalid_argument(message.str());
  }
  Random random(options.seed);
  System system = insert_bodies(species, options.number, options.packing_fraction, random);
  draw_velocities(system, random);
  const double target = box_for(species.shape, options.number, options.packing_fraction);
  if (system.box > target) system = compress(system, target, options);
  rescale_velocities(system);
  return system;
}

}  // namespace ed
