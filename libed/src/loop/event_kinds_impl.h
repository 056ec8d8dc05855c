#pragma once

/// Prediction and processing of the kinds of events (event_kinds.h). `loop`: LoopParts.

#include "loop/added_events.h"
#include "loop/event_kinds.h"
#include "loop/loop_parts.h"

namespace ed::internal {

// ---- Exit ----------------------------------------------------------------------------------------------------------

template <class Loop>
void ExitEvent::predict(Loop& loop, int body) {
  loop.neighbourhood.renew_exit(body, loop.now());
}

template <class Loop>
void ExitEvent::process(Loop& loop) const {
  loop.fetch_pairs(body);
  predict(loop, body);
  if (!loop.neighbourhood.lasts(body, loop.now())) {
    loop.rebuild(body);
    return;
  }
  // Still inside: pairs that were clear up to the earlier bound are searched again.
  const NeighbourLists& lists = loop.neighbourhood.lists();
  for (const std::int32_t index : lists.of(body)) {
    if (lists.pair(index).event == PairEvent::clear) loop.queue(index, body);
  }
  loop.predict_queued();
  loop.schedule.reschedule(body);
}

// ---- Pairs ---------------------------------------------------------------------------------------------------------

template <class Loop>
void PairEventBase::predict(Loop& loop, std::int32_t index, int owner, int max_evaluations) {
  loop.predictor.search(loop.schedule.claim(index, owner), max_evaluations);
}

template <class Loop>
void LookEvent::process(Loop& loop) const {
  const auto search_evaluations = [&loop] {
    const FinderCounters& count = loop.predictor.count();
    return count.evaluations - count.newton_evaluations;
  };
  const std::uint64_t before = search_evaluations();
  const int owner = loop.neighbourhood.lists().pair(index).owner;
  loop.fetch_pairs(owner);
  predict(loop, index, owner, loop.predictor.kSecondLook);
  loop.counters.refinements += search_evaluations() - before;
  loop.schedule.reschedule(owner);
}

template <class Loop>
void ContactEvent::process(Loop& loop) const {
  Pair& pair = loop.neighbourhood.lists().pair(index);
  const int i = pair.i;
  const int j = pair.j;
  const double now = loop.now();
  loop.fetch_pairs(i);
  loop.fetch_pairs(j);
  loop.bodies.move(i, now);
  loop.bodies.move(j, now);
  const Eigen::Vector3d r = loop.neighbourhood.between(pair, now);
  auto contact = loop.bodies.contact(i, j, r, pair.normal, now);
  const double J = loop.law(contact.a, contact.b, pair.normal);
  if (!(J > 0)) {
    // Nothing has changed, so that the same contact would be found again: look when the bodies have moved a little.
    ++loop.counters.parting_contacts;
    loop.predictor.retry_after(now, pair);
    loop.schedule.reschedule(pair.owner);
    return;
  }
  loop.bodies.leave(i, j, contact, now);
  ++loop.counters.collisions;
  loop.collisions.add(i, j, r, J, pair.normal);
  if (loop.collisions.wants_more()) loop.collisions.record(loop.clock.time(), i, j);
  loop.fetch_partners(i);
  loop.fetch_partners(j);
  loop.predict_body(i);
  loop.predict_body(j);
  loop.queue_all_of(i, loop.kNoPair);
  loop.queue_all_of(j, index);
  loop.predict_queued();
  loop.schedule.reschedule(i);
  loop.schedule.reschedule(j);
}

// ---- Added ---------------------------------------------------------------------------------------------------------

template <std::size_t k>
template <class Loop>
void AddedEvent<k>::predict(Loop& loop, int body) {
  loop.added.template predict<k>(loop.bodies, body, loop.clock, loop.box);
}

template <std::size_t k>
template <class Loop>
void AddedEvent<k>::process(Loop& loop) const {
  loop.fetch_pairs(body);
  const BodyChange change = loop.added.template process<k>(loop.bodies, body, loop.clock, loop.box);
  if (change == BodyChange::none) {
    predict(loop, body);
  } else {
    loop.fetch_partners(body);
    loop.predict_body(body);
    loop.queue_all_of(body, loop.kNoPair);
    loop.predict_queued();
  }
  loop.schedule.reschedule(body);
}

}  // namespace ed::internal
