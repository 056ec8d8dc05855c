#pragma once

#include "base/prefetch.h"
#include "bodies/body_events.h"
#include "cells/grid.h"
#include "loop/calendar.h"
#include "neighbours/envelopes.h"
#include "neighbours/lists.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed::internal {

/// What events read.
template <class Bodies>
struct EventSources {
  const Calendar& calendar;
  const Bodies& bodies;
  const NeighbourLists& lists;
  const Envelopes<Bodies>& envelopes;
  const CellGrid& cells;

  /// The pairs of a body, whose list has been read or asked for before, and where its time stands.
  void fetch_pairs(int body) const {
    for (const std::int32_t index : lists.of(body)) prefetch(lists.pair(index));
    calendar.fetch(body);
  }
  /// The other bodies of these pairs.
  void fetch_partners(int body) const {
    for (const std::int32_t index : lists.of(body)) bodies.fetch(lists.pair(index).partner(body));
  }
  void fetch_body(int body) const {
    bodies.fetch_all(body);
    lists.fetch(body);
    envelopes.fetch(body);
  }
  void fetch_lists_of_partners(int body) const {
    for (const std::int32_t index : lists.of(body)) lists.fetch(lists.pair(index).partner(body));
  }
  /// The bodies around it, of which its new list is made.
  void fetch_cells(int body, double now) const { cells.fetch(bodies.position_at(body, now), envelopes.reach()); }
  /// A pair that leaves the list of a partner gives its place to the last one there.
  void fetch_last_pairs_of_partners(int body) const {
    for (const std::int32_t index : lists.of(body)) {
      const auto list = lists.of(lists.pair(index).partner(body));
      prefetch(lists.pair(list.back()));
    }
  }
};

/// Asks for what the next events read, in good time.
///
/// In a large system every event is somewhere else: the calendar's lines, the body, its list, the pairs in it, their
/// partners, each named by the one before, would be waited for one after another. But the events to come are known:
/// those of the earliest body of each part into which the calendar divides all. With every event each of these comes
/// one stage further, which asks for what the next stage reads.
///
/// Nothing but speed depends on it: what turns out otherwise was asked for in vain.
template <class Bodies>
class EventsAhead {
 public:
  /// Bodies, so that the parts of the calendar are not the bodies themselves.
  static constexpr int kFewest = Calendar::kFewestInParts;

  explicit EventsAhead(const Calendar& calendar) : coming_(calendar.parts()) {}

  /// Before each event.
  void step(const EventSources<Bodies>& from, double now) {
    for (std::size_t part = 0; part < coming_.size(); ++part) {
      Coming& coming = coming_[part];
      const double time = from.calendar.time(from.calendar.part(part));
      if (time != coming.time) {
        coming = start(from.calendar, part, time);
      } else if (coming.stage != Stage::done) {
        coming.stage = next_stage(coming, from, now);
      }
    }
  }

 private:
  /// What is asked for next.
  enum class Stage : std::uint8_t { body, pairs, partners, pairs_of_other, partners_of_other, last_pairs, done };

  /// The earliest event of a part of the bodies.
  struct Coming {
    double time = -1;
    Calendar::Entry entry{0, 0};  ///< with this time; above the body's while that is looked for
    Stage stage = Stage::done;
    std::int32_t other = 0;  ///< the second body of a contact

    int body() const { return static_cast<int>(entry.index); }
  };

  /// Levels of the calendar that caches do not hold.
  static constexpr std::size_t kFarLevels = 2;

  static Coming start(const Calendar& calendar, std::size_t part, double time) {
    Coming coming{time, calendar.part(part), Stage::body, 0};
    while (coming.entry.level > kFarLevels) coming.entry = calendar.earliest_below(coming.entry);
    calendar.fetch_below(coming.entry);
    return coming;
  }

  static Stage next_stage(Coming& coming, const EventSources<Bodies>& from, double now) {
    switch (coming.stage) {
      case Stage::body:
        coming.entry = from.calendar.earliest_below(coming.entry);
        if (coming.entry.level > 0) {
          from.calendar.fetch_below(coming.entry);
          return Stage::body;
        }
        from.fetch_body(coming.body());
        return Stage::pairs;
      case Stage::pairs:
        from.fetch_pairs(coming.body());
        return Stage::partners;
      case Stage::partners:
        return after_pairs(coming, from, now);
      case Stage::pairs_of_other:
        from.fetch_pairs(coming.other);
        return Stage::partners_of_other;
      case Stage::partners_of_other:
        from.fetch_partners(coming.other);
        return Stage::done;
      case Stage::last_pairs:
        from.fetch_last_pairs_of_partners(coming.body());
        return Stage::done;
      case Stage::done:
        break;
    }
    return Stage::done;
  }

  /// By the kind of event.
  static Stage after_pairs(Coming& coming, const EventSources<Bodies>& from, double now) {
    const int body = coming.body();
    const std::int32_t first = from.bodies.events(body).first;
    if (first == BodyEvents::kExit) {
      from.fetch_partners(body);
      from.fetch_lists_of_partners(body);
      from.fetch_cells(body, now);
      return Stage::last_pairs;
    }
    const Pair& pair = from.lists.pair(first);
    coming.other = pair.partner(body);
    from.fetch_body(coming.other);
    if (pair.event == PairEvent::bound) return Stage::done;
    from.fetch_partners(body);
    return Stage::pairs_of_other;
  }

  std::vector<Coming> coming_;  ///< of each part
};

}  // namespace ed::internal
