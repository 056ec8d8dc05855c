#pragma once

/// List of the kinds of events of a loop, and the only dispatch between them.
///
/// A kind is a class of events with
///
///     static constexpr EventKind kKind;
///     static constexpr EventReads kReads;      // data to prefetch
///     std::array<std::int32_t, 2> bodies(const NeighbourLists& lists) const;  // -1: none
///     static void predict(loop, ...);          // sets the time of the event
///     void process(loop) const;                // at that time
///
/// `loop` are the parts of an event loop (loop_parts.h). Exits and added events are of one body: BodyEvents::first says
/// which it is. The others are of a pair: Pair::event says which it is.

#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "neighbours/lists.h"

#include <ed/simulation.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace ed::internal {

/// Data that an event reads beyond its body, the body's list and the pairs in that.
enum class EventReads : std::uint8_t {
  new_list,          ///< partners, their lists, and the bodies near by
  partners,          ///< partners
  other,             ///< the other body of a pair
  partners_of_both,  ///< the other body of a pair, and the partners of both
};

/// Event of one body.
struct BodyEventBase {
  std::int32_t body;

  std::array<std::int32_t, 2> bodies(const NeighbourLists& /*lists*/) const { return {body, -1}; }
};

/// Exit of a body from its envelope.
struct ExitEvent : BodyEventBase {
  static constexpr EventKind kKind = EventKind::exit;
  static constexpr EventReads kReads = EventReads::new_list;

  template <class Loop>
  static void predict(Loop& loop, int body);
  template <class Loop>
  void process(Loop& loop) const;
};

/// Event of a pair, by its index. One search predicts which kind it is.
struct PairEventBase {
  std::int32_t index;

  std::array<std::int32_t, 2> bodies(const NeighbourLists& lists) const {
    return {lists.pair(index).i, lists.pair(index).j};
  }
  template <class Loop>
  static void predict(Loop& loop, std::int32_t index, int owner, int max_evaluations);
};

/// The certified bound of a pair has come: its search goes on from there.
struct LookEvent : PairEventBase {
  static constexpr EventKind kKind = EventKind::look;
  static constexpr EventReads kReads = EventReads::other;

  template <class Loop>
  void process(Loop& loop) const;
};

/// Contact of a pair.
struct ContactEvent : PairEventBase {
  static constexpr EventKind kKind = EventKind::contact;
  static constexpr EventReads kReads = EventReads::partners_of_both;

  template <class Loop>
  void process(Loop& loop) const;
};

/// Event of the added kind number k (added_events.h).
template <std::size_t k>
struct AddedEvent : BodyEventBase {
  static constexpr EventKind kKind = EventKind::added;
  static constexpr EventReads kReads = EventReads::partners;

  template <class Loop>
  static void predict(Loop& loop, int body);
  template <class Loop>
  void process(Loop& loop) const;
};

/// Calls f with the first event of `body`, as an object of its kind.
template <class Added, class Bodies, class F>
void dispatch(const Bodies& bodies, const NeighbourLists& lists, std::int32_t body, const F& f) {
  const std::int32_t first = bodies.events(body).first;
  if (first >= 0) {
    if (lists.pair(first).event == PairEvent::bound) {
      f(LookEvent{first});
    } else {
      f(ContactEvent{first});
    }
  } else if (Added::kNumber == 0 || first == BodyEvents::kExit) {
    f(ExitEvent{body});
  } else {
    Added::for_each_kind([&](auto k) {
      if (first == Added::first_of(static_cast<std::int32_t>(k))) f(AddedEvent<k>{body});
    });
  }
}

}  // namespace ed::internal
