// Single-body events and collision laws that the library does not have: each kind is one class, here as in a program.

#include <common/ed/families.h>
#include <common/ed/states.h>

#include "loop/event_loop_impl.h"
#include "loop/stall_impl.h"
#include "loop/state_impl.h"

#include <ed/impulse.h>
#include <ed/simulation.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace {

using ed::internal::BodyChange;
using ed::internal::EpochClock;
using ed::internal::GeneralBodies;
using ed::internal::kNever;
using ed::internal::PeriodicBox;
using ed::internal::UniaxialBodies;
using ed_test::Inertia;
using Eigen::Vector3d;

constexpr std::uint64_t kUnlimited = ~std::uint64_t{0};

/// The slab between two planes x = k box, (k + 1) box, in which a body's centre is.
class Slabs {
 public:
  /// Time when the body, unwrapped, comes to the next plane.
  template <class Bodies>
  double crossing(const Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box) {
    const double x = box.unwrapped(body, bodies.position_at(body, clock.now())).x();
    const double v = bodies.velocity(body).x();
    if (slab_.size() <= static_cast<std::size_t>(body)) slab_.resize(static_cast<std::size_t>(body) + 1, kUnknown);
    int& slab = of(body);
    if (slab == kUnknown) slab = static_cast<int>(std::floor(x / box.edge()));
    if (v == 0) return kNever;
    return clock.now() + std::max(0.0, ((v > 0 ? slab + 1 : slab) * box.edge() - x) / v);
  }
  int& of(int body) { return slab_.at(static_cast<std::size_t>(body)); }
  int of(int body) const { return slab_.at(static_cast<std::size_t>(body)); }

 private:
  static constexpr int kUnknown = -1000000;
  std::vector<int> slab_;
};

/// Events at these planes.
struct AtPlanes {
  bool wanted = false;
  Slabs slabs;

  template <class Bodies>
  double predict(const Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box) {
    return wanted ? slabs.crossing(bodies, body, clock, box) : kNever;
  }
};

/// Counts how often bodies cross these planes.
struct PlaneCrossing : AtPlanes {
  std::uint64_t crossings = 0;

  template <class Bodies>
  BodyChange process(const Bodies& bodies, int body, const EpochClock& /*clock*/, const PeriodicBox& /*box*/) {
    slabs.of(body) += bodies.velocity(body).x() > 0 ? 1 : -1;
    ++crossings;
    return BodyChange::none;
  }
};

/// Reflects bodies there.
struct Mirror : AtPlanes {
  std::uint64_t reflections = 0;

  template <class Bodies>
  BodyChange process(Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& /*box*/) {
    const Vector3d v = bodies.velocity(body);
    bodies.set_velocity(body, {-v.x(), v.y(), v.z()}, clock.now());
    ++reflections;
    return BodyChange::motion;
  }
};

/// Events of this kind, which are wanted.
template <class Kind>
Kind wanted() {
  Kind kind;
  kind.wanted = true;
  return kind;
}

/// Comes to one body again and again at the same time.
struct Stuck {
  int stuck = -1;

  template <class Bodies>
  double predict(const Bodies& /*bodies*/, int body, const EpochClock& clock, const PeriodicBox& /*box*/) const {
    return body == stuck ? clock.now() : kNever;
  }
  template <class Bodies>
  BodyChange process(Bodies& /*bodies*/, int /*body*/, const EpochClock& /*clock*/, const PeriodicBox& /*box*/) {
    return BodyChange::none;
  }
};

/// Keeps the share `restitution` of the normal velocity, and counts.
struct Inelastic {
  double restitution = 1;
  std::uint64_t contacts = 0;
  double sum_of_impulses = 0;
  double lost_energy = 0;

