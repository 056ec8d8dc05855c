// The event loop on cases solved by hand, and what it refuses.

#include <common/ed/hash.h>
#include <common/ed/states.h>
#include "common/ed/two_bodies.h"

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace {

using ed_test::Inertia;
using Eigen::Vector3d;
using two_bodies::sphere;
using two_bodies::two_bodies;

/// Positions of order 10, a few events.
constexpr double kRunRounding = 1e-13;

TEST(Simulation, SpheresThatMeetHeadOnExchangeVelocities) {
  ed::System system = two_bodies(sphere(), 20, {5, 0, 0});
  system.bodies[0].velocity = {2, 0.5, 0};
  system.bodies[1].velocity = {-1, 0.5, 0};
  ed::Simulation simulation(system);
  simulation.record_collisions(10);
  simulation.run_until(2);
  // A gap of 3 at speed 3.
  ASSERT_EQ(simulation.collisions().size(), 1U);
  EXPECT_NEAR(simulation.collisions()[0].time, 1, kRunRounding);
  EXPECT_EQ(simulation.collisions()[0].i, 0);
  EXPECT_EQ(simulation.collisions()[0].j, 1);
  const ed::System end = simulation.system();
  EXPECT_NEAR((end.bodies[0].velocity - Vector3d(-1, 0.5, 0)).norm(), 0, kRunRounding);
  EXPECT_NEAR((end.bodies[1].velocity - Vector3d(2, 0.5, 0)).norm(), 0, kRunRounding);
  EXPECT_NEAR((end.bodies[0].position - Vector3d(1, 1, 0)).norm(), 0, kRunRounding);
  EXPECT_NEAR((end.bodies[1].position - Vector3d(6, 1, 0)).norm(), 0, kRunRounding);
  // r_AB . dp = 2 x 3: B gains 3 along the line of centres.
  EXPECT_NEAR(simulation.virial(), 6, kRunRounding);
  EXPECT_EQ(simulation.counters().collisions, 1U);
}

TEST(Simulation, BodiesMeetThroughTheFacesOfTheBox) {
  ed::System system = two_bodies(sphere(), 12, {5, 5, 5});
  system.bodies[0].position = {-5, -5, -5};
  // The nearest image of body 1 is at (-7, -7, -7): 2 sqrt(3) away, a gap of 1.464 at speed sqrt(3).
  system.bodies[0].velocity = {-1, -1, -1};
  ed::Simulation simulation(system);
  simulation.record_collisions(1);
  simulation.run_collisions(1);
  ASSERT_EQ(simulation.collisions().size(), 1U);
  EXPECT_NEAR(simulation.collisions()[0].time, 2 - 2 / std::sqrt(3.0), kRunRounding);
}

TEST(Simulation, SamplesTranslationsAlone) {
  const ed::Simulation simulation(ed_test::start({.aspect_ratio = 2, .number = 64}));
  ed::Snapshot whole, translations;
  simulation.sample(whole);
  simulation.sample_translations(translations);
  EXPECT_EQ(translations.position, whole.position);
  EXPECT_EQ(translations.velocity, whole.velocity);
  ASSERT_EQ(translations.axis.size(), whole.axis.size());
  EXPECT_EQ(translations.axis[0], Eigen::Vector3d::Zero().eval());
  EXPECT_EQ(translations.angular_velocity[0], Eigen::Vector3d::Zero().eval());
}

TEST(Simulation, BodiesAtRestAreRefusedWhereCollisionsAreAwaited) {
  ed::System system = two_bodies(sphere(), 12, {5, 5, 5});
  for (ed::Body& body : system.bodies) body.velocity = body.angular_velocity = Vector3d::Zero();
  ed::Simulation simulation(system);
  simulation.run_collisions(0);
  EXPECT_THROW(simulation.run_collisions(1), std::invalid_argument);
  EXPECT_THROW(simulation.tune_envelopes(), std::invalid_argument);
  EXPECT_TRUE(simulation.run_until(3));
  EXPECT_EQ(simulation.time(), 3);
}

TEST(Simulation, CollisionsComeAtTheirTimesHoweverLongTheRun) {
  // Of two equal spheres in a row with their images one rests, and each collision hands the velocity on.
  ed::System system = two_bodies(sphere(), 10, {5, 0, 0});
  system.bodies[0].velocity = {1, 0, 0};
  ed::Simulation simulation(system);
  simulation.record_collisions(5000);
  simulation.run_until(20000);
  // A gap of 3 at speed 1 first, then of 10 - 4.
  ASSERT_EQ(simulation.collisions().size(), 3333U);
  for (std::size_t k = 0; k < 3333; ++k) {
    const double wanted = 3 + 6 * static_cast<double>(k);
    // Errors of single collisions add up, at worst linearly.
    ASSERT_NEAR(simulation.collisions()[k].time, wanted, 1e-14 * static_cast<double>(k + 10));
  }
  EXPECT_EQ(simulation.time(), 20000);
}

TEST(Simulation, AgreesWithTimeOfContactOnOnePair) {
  ed::Random random(21);
  for (const double X0 : {0.3, 3.0}) {
    const ed::Species species = ed_test::species(X0, Inertia::uniform);
    for (int round = 0; round < 50; ++round) {
      const double R = ed::bounding_radius(species.shape);
      ed::System system = two_bodies(species, 20 * R, 3 * R * random.direction());
      for (ed::Body& body : system.bodies) {
        body.rotation = random.rotation();
        body.angular_velocity = random.normal3();
        body.velocity = 0.1 * random.normal3();
      }
      system.bodies[1].velocity -= system.bodies[1].position;
      const auto motion = [&](int i) {
        const ed::Body& b = system.bodies[static_cast<std::size_t>(i)];
        return ed::Motion{geom::Pose(b.rotation, b.position), b.velocity, b.angular_velocity, species.inertia, 0};
      };
      const ed::ContactResult contact = ed::time_of_contact(species.shape, motion(0), species.shape, motion(1), 2);
      ed::Simulation simulation(system);
      simulation.record_collisions(1);
      simulation.run_until(2, 1);
      ASSERT_EQ(simulation.collisions().size(), contact.status == ed::ContactStatus::hit ? 1U : 0U);
      if (contact.status == ed::ContactStatus::hit) {
        ASSERT_NEAR(simulation.collisions()[0].time, contact.time, 1e-12);
      }
    }
  }
}

TEST(Simulation, StopsAtTheTimeOrTheNumberOfCollisions) {
  ed::Simulation simulation(ed_test::start({2, 0.3, 48, Inertia::paper, 22}));
  EXPECT_FALSE(simulation.run_until(100, 10));
  EXPECT_EQ(simulation.counters().collisions, 10U);
  const double time = simulation.time();
  EXPECT_LT(time, 100);
  EXPECT_TRUE(simulation.run_until(time + 0.5));
  EXPECT_EQ(simulation.time(), time + 0.5);
  // A time that has passed changes nothing.
  const std::uint64_t hash = ed_test::hash_of(simulation);
  EXPECT_TRUE(simulation.run_until(time));
  EXPECT_EQ(ed_test::hash_of(simulation), hash);
  const std::uint64_t collisions = simulation.counters().collisions;
  simulation.run_collisions(25);
  EXPECT_EQ(simulation.counters().collisions, collisions + 25);
}

TEST(Simulation, RecordsOnlyTheCollisionsAskedFor) {
  ed::Simulation simulation(ed_test::start({2, 0.3, 48, Inertia::paper, 23}));
  simulation.run_collisions(5);
  EXPECT_TRUE(simulation.collisions().empty());
  simulation.record_collisions(7);
  simulation.run_collisions(20);
  ASSERT_EQ(simulation.collisions().size(), 7U);
  for (const ed::Collision& collision : simulation.collisions()) {
    EXPECT_LT(collision.i, collision.j);
    EXPECT_GE(collision.i, 0);
    EXPECT_LT(collision.j, 48);
  }
  simulation.record_collisions(3);
  EXPECT_TRUE(simulation.collisions().empty());
  simulation.run_collisions(20);
  EXPECT_EQ(simulation.collisions().size(), 3U);
}

TEST(Simulation, StateGoesInAndOutUnchanged) {
  const ed::System system = ed_test::start({0.5, 0.3, 48, Inertia::uniform, 24});
  const ed::Simulation simulation(system);
  const ed::System out = simulation.system();
  EXPECT_EQ(out.box, system.box);
  ASSERT_EQ(out.size(), system.size());
  for (std::size_t i = 0; i < system.bodies.size(); ++i) {
    const ed::Body& a = system.bodies[i];
    const ed::Body& b = out.bodies[i];
    EXPECT_LE((a.position - b.position).norm(), kRunRounding);
    EXPECT_LE((a.rotation - b.rotation).norm(), kRunRounding);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_LE((a.angular_velocity - b.angular_velocity).norm(), 1e-14 * a.angular_velocity.norm());
  }
  const ed::KineticState inside = simulation.kinetic();
  const ed::KineticState outside = ed::kinetic_state(system);
  EXPECT_NEAR(inside.translational_energy, outside.translational_energy, 1e-12);
  EXPECT_NEAR(inside.rotational_energy, outside.rotational_energy, 1e-12);
  EXPECT_NEAR(inside.spin_energy, outside.spin_energy, 1e-12);
}

TEST(Simulation, SamplesAreUnwrapped) {
  ed::System system = two_bodies(sphere(), 10, {0, 5, 0});
  system.bodies[0].velocity = {3, 0, 0};
  ed::Simulation simulation(system);
  ed::Snapshot snapshot;
  simulation.run_until(12.5);
  simulation.sample(snapshot);
  EXPECT_EQ(snapshot.time, 12.5);
  EXPECT_NEAR((snapshot.position[0] - Vector3d(37.5, 0, 0)).norm(), 0, kRunRounding);
  EXPECT_NEAR((snapshot.position[1] - Vector3d(0, 5, 0)).norm(), 0, kRunRounding);
  // The system is wrapped: 37.5 - 4 x 10.
  EXPECT_NEAR((simulation.system().bodies[0].position - Vector3d(-2.5, 0, 0)).norm(), 0, kRunRounding);
}

TEST(Simulation, ShrinkingTheBoxLeavesNoOverlapAndTheVelocities) {
  ed::Simulation simulation(ed_test::start({3, 0.2, 72, Inertia::paper, 25}));
  const ed::KineticState before = simulation.kinetic();
  const double box = simulation.box();
  double last = box;
  for (int round = 0; round < 200; ++round) {
    simulation.run_until(simulation.time() + 0.02);
    const double energy = simulation.kinetic().energy();
    const double shrunk = simulation.shrink_box(0);
    EXPECT_EQ(shrunk, simulation.box());
    ASSERT_LE(shrunk, last);
    EXPECT_NEAR(simulation.kinetic().energy() / energy, 1, 1e-14);
    last = shrunk;
    if (round % 20 == 0) {
      const ed::Audit audit = ed::audit(simulation.system());
      ASSERT_GE(audit.minimum_distance, -ed::kAuditOverlap);
      ASSERT_EQ(audit.unanswered, 0);
    }
  }
  EXPECT_LT(last, 0.95 * box);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_NEAR(simulation.kinetic().energy() / before.energy(), 1, 1e-12);
}

TEST(Simulation, ShrinkingStopsAtTheTarget) {
  ed::Simulation simulation(ed_test::grid(sphere(), 4, 4));
  const double target = 15.9;
  for (int round = 0; round < 20 && simulation.box() > target; ++round) (void)simulation.shrink_box(target);
  EXPECT_NEAR(simulation.box(), target, 1e-13);
  EXPECT_EQ(simulation.shrink_box(17), simulation.box());
  // Not worth it: 1 - s would be below the least gain.
  EXPECT_NEAR(simulation.shrink_box(0.999 * target, 0.01), target, 1e-13);
}

TEST(Simulation, TuningIsTheSameEachTime) {
  const ed::System system = ed_test::start({3, 0.3, 64, Inertia::paper, 26});
  ed::Simulation a(system);
  ed::Simulation b(system);
  a.tune_envelopes();
  b.tune_envelopes();
  EXPECT_EQ(a.envelope(), b.envelope());
  EXPECT_GT(a.envelope(), 0);
  EXPECT_EQ(ed_test::hash_of(a), ed_test::hash_of(b));
  // Eight thicknesses at most, each for one and a half stretches of 4096 collisions.
  EXPECT_LE(a.counters().collisions, 8U * 6144U);
}

TEST(Simulation, TuningAsksOftenWhetherToGoOn) {
  const ed::System system = ed_test::start({3, 0.3, 64, Inertia::paper, 26});
  ed::Simulation simulation(system);
  std::uint64_t asked_at = 0;
  std::uint64_t longest = 0;
  simulation.tune_envelopes([&] {
    longest = std::max(longest, simulation.counters().collisions - asked_at);
    asked_at = simulation.counters().collisions;
    return true;
  });
  EXPECT_GT(asked_at, 0U);
  EXPECT_LE(longest, 500U);
  ed::Simulation stopped(system);
  stopped.tune_envelopes([] { return false; });
  EXPECT_LE(stopped.counters().collisions, 500U);
}

TEST(FastestNeighbours, AreThoseThatWereMeasured) {
  struct Row {
    double X0, packing_fraction;
    double certified, bracketing;  ///< collisions/s with cells over those with dilated envelopes, medians of three
  };
  // bench_engine --benchmark_filter=dilute/ --benchmark_repetitions=3, N = 512.
  const Row rows[] = {
      {1.0 / 3, 0.02, 2.21, 1.25}, {1.0 / 3, 0.04, 2.15, 1.09}, {1.0 / 3, 0.06, 1.75, 0.96},
      {1.0 / 3, 0.08, 1.57, 0.85}, {1.0 / 3, 0.1, 1.41, 0.75},  {1.0 / 3, 0.15, 1.06, 0.58},
      {2, 0.02, 1.66, 1.16},       {2, 0.04, 1.54, 1.10},       {2, 0.06, 1.42, 0.98},
      {2, 0.08, 1.22, 0.91},       {2, 0.1, 1.16, 0.84},        {2, 0.15, 0.84, 0.69},
      {3, 0.02, 1.95, 1.22},       {3, 0.04, 1.66, 0.98},       {3, 0.06, 1.04, 0.76},
      {3, 0.08, 0.96, 0.63},       {3, 0.1, 0.71, 0.49},        {3, 0.15, 0.43, 0.34},
      {5, 0.02, 1.40, 0.76},       {5, 0.04, 0.84, 0.42},       {5, 0.06, 0.52, 0.28},
      {5, 0.08, 0.46, 0.23},       {5, 0.1, 0.27, 0.16},        {5, 0.15, 0.23, 0.13},
      {10, 0.02, 0.50, 0.17},      {10, 0.04, 0.28, 0.09},      {10, 0.06, 0.15, 0.05},
      {10, 0.08, 0.13, 0.04},
  };
  constexpr double kNoise = 0.05;
  const auto expect_faster = [](const Row& row, ed::Finder finder, double ratio) {
    if (std::abs(ratio - 1) < kNoise) return;
    const ed::Neighbours wanted = ratio > 1 ? ed::Neighbours::cells : ed::Neighbours::dilated;
    EXPECT_EQ(ed::fastest_neighbours(ed_test::spheroid(row.X0), 512, row.packing_fraction, finder), wanted)
        << row.X0 << ", " << row.packing_fraction << ", ratio " << ratio;
  };
  for (const Row& row : rows) {
    expect_faster(row, ed::Finder::certified, row.certified);
    expect_faster(row, ed::Finder::bracketing, row.bracketing);
  }
  // Spheres never leave a dilated envelope by turning; a dense fluid; less than three cells along an edge.
  EXPECT_EQ(ed::fastest_neighbours(ed_test::spheroid(1), 512, 0.01), ed::Neighbours::dilated);
  EXPECT_EQ(ed::fastest_neighbours(ed_test::spheroid(3), 512, 0.40), ed::Neighbours::dilated);
  EXPECT_EQ(ed::fastest_neighbours(ed_test::spheroid(10), 64, 0.02), ed::Neighbours::dilated);
}

TEST(Simulation, OfBodiesAtRestComesToItsEnd) {
  ed::Simulation simulation(ed_test::grid(sphere(), 3, 5));
  EXPECT_TRUE(simulation.run_until(10));
  EXPECT_EQ(simulation.counters().collisions, 0U);
  EXPECT_EQ(simulation.time(), 10);
}

TEST(Simulation, BodiesThatTouchFromTheStartAreNoOverlap) {
  ed::System system = two_bodies(sphere(), 20, {2, 0, 0});
  system.bodies[0].velocity = {1, 0, 0};
  ed::Simulation approaching(system);
  approaching.record_collisions(1);
  approaching.run_until(1);
  ASSERT_EQ(approaching.collisions().size(), 1U);
  EXPECT_NEAR(approaching.collisions()[0].time, 0, kRunRounding);
  EXPECT_EQ(approaching.counters().overlaps, 0U);
  system.bodies[0].velocity = {-1, 0, 0};
  ed::Simulation parting(system);
  parting.run_until(1);
  EXPECT_EQ(parting.counters().collisions, 0U);
  EXPECT_EQ(parting.counters().overlaps, 0U);
}

/// The system, repeated along each edge; copies of a body stand one after the other.
ed::System repeated(const ed::System& system, int along) {
  ed::System large = system;
  large.box = along * system.box;
  large.bodies.clear();
  for (const ed::Body& body : system.bodies) {
    for (int copy = 0; copy < along * along * along; ++copy) {
      const Eigen::Vector3i place(copy % along, copy / along % along, copy / (along * along));
      large.bodies.push_back(body);
      large.bodies.back().position += system.box * place.cast<double>();
    }
  }
  return large;
}

/// Memory is laid out, and asked for ahead, with tens of thousands of bodies; what they do is what they do in a small
/// box, each copy, until rounding has grown.
TEST(Simulation, ManyBodiesDoAsTheirCopiesInASmallBox) {
  const ed::System system = ed_test::start({2, 0.3, 512, Inertia::uniform});
  constexpr int kAlong = 4;
  ed::Simulation small(system);
  ed::Simulation large(repeated(system, kAlong));
  ASSERT_GE(large.system().size(), ed::SimulationOptions().prepare_from);
  small.run_collisions(512);
  large.run_until(small.time());
  EXPECT_NEAR(static_cast<double>(large.counters().collisions), 512.0 * kAlong * kAlong * kAlong, 64);
  const ed::System end = small.system();
  const ed::System ends = large.system();
  const std::string state = large.save();
  ed::Simulation restored = ed::Simulation::restore(state, system.species);
  EXPECT_TRUE(restored.save() == state);
  large.run_collisions(2000);
  restored.run_collisions(2000);
  EXPECT_TRUE(restored.save() == large.save());
  for (int i = 0; i < ends.size(); ++i) {
    const ed::Body& copy = ends.bodies[static_cast<std::size_t>(i)];
    const ed::Body& body = end.bodies[static_cast<std::size_t>(i / (kAlong * kAlong * kAlong))];
    const Vector3d r = (copy.position - body.position) / system.box;
    ASSERT_NEAR((r - r.array().round().matrix()).norm(), 0, 1e-9) << "body " << i;
    ASSERT_NEAR((copy.rotation - body.rotation).norm(), 0, 1e-8) << "body " << i;
  }
}

}  // namespace
