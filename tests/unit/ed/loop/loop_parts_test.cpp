// The parts of the event loop, each by itself.

#include <common/ed/states.h>

#include "base/periodic.h"
#include "bodies/uniaxial.h"
#include "loop/added_events.h"
#include "loop/event_kinds.h"
#include "loop/factory.h"
#include "loop/parts/collision_log.h"
#include "loop/parts/epoch_clock.h"
#include "loop/parts/failure_log.h"
#include "loop/parts/neighbourhood.h"
#include "loop/parts/periodic_box.h"
#include "loop/parts/predictor.h"
#include "loop/parts/schedule.h"
#include "loop/parts/stall_watch.h"
#include "neighbours/lists.h"

#include <geom/ellipsoid.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace {

using ed::internal::AddedEvents;
using ed::internal::BodyEvents;
using ed::internal::NeighbourLists;
using ed::internal::PairEvent;
using Eigen::Vector3d;

TEST(EpochClock, TimesGoOnOverTheEndsOfEpochs) {
  ed::internal::EpochClock clock;
  clock.set_epoch(0.25);
  clock.advance(0.125);
  clock.advance(0.0625);  // is over
  EXPECT_EQ(clock.now(), 0.125);
  for (int epoch = 0; epoch < 3; ++epoch) {
    clock.go_to_end_of_epoch();
    const double time = clock.time();
    clock.start_epoch();
    EXPECT_EQ(clock.now(), 0);
    EXPECT_EQ(clock.time(), time);
  }
  EXPECT_EQ(clock.time(), 0.75);
  EXPECT_EQ(clock.time_at(0.125), 0.875);
  EXPECT_EQ(clock.local(0.875), 0.125);
  EXPECT_TRUE(clock.is_sound());
  clock.set_epoch(0);
  EXPECT_FALSE(clock.is_sound());
}

/// Centres that stay where they are.
struct Centres {
  std::vector<Vector3d> positions;
  std::vector<BodyEvents> of_body;

  explicit Centres(int number)
      : positions(static_cast<std::size_t>(number), Vector3d::Zero()), of_body(positions.size()) {}
  int number() const { return static_cast<int>(positions.size()); }
  Vector3d position_at(int i, double /*t*/) const { return positions.at(static_cast<std::size_t>(i)); }
  void shift(int i, const Vector3d& by) { positions.at(static_cast<std::size_t>(i)) += by; }
  BodyEvents& events(int i) { return of_body.at(static_cast<std::size_t>(i)); }
  const BodyEvents& events(int i) const { return of_body.at(static_cast<std::size_t>(i)); }
};

TEST(PeriodicBox, WrappedBodiesAreUnwrapped) {
  Centres bodies(2);
  ed::internal::PeriodicBox box(4, 2);
  bodies.positions[1] = {1, -3, 9};
  box.wrap(bodies, 1, 0);
  EXPECT_EQ(bodies.positions[1], Vector3d(1, 1, 1));
  EXPECT_EQ(box.unwrapped(1, bodies.positions[1]), Vector3d(1, -3, 9));
  bodies.positions[1] += Vector3d(0, 3, 0);
  box.wrap(bodies, 1, 0);
  EXPECT_EQ(box.unwrapped(1, bodies.positions[1]), Vector3d(1, 0, 9));
  EXPECT_EQ(box.unwrapped(0, bodies.positions[0]), Vector3d::Zero());
}

TEST(FailureLog, HasRoomForSomeOfEachReason) {
  const std::vector<ed::Species> species = {ed::uniform_species(geom::Ellipsoid({1, 1, 2})),
                                            ed::uniform_species(geom::Ellipsoid({1, 2, 3}))};
  const std::vector<int> species_of = {0, 1};
  ed::internal::FailureLog log(species, species_of);
  for (int k = 0; k < 20; ++k) {
    const ed::FailedPair* const failed = log.add(ed::FailureReason::overlap, 1, 0);
    EXPECT_EQ(failed != nullptr, k < 16) << k;
  }
  EXPECT_NE(log.add(ed::FailureReason::declined, 0, 1), nullptr);
  ASSERT_EQ(log.pairs().size(), 17U);
  const ed::FailedPair& first = log.pairs()[0];
  EXPECT_EQ(first.i, 1);
  EXPECT_EQ(std::get<geom::Ellipsoid>(first.shape_i).semi_axes(), Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<geom::Ellipsoid>(first.shape_j).semi_axes(), Vector3d(1, 1, 2));
}