  double operator()(ed::ContactBody& a, ed::ContactBody& b, const Vector3d& normal) {
    const ed::ContactBody a_before = a;
    const ed::ContactBody b_before = b;
    const double elastic = ed::collide(a, b, normal);
    if (!(elastic > 0)) return 0;
    const double approach = ed::normal_velocity(a_before, b_before, normal);
    lost_energy -= 0.25 * (1 - restitution * restitution) * elastic * approach;
    ++contacts;
    const double share = 0.5 * (1 + restitution);
    sum_of_impulses += share * elastic;
    if (restitution == 1) return elastic;
    const auto mix = [share](const Vector3d& before, Vector3d& after) { after = before + share * (after - before); };
    mix(a_before.velocity, a.velocity);
    mix(b_before.velocity, b.velocity);
    mix(a_before.angular_velocity, a.angular_velocity);
    mix(b_before.angular_velocity, b.angular_velocity);
    EXPECT_NEAR(ed::normal_velocity(a, b, normal), -restitution * approach, 1e-12 * (1 - approach));
    return share * elastic;
  }
};

/// One loop for all tests, which say what they want of it: each kind of loop takes its time to compile.
using TestEvents = ed::internal::AddedEvents<Mirror, PlaneCrossing, Stuck>;
template <class Bodies>
using TestLoop = ed::internal::EventLoop<Bodies, Inelastic, TestEvents>;

ed::System fluid() {
  return ed_test::start({3, 0.3, 100, Inertia::paper, 5});
}
ed::System superballs() {
  return ed_test::start(ed_test::pure("", ed_test::superball(4), 60), 0.3);
}

template <class Loop>
std::string state_of(const Loop& loop) {
  std::string bytes;
  ed::internal::Writer writer([&bytes](std::string_view piece) { bytes += piece; });
  loop.save(writer);
  writer.flush();
  return bytes;
}

