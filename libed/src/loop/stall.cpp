// What an event loop that makes no progress is stuck in. Apart from the loop, as event_loop_state.cpp.

#include "bodies/general.h"
#include "bodies/uniaxial.h"
#include "loop/event_loop.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace ed::internal {

/// Whether the last events took as much time as they should.
template <class Bodies>
bool EventLoop<Bodies>::progresses() const {
  double fastest = 0;
  for (int i = 0; i < number(); ++i) {
    fastest = std::max(fastest, bodies_.velocity(i).norm() + bodies_.turning(i) * bodies_.bounding_radius(i));
  }
  return (time() - stall_watch_) * fastest >= options_.least_progress * bodies_.inscribed_radius();
}

template <class Bodies>
void EventLoop<Bodies>::look_for_stall(double end) {
  if (!progresses()) {
    Stall stall = most_frequent_event(end);
    stall.time = time();
    stall.events = events_;
    stall.span = time() - stall_watch_;
    stall_ = stall;
  }
  events_ = 0;
  stall_watch_ = time();
}

/// Of the next events, up to `end`, which are processed.
template <class Bodies>
Stall EventLoop<Bodies>::most_frequent_event(double end) {
  std::map<std::tuple<EventKind, int, int>, int> seen;
  int sample = 0;
  for (; sample < kStallSample && calendar_.earliest_time() <= end; ++sample) {
    const int body = calendar_.earliest();
    const std::int32_t index = bodies_.events(body).first;
    if (index == kExit) {
      ++seen[{EventKind::exit, body, -1}];
    } else {
      const Pair& pair = lists_.pair(index);
      ++seen[{pair.event == PairEvent::bound ? EventKind::look : EventKind::contact, pair.i, pair.j}];
    }
    process_next();
    ++events_;
  }
  Stall stall;
  for (const auto& [event, times] : seen) {
    if (times <= stall.share * sample) continue;
    std::tie(stall.kind, stall.i, stall.j) = event;
    stall.share = static_cast<double>(times) / sample;
  }
  return stall;
}

template void EventLoop<UniaxialBodies>::look_for_stall(double end);
template void EventLoop<GeneralBodies>::look_for_stall(double end);

}  // namespace ed::internal