TEST(CollisionLog, CountsAndRecords) {
  ed::internal::CollisionLog log(3);
  log.start_record(1);
  for (int k = 0; k < 2; ++k) {
    log.add(2, 1, {0, 0, 2}, 3, Vector3d::UnitZ());
    if (log.wants_more()) log.record(0.5, 2, 1);
  }
  EXPECT_EQ(log.virial(), 12);
  EXPECT_EQ(log.virial_tensor().trace(), 12);
  EXPECT_EQ(log.of_bodies(0, 1), 0U);
  EXPECT_EQ(log.of_bodies(0, 3), 4U);
  ASSERT_EQ(log.recorded().size(), 1U);
  EXPECT_EQ(log.recorded()[0].i, 1);
  EXPECT_EQ(log.recorded()[0].j, 2);
}

TEST(StallWatch, NamesTheMostFrequentEvent) {
  ed::internal::StallWatch watch(2);
  watch.restart(1);
  for (int k = 1; k < 4000; ++k) EXPECT_FALSE(watch.count());
  EXPECT_TRUE(watch.count());
  EXPECT_EQ(watch.span(1.5), 0.5);
  ed::internal::EventTally tally;
  for (int k = 0; k < 4; ++k) {
    tally.add(ed::EventKind::contact, {0, 1});
    if (k > 0) tally.add(ed::EventKind::look, {1, 0});
    if (k == 0) tally.add(ed::EventKind::exit, {1, -1});
  }
  EXPECT_FALSE(watch.stall());
  watch.declare_stalled(tally, 1.5);
  ASSERT_TRUE(watch.stall());
  EXPECT_EQ(watch.stall()->kind, ed::EventKind::contact);
  EXPECT_EQ(watch.stall()->j, 1);
  EXPECT_EQ(watch.stall()->share, 0.5);
  EXPECT_EQ(watch.stall()->events, 4000U);
  EXPECT_EQ(watch.stall()->span, 0.5);
}

/// An event at a time that each body has.
struct Alarm {
  double time;
  double predict(const Centres& /*bodies*/, int body, const ed::internal::EpochClock& /*clock*/,
                 const ed::internal::PeriodicBox& /*box*/) const {
    return time + body;
  }
};

/// The kind of the first event of a body, and its bodies.
template <class Added>
std::string first_event(const Centres& bodies, const NeighbourLists& lists, int body) {
  std::string text;
  ed::internal::dispatch<Added>(bodies, lists, body, [&](const auto& event) {
    text += std::string(ed::to_string(event.kKind));
    for (const std::int32_t k : event.bodies(lists)) text += " " + std::to_string(k);
  });
  return text;
}

TEST(Schedule, PairsCountForTheirOwners) {
  using Added = AddedEvents<>;
  Centres bodies(3);
  for (int i = 0; i < 3; ++i) bodies.events(i).exit = 10 + i;
  NeighbourLists lists(3);
  const Added added;
  ed::internal::Schedule<Centres, Added> schedule(bodies, lists, added);
  const std::int32_t look = lists.add(0, 1, Vector3d::UnitX());
  const std::int32_t contact = lists.add(1, 2, Vector3d::UnitX());
  lists.pair(look).time = 3;
  lists.pair(look).event = PairEvent::bound;
  lists.pair(contact).time = 4;
  lists.pair(contact).event = PairEvent::contact;
  schedule.reschedule_all();
  EXPECT_EQ(schedule.earliest_time(), 3);
  EXPECT_EQ(schedule.earliest(), 0);
  EXPECT_EQ(first_event<Added>(bodies, lists, 0), "look 0 1");
  EXPECT_EQ(first_event<Added>(bodies, lists, 1), "contact 1 2");
  EXPECT_EQ(first_event<Added>(bodies, lists, 2), "exit 2 -1");
  EXPECT_TRUE(schedule.is_sound());

  // Another owner: body 0 has to be rescheduled.
  EXPECT_EQ(&schedule.claim(look, 1), &lists.pair(look));
  EXPECT_FALSE(schedule.is_sound());
  EXPECT_EQ(schedule.orphans(), std::vector<int>{0});
  schedule.reschedule_orphans();
  schedule.reschedule(1);
  EXPECT_TRUE(schedule.orphans().empty());
  EXPECT_EQ(schedule.earliest(), 1);
  EXPECT_EQ(first_event<Added>(bodies, lists, 0), "exit 0 -1");
  EXPECT_TRUE(schedule.is_sound());
  bodies.events(2).first = -2;
  EXPECT_FALSE(schedule.is_sound());
}

