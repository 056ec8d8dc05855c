#pragma once

#include "base/poll.h"
#include "bodies/first_looks.h"
#include "loop/collision_law.h"
#include "loop/event_kinds.h"
#include "loop/factory.h"
#include "loop/parts/collision_log.h"
#include "loop/parts/epoch_clock.h"
#include "loop/parts/failure_log.h"
#include "loop/parts/neighbourhood.h"
#include "loop/parts/periodic_box.h"
#include "loop/parts/predictor.h"
#include "loop/parts/schedule.h"
#include "loop/prefetch_events.h"

#include <ed/simulation.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace ed::internal {

/// The parts of an event loop, and what several kinds of events do with them.
template <class Bodies, CollisionLaw Law, class Added>
struct LoopParts {
  LoopParts(const System& system, const SimulationOptions& with, Law collision_law, Added added_events);
  LoopParts(const LoopParts&) = delete;
  LoopParts& operator=(const LoopParts&) = delete;

  double now() const { return clock.now(); }
  int number() const { return bodies.number(); }

  /// Predicts what depends on the motion of a body alone.
  void predict_body(int body);
  /// Has pairs predicted; `owner` owns them from now on. `skip`: a pair that is left out; kNoPair: none.
  void queue(std::int32_t index, int owner) { predictor.queue(schedule.claim(index, owner)); }
  void queue_all_of(int body, std::int32_t skip);
  /// Predicts the queued pairs, and reschedules the orphans (Schedule).
  void predict_queued();
  /// Gives a body a new envelope and a new list.
  void rebuild(int body);

  /// Makes lists and predictions of all bodies. `poll`: see SimulationOptions.
  void rebuild_all(const std::function<void()>& poll);
  /// Predicts every pair, for its body i, and reschedules all bodies.
  void predict_all(const std::function<void()>& poll = {});
  /// Makes room, so that nothing allocates while events are processed unless a list becomes longer than any before.
  void reserve();
  void start_epoch();
  /// Uses the kernels of an instruction set from now on; there must be first looks.
  void use(geom::InstructionSet set);

  // Prefetching, in large systems only (see `ahead`).
  EventSources<Bodies> sources() const {
    return {schedule.calendar(), bodies, neighbourhood.lists(), neighbourhood.envelopes(), neighbourhood.cells()};
  }
  void fetch_pairs(int body) const {
    if (ahead) sources().fetch_pairs(body);
  }
  /// Prefetches the partners of a body. It reads the pairs, so that some work should follow fetch_pairs first.
  void fetch_partners(int body) const {
    if (ahead) sources().fetch_partners(body);
  }

  static constexpr std::int32_t kNoPair = -1;

  SimulationOptions options;
  std::vector<Species> species;
  std::vector<int> species_of;  ///< number of each body's
  Counters counters;
  EpochClock clock;
  PeriodicBox box;
  Bodies bodies;
  Law law;
  Added added;
  Neighbourhood<Bodies> neighbourhood;
  Schedule<Bodies, Added> schedule;
  FailureLog failures;
  Predictor<Bodies> predictor;
  CollisionLog collisions;
  /// Prefetching; only in large systems, whose events read memory that is in no cache.
  std::optional<EventsAhead<Bodies, Added>> ahead;

 private:
  static std::vector<int> species_numbers(const System& system) {
    std::vector<int> numbers;
    for (const Body& body : system.bodies) numbers.push_back(body.species);
    return numbers;
  }
};

template <class Bodies, CollisionLaw Law, class Added>
LoopParts<Bodies, Law, Added>::LoopParts(const System& system, const SimulationOptions& with, Law collision_law,
                                         Added added_events)
    : options(with),
      species(system.species),
      species_of(species_numbers(system)),
      box(system.box, system.size()),
      bodies(system),
      law(std::move(collision_law)),
      added(std::move(added_events)),
      neighbourhood(bodies, box, counters, options.batches),
      schedule(bodies, neighbourhood.lists(), added),
      failures(species, species_of),
      predictor({bodies, neighbourhood, box, clock, counters, failures}, options.contact,
                make_first_looks(bodies, options)),
      collisions(system.size()) {
  options.poll = nullptr;  // of the construction alone
  added.resize(number());
  if (number() >= std::max(options.prepare_from, EventsAhead<Bodies, Added>::kFewest)) {
    ahead.emplace(schedule.calendar());
  }
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::predict_body(int body) {
  ExitEvent::predict(*this, body);
  added.predict(bodies, body, clock, box);
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::queue_all_of(int body, std::int32_t skip) {
  for (const std::int32_t index : neighbourhood.lists().of(body)) {
    if (index != skip) queue(index, body);
  }
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::predict_queued() {
  predictor.predict_queued();
  for (const int body : schedule.orphans()) fetch_pairs(body);
  schedule.reschedule_orphans();
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::rebuild(int i) {
  ++counters.neighbour_rebuilds;
  fetch_pairs(i);
  neighbourhood.place(i, now());
  if (ahead) sources().fetch_lists_of_partners(i);
  neighbourhood.drop_list(i, [this](std::int32_t index, std::int32_t partner) { schedule.release(index, partner); });
  ExitEvent::predict(*this, i);
  neighbourhood.find_list(i, now());
  fetch_partners(i);
  queue_all_of(i, kNoPair);
  predict_queued();
  schedule.reschedule(i);
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::rebuild_all(const std::function<void()>& poll) {
  neighbourhood.make_all(now(), poll);
  for (int i = 0; i < number(); ++i) added.predict(bodies, i, clock, box);
  predict_all(poll);
  reserve();
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::predict_all(const std::function<void()>& poll) {
  const NeighbourLists& lists = neighbourhood.lists();
  for (int i = 0; i < number(); ++i) {
    poll_at(i, poll);
    for (const std::int32_t index : lists.of(i)) {
      if (lists.pair(index).i == i) queue(index, i);
    }
    predictor.predict_queued();
  }
  schedule.forget_orphans();
  schedule.reschedule_all();
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::reserve() {
  // An event predicts at most every pair of two bodies, or all pairs that a body had and all that it gets.
  const std::size_t most = 2 * neighbourhood.reserve();
  predictor.reserve(most);
  schedule.reserve(most);
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::start_epoch() {
  clock.go_to_end_of_epoch();
  NeighbourLists& lists = neighbourhood.lists();
  for (int i = 0; i < number(); ++i) {
    bodies.move(i, now());
    bodies.restart_clock(i, now());
    bodies.events(i).exit -= clock.epoch();
  }
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists.of(i)) {
      Pair& pair = lists.pair(index);
      if (pair.i == i) pair.time -= clock.epoch();
    }
  }
  added.start_epoch(clock.epoch());
  clock.start_epoch();
  schedule.reschedule_all();
}

template <class Bodies, CollisionLaw Law, class Added>
void LoopParts<Bodies, Law, Added>::use(geom::InstructionSet set) {
  options.batches = set;
  predictor.use(set);
  neighbourhood.use(set);
}

}  // namespace ed::internal
