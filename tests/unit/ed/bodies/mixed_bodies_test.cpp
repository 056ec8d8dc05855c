// Capsules, ellipsoids of revolution and spheres together in the fast engine: which systems it takes, its lists, its
// collisions beside those of the engine of bodies of any shape, energy, restart.

#include "base/periodic.h"
#include "bodies/uniaxial.h"
#include "neighbours/dilated.h"

#include <common/ed/hash.h>
#include <common/ed/same_collisions.h>
#include <common/ed/uniaxial_bodies.h>
#include <common/geom/batch.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

const geom::Capsule kCapsule(0.6, 0.4);

std::vector<Component> mixture(bool spins) {
  std::vector<Component> components{{uniform_species(kCapsule), 20},
                                    {uniform_species(geom::Ellipsoid({0.4, 0.4, 1.2})), 16},
                                    {uniform_species(geom::Ellipsoid({0.6, 0.6, 0.2})), 16},
                                    {uniform_species(geom::Sphere(0.4)), 12}};
  for (Component& component : components) component.species.spins = spins;
  return components;
}

System start(bool spins = true) {
  StartOptions options;
  options.packing_fraction = 0.3;
  return random_start(mixture(spins), options);
}

System of_species(const std::vector<BodyShape>& shapes) {
  System system;
  for (const BodyShape& shape : shapes) system.species.push_back(uniform_species(shape));
  return system;
}

TEST(MixedBodies, AreHeldByTheFastEngine) {
  const geom::Ellipsoid prolate({0.4, 0.4, 1.2});
  EXPECT_TRUE(UniaxialBodies::can_hold(of_species({kCapsule, prolate})));
  EXPECT_TRUE(UniaxialBodies::can_hold(of_species({prolate, geom::Sphere(1), kCapsule})));
  EXPECT_FALSE(UniaxialBodies::can_hold(of_species({kCapsule, geom::Ellipsoid({0.4, 0.6, 0.8})})));
  EXPECT_FALSE(UniaxialBodies::can_hold(of_species({kCapsule, prolate, geom::Box({1, 1, 1})})));
}

// A species without an axis of revolution, of which there is no body, is enough for the engine of bodies of any shape.
TEST(MixedBodies, CollideAsInTheOtherEngine) {
  for (const bool spins : {true, false}) {
    const System system = start(spins);
    System general = system;
    general.species.push_back(uniform_species(geom::Box({0.3, 0.3, 0.4})));
    ASSERT_FALSE(UniaxialBodies::can_hold(general));
    constexpr std::size_t kCollisions = 300;
    ed_test::expect_same(ed_test::first_collisions(system, {}, kCollisions),
                         ed_test::first_collisions(general, {}, kCollisions), spins ? "spinning" : "without spin");
  }
}

TEST(MixedBodies, KeepEnergyAndTheSameBits) {
  const System system = start();
  Simulation simulation(system);
  const double before = simulation.kinetic().energy();
  simulation.run_collisions(2000);
  const Simulation halfway = Simulation::restore(simulation.save(), system.species);
  simulation.run_collisions(2000);
  const double drift = std::abs(simulation.kinetic().energy() / before - 1);
  std::printf("energy %.1e\n", drift);
  EXPECT_LE(drift, 1e-13);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(simulation.counters().declined, 0U);
  Simulation restored = Simulation::restore(halfway.save(), system.species);
  restored.run_collisions(2000);
  EXPECT_EQ(ed_test::hash_of(restored), ed_test::hash_of(simulation));

  std::vector<std::optional<geom::InstructionSet>> ways{std::nullopt};
  for (const geom::InstructionSet set : geom_test::instruction_sets()) ways.emplace_back(set);
  for (const auto& way : ways) {
    SimulationOptions options;
    options.batches = way;
    Simulation other(system, options);
    other.run_collisions(4000);
    EXPECT_EQ(ed_test::hash_of(other), ed_test::hash_of(simulation)) << (way ? geom::to_string(*way) : "one by one");
  }
}

// Dilated envelopes that overlap are found, and few others.
TEST(MixedBodies, HaveAllNeighboursInTheirLists) {
  Random random(3);
  std::vector<Species> species;
  for (const Component& component : mixture(true)) species.push_back(component.species);
  int near = 0;
  int far = 0;
  for (int repetition = 0; repetition < 20; ++repetition) {
    constexpr int kNumber = 40;
    const double box = 6 + 4 * random.uniform();
    const UniaxialBodies bodies = ed_test::random_bodies(species, kNumber, box, random);
    const double thickness = 0.5 * random.uniform();
    DilatedEnvelopes envelopes(bodies, thickness, thickness);
    for (int i = 0; i < kNumber; ++i) envelopes.place(i, bodies, 0.3);
    for (int i = 0; i < kNumber; ++i) {
      const Motion a = bodies.motion(i, 0.3);
      for (int k = 0; k < kNumber; ++k) {
        if (i == k) continue;
        const Motion b = bodies.motion(k, 0.3);
        const Vector3d r = nearest_image(b.pose.position() - a.pose.position(), box);
        const auto shape = [&](int body) { return species[static_cast<std::size_t>(bodies.kind_index(body))].shape; };
        const double gap = ed::distance(shape(i), geom::Pose(a.pose.rotation(), Vector3d(0, 0, 0)), shape(k),
                                        geom::Pose(b.pose.rotation(), r))
                               .distance;
        Vector3d normal;
        const bool taken = envelopes.may_overlap(i, k, r, normal);
        EXPECT_TRUE(taken || !(gap < 2 * thickness - 1e-12)) << i << ' ' << k << ' ' << gap;
        EXPECT_TRUE(!taken || std::abs(normal.norm() - 1) < 1e-14);
        near += taken ? 1 : 0;
        far += taken && gap > 2 * thickness + 1e-12 ? 1 : 0;
      }
    }
  }
  std::printf("%d taken, %d of them in vain\n", near, far);
  EXPECT_GT(near, 1000);
  EXPECT_LT(20 * far, near);
}

}  // namespace
}  // namespace ed::internal