template <class Bodies>
void expect_crossings_counted(const ed::System& system) {
  TestLoop<Bodies> loop(system, {}, {}, TestEvents({}, wanted<PlaneCrossing>(), {}));
  ed::Simulation plain(system);
  for (double time = 1; time <= 5; ++time) {  // several epochs
    ASSERT_TRUE(loop.run_until(time, kUnlimited, kUnlimited));
    ASSERT_TRUE(plain.run_until(time));
  }
  const auto& crossing = std::get<PlaneCrossing>(loop.added().kinds());
  ed::Snapshot snapshot;
  loop.sample(snapshot);
  std::uint64_t least = 0;
  for (int i = 0; i < loop.number(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto slab_of = [&](const Vector3d& r) { return static_cast<int>(std::floor(r.x() / loop.box())); };
    EXPECT_EQ(crossing.slabs.of(i), slab_of(snapshot.position[at])) << i;
    least += static_cast<std::uint64_t>(std::abs(crossing.slabs.of(i) - slab_of(system.bodies[at].position)));
  }
  EXPECT_GT(crossing.crossings, 10U);
  EXPECT_GE(crossing.crossings, least);
  // Events that change nothing, and the law that is the default: the same run, bit for bit.
  EXPECT_EQ(loop.counters().collisions, plain.counters().collisions);
  EXPECT_EQ(loop.law().contacts, plain.counters().collisions);
  EXPECT_EQ(loop.virial(), plain.virial());
  ed::Snapshot other;
  plain.sample(other);
  EXPECT_EQ(snapshot.position, other.position);
  EXPECT_EQ(snapshot.velocity, other.velocity);
}

TEST(AddedEvents, PlaneCrossingsAreCounted) {
  expect_crossings_counted<UniaxialBodies>(fluid());
  expect_crossings_counted<GeneralBodies>(superballs());
}

template <class Bodies>
void expect_reflected(const ed::System& system) {
  ed::SimulationOptions options;
  options.prepare_from = 1;
  TestLoop<Bodies> loop(system, options, {}, TestEvents(wanted<Mirror>(), wanted<PlaneCrossing>(), {}));
  const double energy = ed::kinetic_state(system).energy();
  ASSERT_TRUE(loop.run_until(2, kUnlimited, kUnlimited));
  const std::string state = state_of(loop);
  ed::internal::Reader reader(state);
  TestLoop<Bodies> restored(system, options, reader, loop.law(), loop.added());
  EXPECT_TRUE(state_of(restored) == state);
  for (TestLoop<Bodies>* run : {&loop, &restored}) ASSERT_TRUE(run->run_until(4, kUnlimited, kUnlimited));
  EXPECT_TRUE(state_of(restored) == state_of(loop));

  const auto& mirror = std::get<Mirror>(loop.added().kinds());
  EXPECT_GT(mirror.reflections, 10U);
  // At each plane the mirror is first.
  EXPECT_EQ(std::get<PlaneCrossing>(loop.added().kinds()).crossings, 0U);
  ed::Snapshot snapshot;
  loop.sample(snapshot);
  for (int i = 0; i < loop.number(); ++i) {
    const double x = snapshot.position[static_cast<std::size_t>(i)].x() / loop.box();
    EXPECT_GT(x, mirror.slabs.of(i) - 1e-9) << i;
    EXPECT_LT(x, mirror.slabs.of(i) + 1 + 1e-9) << i;
  }
  const ed::Audit audit = ed::audit(loop.system());
  EXPECT_EQ(audit.overlaps + audit.unanswered, 0);
  EXPECT_EQ(loop.counters().overlaps, 0U);
  EXPECT_NEAR(audit.kinetic.energy(), energy, 1e-10 * energy);
}

TEST(AddedEvents, MirrorsKeepBodiesInTheirSlabs) {
  expect_reflected<UniaxialBodies>(fluid());
  expect_reflected<GeneralBodies>(superballs());
}

TEST(AddedEvents, StallsNameThem) {
  TestLoop<UniaxialBodies> loop(fluid(), {}, {}, TestEvents({}, {}, {7}));
  EXPECT_FALSE(loop.run_until(1, kUnlimited, kUnlimited));
  ASSERT_TRUE(loop.stall());
  EXPECT_EQ(loop.stall()->kind, ed::EventKind::added);
  EXPECT_EQ(loop.stall()->i, 7);
  EXPECT_EQ(loop.stall()->share, 1);
}

template <class Bodies>
void expect_inelastic(const ed::System& system) {
  TestLoop<Bodies> loop(system, {}, Inelastic{0.9, 0, 0, 0});
  ASSERT_TRUE(loop.run_until(0.5, kUnlimited, kUnlimited));
  EXPECT_GT(loop.law().contacts, 50U);
  EXPECT_EQ(loop.law().contacts, loop.counters().collisions);
  EXPECT_EQ(loop.counters().overlaps + loop.counters().parting_contacts, 0U);
  const ed::KineticState before = ed::kinetic_state(system);
  const ed::KineticState after = ed::kinetic_state(loop.system());
  EXPECT_GT(loop.law().lost_energy, 0.05 * before.energy());
  EXPECT_NEAR(before.energy() - after.energy(), loop.law().lost_energy, 1e-10 * before.energy());
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-10);
}

TEST(CollisionLaw, IsThatOfTheLoop) {
  expect_inelastic<UniaxialBodies>(fluid());
  expect_inelastic<GeneralBodies>(superballs());
}

TEST(CollisionLaw, ImpulsesOfSpheresAddUpToTheVirial) {
  const ed::System system = ed_test::start({1, 0.3, 100, Inertia::paper, 5});
  TestLoop<UniaxialBodies> loop(system, {}, Inelastic{0.8, 0, 0, 0});
  ASSERT_TRUE(loop.run_until(0.5, kUnlimited, kUnlimited));
  EXPECT_GT(loop.law().contacts, 50U);
  EXPECT_NEAR(loop.virial(), 2 * loop.law().sum_of_impulses, 1e-9 * loop.virial());
}

}  // namespace
