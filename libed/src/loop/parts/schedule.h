#pragma once

#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "loop/parts/calendar.h"
#include "neighbours/lists.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed::internal {

/// The first event of each body, and the calendar of these.
///
/// A pair counts in the calendar entry of one of its bodies, its owner: the one that was predicted last. `Added`: kinds
/// of single-body events beyond the loop's own (AddedEvents).
template <class Bodies, class Added>
class Schedule {
 public:
  /// All must outlive this.
  Schedule(Bodies& bodies, NeighbourLists& lists, const Added& added)
      : bodies_(bodies), lists_(lists), added_(added), calendar_(bodies.number()) {}

  Calendar& calendar() { return calendar_; }
  const Calendar& calendar() const { return calendar_; }
  double earliest_time() const { return calendar_.earliest_time(); }
  int earliest() const { return calendar_.earliest(); }

  /// Returns the pair, which counts in the calendar entry of `owner` from now on.
  Pair& claim(std::int32_t index, std::int32_t owner) {
    Pair& pair = lists_.pair(index);
    release(index, pair.partner(owner));
    pair.owner = owner;
    return pair;
  }
  /// Notes that `body` has to be rescheduled if its first event is this pair, which it owns no longer.
  void release(std::int32_t index, std::int32_t body) {
    if (bodies_.events(body).first == index) orphans_.push_back(body);
  }

  /// Sets the first event of `body`: its exit, one of the pairs that it owns or an added event.
  void reschedule(int body) {
    double earliest = bodies_.events(body).exit;
    std::int32_t first = BodyEvents::kExit;
    for (const std::int32_t index : lists_.of(body)) {
      const Pair& pair = lists_.pair(index);
      if (pair.owner == body && pair.time < earliest) {
        earliest = pair.time;
        first = index;
      }
    }
    added_.take_earlier(body, earliest, first);
    bodies_.events(body).first = first;
    calendar_.set(body, earliest);
  }
  void reschedule_all() {
    for (int i = 0; i < bodies_.number(); ++i) reschedule(i);
  }
  /// Bodies that need rescheduling; may contain duplicates.
  const std::vector<int>& orphans() const { return orphans_; }
  void reschedule_orphans() {
    for (const int body : orphans_) reschedule(body);
    orphans_.clear();
  }
  /// Forgets the orphans, before all bodies are rescheduled.
  void forget_orphans() { orphans_.clear(); }
  void reserve(std::size_t orphans) { orphans_.reserve(orphans); }

  /// Whether every body's first event is one that it can have.
  bool is_sound() const {
    for (int i = 0; i < bodies_.number(); ++i) {
      const std::int32_t first = bodies_.events(i).first;
      const bool of_body = first == BodyEvents::kExit || Added::has(first);
      if (!of_body && !(lists_.lists(i, first) && lists_.pair(first).owner == i)) return false;
    }
    return true;
  }

 private:
  Bodies& bodies_;
  NeighbourLists& lists_;
  const Added& added_;
  Calendar calendar_;
  std::vector<int> orphans_;  ///< bodies that need rescheduling; may contain duplicates
};

}  // namespace ed::internal
