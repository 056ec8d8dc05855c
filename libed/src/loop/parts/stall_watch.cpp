#include "loop/parts/stall_watch.h"

namespace ed::internal {

void EventTally::add(EventKind kind, const std::array<std::int32_t, 2>& bodies) {
  ++times_[{kind, bodies[0], bodies[1]}];
  ++events_;
}

Stall EventTally::most_frequent() const {
  Stall stall;
  for (const auto& [event, times] : times_) {
    if (times <= stall.share * events_) continue;
    std::tie(stall.kind, stall.i, stall.j) = event;
    stall.share = static_cast<double>(times) / events_;
  }
  return stall;
}

void StallWatch::declare_stalled(const EventTally& sample, double time) {
  Stall stall = sample.most_frequent();
  stall.time = time;
  stall.events = events_;
  stall.span = span(time);
  stall_ = stall;
}

}  // namespace ed::internal
