#pragma once

#include "base/prefetch.h"
#include "cells/levels.h"
#include "loop/event_kinds.h"
#include "loop/parts/calendar.h"
#include "neighbours/envelopes.h"
#include "neighbours/lists.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed::internal {

/// Data that events read, and the prefetching of it.
template <class Bodies>
struct EventSources {
  const Calendar& calendar;
  const Bodies& bodies;
  const NeighbourLists& lists;
  const Envelopes<Bodies>& envelopes;
  const CellLevels& cells;

  /// Prefetches the pairs of a body, whose list has been read or prefetched before, and where its time stands.
  void fetch_pairs(int body) const {
    for (const std::int32_t index : lists.of(body)) prefetch(lists.pair(index));
    calendar.fetch(body);
  }
  /// Prefetches the other bodies of these pairs.
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
  /// Prefetches the bodies around it, of which its new list is made.
  void fetch_cells(int body, double now) const { cells.fetch(body, bodies.position_at(body, now)); }
  /// Prefetches the last pair in each partner's list: it takes the place of a pair that leaves the list.
  void fetch_last_pairs_of_partners(int body) const {
    for (const std::int32_t index : lists.of(body)) {
      const auto list = lists.of(lists.pair(index).partner(body));
      prefetch(lists.pair(list.back()));
    }
  }
};

/// Prefetches what the next events read.
///
/// In a large system every event reads memory that is in no cache: lines of the calendar, the body, its list, the pairs
/// in it, their partners. Each is named by the one before, so that the loop would wait for one after another. But the
/// next events are known: those of the earliest body of each part into which the calendar divides all bodies. With
/// every event that is processed each of these goes on by one stage, which prefetches what the next stage reads.
///
/// Only speed depends on it. An event that turns out to be another one was prefetched in vain.
template <class Bodies, class Added>
class EventsAhead {
 public:
  /// Smallest number of bodies for which the parts of the calendar are not the bodies themselves.
  static constexpr int kFewest = Calendar::kFewestInParts;

  explicit EventsAhead(const Calendar& calendar) : coming_(calendar.parts()) {}

  /// Goes on by one stage; called before each event.
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
  /// Data that is prefetched next.
  enum class Stage : std::uint8_t { body, pairs, partners, pairs_of_other, partners_of_other, last_pairs, done };

  /// The earliest event of a part of the bodies.
  struct Coming {
    double time = -1;
    Calendar::Entry entry{0, 0};  ///< has this time; stands above the body's while that is looked for
    Stage stage = Stage::done;
    std::int32_t other = 0;  ///< the other body of a pair

    int body() const { return static_cast<int>(entry.index); }
  };

  /// Number of levels of the calendar that caches do not hold.
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

  static Stage after_pairs(Coming& coming, const EventSources<Bodies>& from, double now) {
    Stage next = Stage::done;
    dispatch<Added>(from.bodies, from.lists, coming.body(), [&](const auto& event) {
      const auto [i, j] = event.bodies(from.lists);
      coming.other = i == coming.body() ? j : i;
      next = fetch_for(event.kReads, coming, from, now);
    });
    return next;
  }

  static Stage fetch_for(EventReads reads, const Coming& coming, const EventSources<Bodies>& from, double now) {
    const int body = coming.body();
    switch (reads) {
      case EventReads::new_list:
        from.fetch_partners(body);
        from.fetch_lists_of_partners(body);
        from.fetch_cells(body, now);
        return Stage::last_pairs;
      case EventReads::partners:
        from.fetch_partners(body);
        return Stage::done;
      case EventReads::other:
        from.fetch_body(coming.other);
        return Stage::done;
      case EventReads::partners_of_both:
        from.fetch_body(coming.other);
        from.fetch_partners(body);
        return Stage::pairs_of_other;
    }
    return Stage::done;
  }

  std::vector<Coming> coming_;  ///< one for each part
};

}  // namespace ed::internal
