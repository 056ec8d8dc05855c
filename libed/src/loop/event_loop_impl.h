#pragma once

/// Members of EventLoop, except for those of its state (state_impl.h) and of stalls (stall_impl.h).

#include "contact/checks.h"
#include "loop/checks.h"
#include "loop/event_kinds_impl.h"
#include "loop/event_loop.h"
#include "neighbours/limits.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ed::internal {

/// Share of the thickness at which bodies count as leaving their envelopes while the box shrinks.
inline constexpr double kShrinkingExit = 0.8;

template <class Bodies, CollisionLaw Law, class Added>
EventLoop<Bodies, Law, Added>::EventLoop(const System& system, const SimulationOptions& options, Law law, Added added)
    : EventLoop(system, options, Unbuilt(), std::move(law), std::move(added)) {
  parts_.clock.set_epoch(epoch_of(system));
  make_lists(options.envelope, false, options.poll);
}

template <class Bodies, CollisionLaw Law, class Added>
EventLoop<Bodies, Law, Added>::EventLoop(const System& system, const SimulationOptions& options, Unbuilt /*unbuilt*/,
                                         Law law, Added added)
    : parts_(system, options, std::move(law), std::move(added)), watch_(system.size()) {
  const Bodies& bodies = parts_.bodies;
  check_box(system, bodies.bounding_radius());
  check_contact_options(options.contact, bodies.inscribed_radius());
  if (options.neighbours == Neighbours::cells) check_cells(system.box, bodies.bounding_radius());
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::set_envelope(double thickness, bool shrinking) {
  make_lists(thickness, shrinking, {});
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::make_lists(double thickness, bool shrinking, const std::function<void()>& poll) {
  // A share of the mean distance of neighbours: a first guess that is within a factor of two of the best.
  if (!(thickness > 0)) thickness = 0.22 * box() / std::cbrt(static_cast<double>(number()));
  const double exit_share = shrinking ? kShrinkingExit : 1.0;
  parts_.neighbourhood.set_envelopes(make_envelopes(parts_.bodies, parts_.options, thickness, exit_share, box()));
  parts_.rebuild_all(poll);
}

template <class Bodies, CollisionLaw Law, class Added>
Counters EventLoop<Bodies, Law, Added>::counters() const {
  Counters c = parts_.counters;
  const FinderCounters& finder = parts_.predictor.count();
  c.predictions = finder.predictions;
  c.evaluations = finder.evaluations;
  c.kernel_calls = finder.kernel_calls;
  c.cold_restarts = finder.cold_restarts;
  c.rescues = finder.rescues;
  return c;
}

template <class Bodies, CollisionLaw Law, class Added>
System EventLoop<Bodies, Law, Added>::system() const {
  System result;
  result.box = box();
  result.species = parts_.species;
  result.bodies.resize(at(number()));
  for (int i = 0; i < number(); ++i) {
    const Motion motion = parts_.bodies.motion(i, parts_.now());
    result.bodies[at(i)] = {nearest_image(motion.pose.position(), box()), motion.pose.rotation(), motion.velocity,
                            motion.angular_velocity, parts_.species_of[at(i)]};
  }
  return result;
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::sample(Snapshot& snapshot) const {
  snapshot.time = time();
  snapshot.position.resize(at(number()));
  snapshot.axis.resize(at(number()));
  snapshot.rotation.resize(Bodies::kSamplesRotations ? at(number()) : 0);
  snapshot.phi_lab.resize(at(number()));
  snapshot.phi_body.resize(at(number()));
  snapshot.velocity.resize(at(number()));
  snapshot.angular_velocity.resize(at(number()));
  for (int i = 0; i < number(); ++i) {
    snapshot.position[at(i)] = parts_.box.unwrapped(i, parts_.bodies.position_at(i, parts_.now()));
  }
  parts_.bodies.sample(parts_.now(), snapshot);
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::sample_translations(Snapshot& snapshot) const {
  snapshot.time = time();
  snapshot.position.resize(at(number()));
  snapshot.velocity.resize(at(number()));
  // Frames are many: zeros are written into the first one.
  for (auto* kept : {&snapshot.axis, &snapshot.phi_lab, &snapshot.phi_body, &snapshot.angular_velocity}) {
    if (kept->size() != at(number())) kept->assign(at(number()), Eigen::Vector3d::Zero());
  }
  snapshot.rotation.clear();
  for (int i = 0; i < number(); ++i) {
    snapshot.position[at(i)] = parts_.box.unwrapped(i, parts_.bodies.position_at(i, parts_.now()));
    snapshot.velocity[at(i)] = parts_.bodies.velocity(i);
  }
}

// ---- Run -----------------------------------------------------------------------------------------------------------

template <class Bodies, CollisionLaw Law, class Added>
bool EventLoop<Bodies, Law, Added>::run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) {
  const Counters& count = parts_.counters;
  const std::uint64_t last = count.collisions + std::min(max_collisions, ~std::uint64_t{0} - count.collisions);
  std::uint64_t events_left = max_events;
  EpochClock& clock = parts_.clock;
  while (count.collisions < last && !watch_.stall()) {
    const double local_end = clock.local(time);
    const double next = parts_.schedule.earliest_time();
    if (next > std::min(local_end, clock.epoch())) {
      if (local_end <= clock.epoch()) {
        clock.advance(local_end);
        return true;
      }
      // Epochs count as events: with all bodies at rest there is nothing else.
      if (events_left-- == 0) return false;
      parts_.start_epoch();
      continue;
    }
    // Tested only here, because the end can also be reached without events left.
    if (events_left-- == 0) return false;
    process_next();
    if (watch_.count()) [[unlikely]]
      look_for_stall(std::min(local_end, clock.epoch()));
  }
  return false;
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::process_next() {
  if (parts_.ahead) parts_.ahead->step(parts_.sources(), parts_.now());
  const int body = parts_.schedule.earliest();
  parts_.clock.advance(parts_.schedule.earliest_time());
  dispatch<Added>(parts_.bodies, parts_.neighbourhood.lists(), body,
                  [this](const auto& event) { event.process(parts_); });
}

// ---- Compression ---------------------------------------------------------------------------------------------------

template <class Bodies, CollisionLaw Law, class Added>
double EventLoop<Bodies, Law, Added>::shrink_box(double target_box, double least_gain) {
  Bodies& bodies = parts_.bodies;
  if (parts_.neighbourhood.is_used_up()) set_envelope(0, true);
  const double now = parts_.now();
  for (int i = 0; i < number(); ++i) bodies.move(i, now);
  double factor = std::max(
      {target_box / box(), parts_.neighbourhood.least_factor(), smallest_image_box(bodies.bounding_radius()) / box()});
  factor = std::min(factor, 1.0);
  if (1 - factor < least_gain) return box();
  // The last step may be small, however large the usual one is.
  factor = possible_scale(factor, std::min(least_gain, 0.5 * (1 - target_box / box())));
  // A tenth of the closest pair's gap is left: bodies that roll on each other in small hops would otherwise be squeezed
  // into ever smaller ones.
  if (factor * box() > target_box) factor += 0.1 * (1 - factor);
  if (!(factor < 1)) return box();
  parts_.box.scale(factor);
  bodies.scale_positions(factor, now);
  parts_.neighbourhood.scale(factor, now);
  for (int i = 0; i < number(); ++i) parts_.added.predict(bodies, i, parts_.clock, parts_.box);
  parts_.predict_all();
  return box();
}

/// Returns the least factor, no less than `factor`, by which positions can be scaled without an overlap; 1 if less than
/// `least_gain` would be gained.
template <class Bodies, CollisionLaw Law, class Added>
double EventLoop<Bodies, Law, Added>::possible_scale(double factor, double least_gain) const {
  const Bodies& bodies = parts_.bodies;
  const NeighbourLists& lists = parts_.neighbourhood.lists();
  const double now = parts_.now();
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists.of(i)) {
      const Pair& pair = lists.pair(index);
      if (pair.i == i) {
        const Eigen::Vector3d r = parts_.neighbourhood.between(pair, now);
        factor = std::max(factor, bodies.contact_scale(i, pair.j, r, pair.normal, now, factor));
      }
      if (1 - factor < least_gain) return 1;
    }
  }
  return factor;
}

}  // namespace ed::internal