TEST(Schedule, AddedEventsTakePart) {
  using Added = AddedEvents<Alarm, Alarm>;
  Centres bodies(2);
  for (int i = 0; i < 2; ++i) bodies.events(i).exit = 10;
  NeighbourLists lists(2);
  Added added(Alarm{9.5}, Alarm{5});
  added.resize(2);
  ed::internal::Schedule<Centres, Added> schedule(bodies, lists, added);
  schedule.reschedule_all();
  EXPECT_EQ(schedule.earliest_time(), 10);
  const ed::internal::EpochClock clock;
  const ed::internal::PeriodicBox box(1, 2);
  added.predict<0>(bodies, 0, clock, box);
  added.predict(bodies, 1, clock, box);
  schedule.reschedule_all();
  EXPECT_EQ(bodies.events(0).first, Added::first_of(0));
  EXPECT_EQ(bodies.events(1).first, Added::first_of(1));
  EXPECT_EQ(schedule.earliest_time(), 6);
  EXPECT_EQ(first_event<Added>(bodies, lists, 1), "added 1 -1");
  EXPECT_TRUE(schedule.is_sound());
  added.start_epoch(6);
  schedule.reschedule_all();
  EXPECT_EQ(schedule.earliest_time(), 0);
}

using ed::internal::UniaxialBodies;

/// Bodies with their neighbourhood.
struct Surrounded {
  explicit Surrounded(const ed::System& system)
      : bodies(system), box(system.box, system.size()), neighbourhood(bodies, box, counters, {}) {
    neighbourhood.set_envelopes(ed::internal::make_envelopes(bodies, {}, 0.3, 1, system.box));
    neighbourhood.make_all(0);
  }

  /// Neighbours of body i by its list.
  std::set<int> listed(int i) const {
    const NeighbourLists& lists = neighbourhood.lists();
    std::set<int> partners;
    for (const std::int32_t index : lists.of(i)) partners.insert(lists.pair(index).partner(i));
    return partners;
  }

  ed::Counters counters;
  UniaxialBodies bodies;
  ed::internal::PeriodicBox box;
  ed::internal::Neighbourhood<UniaxialBodies> neighbourhood;
};

TEST(Neighbourhood, ListsHaveAllPairsOfOverlappingEnvelopes) {
  const ed::System system = ed_test::start({3, 0.2, 60, ed_test::Inertia::paper, 4});
  Surrounded all(system);
  const auto expected = [&](int i) {
    std::set<int> partners;
    for (int k = 0; k < system.size(); ++k) {
      const Vector3d r =
          ed::internal::nearest_image(all.bodies.position_at(k, 0) - all.bodies.position_at(i, 0), system.box);
      Vector3d normal;
      if (k != i && all.neighbourhood.envelopes().may_overlap(i, k, r, normal)) partners.insert(k);
    }
    return partners;
  };
  std::size_t pairs = 0;
  for (int i = 0; i < system.size(); ++i) {
    EXPECT_EQ(all.listed(i), expected(i)) << i;
    pairs += all.listed(i).size();
  }
  EXPECT_GT(pairs, 100U);
  EXPECT_EQ(all.counters.envelope_checks, 60U);

  std::set<int> removed;
  all.neighbourhood.drop_list(5, [&removed](std::int32_t /*index*/, std::int32_t partner) { removed.insert(partner); });
  EXPECT_EQ(removed, expected(5));
  EXPECT_TRUE(all.listed(5).empty());
  all.neighbourhood.find_list(5, 0);
  EXPECT_EQ(all.listed(5), expected(5));
}

TEST(Predictor, FindsTheContactOfTwoSpheres) {
  ed::System system;
  system.species = {ed_test::species(1, ed_test::Inertia::paper)};
  system.box = 20;
  system.bodies.resize(2);
  system.bodies[0].position = {-9, 0, 0};
  system.bodies[1].position = {8.5, 0, 0};  // 2.5 away, across the face of the box
  system.bodies[1].velocity = {2, 0, 0};
  Surrounded two(system);
  for (int i = 0; i < 2; ++i) two.bodies.events(i).exit = 1;
  const std::vector<int> species_of = {0, 0};
  ed::internal::FailureLog failures(system.species, species_of);
  const ed::internal::EpochClock clock;
  const ed::ContactOptions options;
  ed::internal::Predictor<UniaxialBodies> predictor(
      {two.bodies, two.neighbourhood, two.box, clock, two.counters, failures}, options, nullptr);
  ASSERT_EQ(two.neighbourhood.lists().of(0).size(), 1U);
  auto& pair = two.neighbourhood.lists().pair(two.neighbourhood.lists().of(0)[0]);
  predictor.queue(pair);
  predictor.predict_queued();
  for (int look = 0; look < 10 && pair.event == PairEvent::bound; ++look) {
    EXPECT_LE(pair.time, 0.25);
    predictor.search(pair, predictor.kSecondLook + look);
  }
  EXPECT_EQ(pair.event, PairEvent::contact);
  EXPECT_NEAR(pair.time, 0.25, 1e-12);

  two.bodies.events(0).exit = 0.2;  // the search ends there
  predictor.search(pair, 10);
  EXPECT_EQ(pair.event, PairEvent::clear);
  EXPECT_EQ(predictor.count().rescues, 0U);
  EXPECT_TRUE(failures.pairs().empty());
}

}  // namespace
