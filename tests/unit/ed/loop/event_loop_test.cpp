// The event loop where its public face does not lead: states with overlaps, which Simulation refuses at the start.

#include <common/ed/states.h>

#include "bodies/uniaxial.h"
#include "loop/event_loop.h"

#include <geom/newton.h>

#include <gtest/gtest.h>

#include <cstdint>

namespace {

using ed::DistanceMethod;
using ed::FailureReason;
using ed::Finder;
using EventLoop = ed::internal::EventLoop<ed::internal::UniaxialBodies>;
using ed_test::Inertia;
using Eigen::Vector3d;

constexpr std::uint64_t kAnyNumber = ~std::uint64_t{0};  ///< limit that no number of events reaches

ed::SimulationOptions bracketing(DistanceMethod distance) {
  ed::SimulationOptions options;
  options.contact.finder = Finder::bracketing;
  options.contact.distance = distance;
  return options;
}

/// Returns the centres of both bodies, from which Newton's method declines.
geom::WitnessPair centres(const geom::Shape& /*a*/, const geom::Pose& X_WA, const geom::Shape& /*b*/,
                          const geom::Pose& X_WB) {
  return {X_WA.position(), X_WB.position(), geom::SeedStatus::usable};
}

/// The last two bodies overlap by `depth`, relative to the smaller semi-axis.
ed::System overlapping(double depth) {
  ed::System system = ed_test::start({3, 0.05, 80, Inertia::paper, 61});
  ed::Body& a = system.bodies[78];
  ed::Body& b = system.bodies[79];
  b = a;
  b.velocity = -a.velocity;
  b.position += (2 - depth) * ed_test::ellipsoid_of(system).semi_axes().x() * a.rotation.col(0);
  return system;
}

TEST(EventLoop, ContactsWithoutAnImpulseDoNotHoldUpTheTime) {
  // Rods deep in each other, turning: where no distance is answered the line of centres stands in for the normal, and
  // the points that would touch may part though the centres approach.
  ed::Random random(62);
  for (int round = 0; round < 10; ++round) {
    ed::System system;
    system.species = {ed_test::species(3, Inertia::paper)};
    system.box = 20;
    system.bodies.resize(2);
    for (ed::Body& body : system.bodies) {
      body.rotation = random.rotation();
      const Vector3d w = 5 * random.normal3();
      body.angular_velocity = w - w.dot(body.rotation.col(2)) * body.rotation.col(2);
      body.velocity = 0.1 * random.normal3();
    }
    system.bodies[1].position = 0.05 * random.direction();
    EventLoop loop(system, bracketing(DistanceMethod::dual));
    ASSERT_TRUE(loop.run_until(0.02, 1000, kAnyNumber)) << round;
    EXPECT_LT(loop.counters().parting_contacts, 1000U);
  }
}

TEST(EventLoop, BodiesInOnePlaceAreNoReasonToStop) {
  ed::System system;
  system.species = {ed_test::species(3, Inertia::paper)};
  system.box = 20;
  system.bodies.resize(2);
  system.bodies[1].velocity = {1, 0, 0};
  for (const DistanceMethod method : {DistanceMethod::dual, DistanceMethod::newton8, DistanceMethod::newton5}) {
    EventLoop loop(system, bracketing(method));
    EXPECT_TRUE(loop.run_until(1, 1000, kAnyNumber));
    EXPECT_GT(loop.counters().overlaps, 0U);
  }
}

TEST(EventLoop, RescuesDoNotCrowdOutOverlaps) {
  ed::SimulationOptions options = bracketing(DistanceMethod::newton5);
  options.contact.seed = centres;
  EventLoop loop(overlapping(0.1), options);
  loop.run_until(1, 100, kAnyNumber);
  int overlaps = 0;
  int distances = 0;
  for (const ed::FailedPair& failed : loop.failures()) {
    ++(failed.reason == FailureReason::overlap ? overlaps : distances);
    EXPECT_EQ(failed.distance.has_value(), failed.reason == FailureReason::distance);
    EXPECT_EQ(failed.finder, Finder::bracketing);
    EXPECT_EQ(failed.eps_d, options.contact.eps_d);
  }
  EXPECT_EQ(distances, 16);
  EXPECT_GT(overlaps, 0);
  EXPECT_GT(loop.counters().unrecorded_failures, 0U);
  const EventLoop sound(ed_test::start({3, 0.05, 80, Inertia::paper, 61}), {});
  EXPECT_EQ(sound.counters().unrecorded_failures, 0U);
}

TEST(EventLoop, CallsThatFailedCanBeRepeated) {
  for (const DistanceMethod method : {DistanceMethod::newton8, DistanceMethod::newton5}) {
    ed::SimulationOptions options = bracketing(method);
    options.contact.seed = centres;
    const EventLoop loop(ed_test::start({3, 0.05, 80, Inertia::paper, 61}), options);
    ASSERT_EQ(loop.failures().size(), 16U);
    for (const ed::FailedPair& failed : loop.failures()) {
      const ed::FailedDistance& call = *failed.distance;
      EXPECT_EQ(call.method, method);
      const geom::DistanceResult again = geom::kernel::newton_distance_unchecked(
          std::get<geom::Ellipsoid>(call.shape_a), call.X_WA, std::get<geom::Ellipsoid>(call.shape_b), call.X_WB,
          method == DistanceMethod::newton8 ? geom::NewtonSystem::eight : geom::NewtonSystem::five, call.seed);
      EXPECT_EQ(again.status, call.status);
      // The same pair as that of the motions.
      const Vector3d r = failed.motion_j.pose.position() - failed.motion_i.pose.position();
      EXPECT_LE((call.X_WB.position() - r).norm(), 1e-12);
    }
  }
}

}  // namespace
