#pragma once

/// Members of EventLoop that say what a loop without progress is stuck in.

#include "loop/event_loop.h"

#include <algorithm>

namespace ed::internal {

template <class Bodies, CollisionLaw Law, class Added>
double EventLoop<Bodies, Law, Added>::fastest_speed() const {
  const Bodies& bodies = parts_.bodies;
  double fastest = 0;
  for (int i = 0; i < number(); ++i) {
    fastest = std::max(fastest, bodies.velocity(i).norm() + bodies.angular_speed_bound(i) * bodies.bounding_radius(i));
  }
  return fastest;
}

/// Asks whether the last events took as much time as they should. If not, processes some more of them, up to `end`, to
/// say which is the most frequent.
template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::look_for_stall(double end) {
  const double least = parts_.options.least_progress * parts_.bodies.inscribed_radius();
  if (!(watch_.span(time()) * fastest_speed() >= least)) {
    EventTally tally;
    while (tally.events() < StallWatch::kSample && parts_.schedule.earliest_time() <= end) {
      const NeighbourLists& lists = parts_.neighbourhood.lists();
      dispatch<Added>(parts_.bodies, lists, parts_.schedule.earliest(),
                      [&](const auto& event) { tally.add(event.kKind, event.bodies(lists)); });
      process_next();
      (void)watch_.count();
    }
    watch_.declare_stalled(tally, time());
  }
  watch_.restart(time());
}

}  // namespace ed::internal
