#include "loop/event_loop.h"

#include "loop/factory.h"

#include "base/power_of_two.h"
#include "bodies/general.h"
#include "bodies/uniaxial.h"
#include "contact/body_shapes.h"
#include "contact/checks.h"
#include "neighbours/cell.h"
#include "neighbours/limits.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// Points in time that a pair is looked at when it is predicted, and when it comes up again. One gives a bound that
/// lasts for most pairs; what is left is close, and gets a second look at once.
constexpr int kFirstLook = 1;
constexpr int kSecondLook = 2;

/// While the box shrinks bodies count as leaving their envelopes at this share of the thickness.
constexpr double kShrinkingExit = 0.8;

/// Bodies that overlap and part are looked at again after this share of the time in which they could cross each other.
constexpr double kPartingLook = 1e-3;

void check_box(const System& system, double bounding_radius) {
  if (system.box >= smallest_image_box(bounding_radius) * (1 - 1e-12)) return;
  std::ostringstream message;
  message << "box: an edge of " << system.box << " is too short for bodies of bounding radius " << bounding_radius
          << ": a body could meet two images of another; accepted: at least " << smallest_image_box(bounding_radius);
  if (system.species.size() == 1) {
    message << " (number: at least " << smallest_number(system.species[0].shape, packing_fraction(system))
            << " at this packing fraction)";
  }
  throw std::invalid_argument(message.str());
}

void check_cells(double box, double bounding_radius) {
  const int cells = CellLayout::cells_along(box, bounding_radius);
  if (cells >= CellLayout::kLeastCells) return;
  std::ostringstream message;
  message << "neighbours = \"cells\": only " << cells << " cells of twice the bounding radius " << bounding_radius
          << " fit along the box's edge of " << box << "; accepted: at least " << CellLayout::kLeastCells;
  throw std::invalid_argument(message.str());
}

/// How long an epoch lasts: a power of two about the time in which bodies move by their size, so that times within it
/// are as exact as the way that bodies go in them. The harmonic mean of these times: at its end all bodies are moved,
/// which is then about as often as they move by their sizes, be a few of them as fast as they may.
double epoch_of(const System& system) {
  const KineticState kinetic = kinetic_state(system);
  const int freedoms = 3 * system.size() + kinetic.rotational_freedoms + kinetic.spin_freedoms;
  const double kT = 2 * kinetic.energy() / freedoms;
  if (!(kT > 0)) return 1;  // nothing moves
  double rates = 0;
  for (int i = 0; i < system.size(); ++i) rates += 1 / thermal_time(system.species_of(i));
  return nearest_power_of_two(system.size() / (rates * std::sqrt(kT)));
}

}  // namespace

std::unique_ptr<AnyEventLoop> make_event_loop(const System& system, const SimulationOptions& options) {
  for (const Species& species : system.species) check_finder(options.contact, species.shape);
  if (UniaxialBodies::can_hold(system)) return std::make_unique<EventLoop<UniaxialBodies>>(system, options);
  return std::make_unique<EventLoop<GeneralBodies>>(system, options);
}

template <class Bodies>
EventLoop<Bodies>::EventLoop(const System& system, const SimulationOptions& options)
    : EventLoop(system, options, Unbuilt()) {
  epoch_ = epoch_of(system);
  set_envelope(options.envelope);
}

template <class Bodies>
EventLoop<Bodies>::EventLoop(const System& system, const SimulationOptions& options, Unbuilt /*unbuilt*/)
    : options_(options),
      species_(system.species),
      box_(system.box),
      bodies_(system),
      images_(at(system.size()), Eigen::Vector3i::Zero()),
      lists_(system.size()),
      calendar_(system.size()),
      first_looks_(make_first_looks(bodies_, options)) {
  check_box(system, bodies_.bounding_radius());
  check_contact_options(options.contact, bodies_.inscribed_radius());
  if (options.neighbours == Neighbours::cells) check_cells(box_, bodies_.bounding_radius());
  for (const Body& body : system.bodies) species_of_.push_back(body.species);
  if (number() >= std::max(options.prepare_from, EventsAhead<Bodies>::kFewest)) ahead_.emplace(calendar_);
  collisions_of_.resize(at(system.size()), 0);
  failures_.reserve(kReasons * kMaxFailuresRecorded);
}

template <class Bodies>
void EventLoop<Bodies>::set_envelope(double thickness, bool shrinking) {
  // A share of the mean distance of neighbours: a first guess that is within a factor of two of the best.
  if (!(thickness > 0)) thickness = 0.22 * box_ / std::cbrt(static_cast<double>(number()));
  envelopes_ = make_envelopes(bodies_, options_, thickness, shrinking ? kShrinkingExit : 1.0, box_);
  rebuild_all();
}

template <class Bodies>
Counters EventLoop<Bodies>::counters() const {
  Counters c = counters_;
  c.predictions = finder_.predictions;
  c.evaluations = finder_.evaluations;
  c.kernel_calls = finder_.kernel_calls;
  c.cold_restarts = finder_.cold_restarts;
  c.rescues = finder_.rescues;
  return c;
}

template <class Bodies>
std::uint64_t EventLoop<Bodies>::collisions_of(int first, int end) const {
  return std::accumulate(collisions_of_.begin() + first, collisions_of_.begin() + end, std::uint64_t{0});
}

template <class Bodies>
void EventLoop<Bodies>::record_collisions(std::size_t number) {
  collisions_.clear();
  collisions_.reserve(std::min(number, kCollisionsReserved));
  collisions_wanted_ = number;
}

// ---- State of the bodies -------------------------------------------------------------------------------------------

template <class Bodies>
void EventLoop<Bodies>::wrap(int i) {
  const Vector3d r = bodies_.position_at(i, now_);
  Vector3d by = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double boxes = nearest_integer(r[k] / box_);
    if (boxes == 0) continue;
    by[k] = -boxes * box_;
    images_[at(i)][k] += static_cast<int>(boxes);
  }
  bodies_.shift(i, by);
}

template <class Bodies>
System EventLoop<Bodies>::system() const {
  System result;
  result.box = box_;
  result.species = species_;
  result.bodies.resize(at(number()));
  for (int i = 0; i < number(); ++i) {
    const Motion motion = motion_of(i, now_);
    result.bodies[at(i)] = {nearest_image(motion.pose.position(), box_), motion.pose.rotation(), motion.velocity,
                            motion.angular_velocity, species_of_[at(i)]};
  }
  return result;
}

template <class Bodies>
Motion EventLoop<Bodies>::motion_of(int i, double t) const {
  Motion motion = bodies_.motion(i, t);
  motion.time = epochs_ * epoch_ + t;
  return motion;
}

template <class Bodies>
void EventLoop<Bodies>::sample(Snapshot& snapshot) const {
  snapshot.time = time();
  snapshot.position.resize(at(number()));
  snapshot.axis.resize(at(number()));
  snapshot.rotation.resize(Bodies::kSamplesRotations ? at(number()) : 0);
  snapshot.phi_lab.resize(at(number()));
  snapshot.phi_body.resize(at(number()));
  snapshot.velocity.resize(at(number()));
  snapshot.angular_velocity.resize(at(number()));
  for (int i = 0; i < number(); ++i) {
    snapshot.position[at(i)] = bodies_.position_at(i, now_) + box_ * images_[at(i)].template cast<double>();
    bodies_.sample(i, now_, snapshot);
  }
}

// ---- Prediction ----------------------------------------------------------------------------------------------------

/// From the centre of i to that of j now, in the image in which they can touch.
template <class Bodies>
Vector3d EventLoop<Bodies>::between(const Pair& pair) const {
  const Vector3d d = bodies_.position_at(pair.j, now_) - bodies_.position_at(pair.i, now_);
  return envelopes_->image(pair.i, pair.j, d, box_);
}

template <class Bodies>
void EventLoop<Bodies>::search(Pair& pair, int max_evaluations) {
  const Finding finding = bodies_.find_contact(pair.i, pair.j, between(pair), now_, search_end(pair), max_evaluations,
                                               options_.contact, pair.normal, finder_, unsolved_);
  if (unsolved_) {
    report(pair, unsolved_->time, FailureReason::distance);
    unsolved_.reset();
  }
  keep(pair, finding);
}

template <class Bodies>
double EventLoop<Bodies>::search_end(const Pair& pair) const {
  return std::max(now_, std::min(bodies_.events(pair.i).exit, bodies_.events(pair.j).exit));
}

template <class Bodies>
void EventLoop<Bodies>::keep(Pair& pair, const Finding& finding) {
  switch (finding.outcome) {
    case Outcome::clear:
      pair.event = PairEvent::clear;
      pair.time = kNever;
      break;
    case Outcome::bound:
      pair.event = PairEvent::bound;
      pair.time = finding.time;
      break;
    case Outcome::contact:
      pair.event = PairEvent::contact;
      pair.time = finding.time;
      break;
    case Outcome::declined:
      ++counters_.declined;
      report(pair, finding.time, FailureReason::declined);
      pair.event = PairEvent::bound;
      pair.time = finding.time + kPartingLook * parting_time(pair);
      break;
    case Outcome::overlapping:
      ++counters_.overlaps;
      report(pair, finding.time, FailureReason::overlap);
      // Approaching: let them collide now. Parting: look again when they have moved a little.
      pair.event = finding.approaching ? PairEvent::contact : PairEvent::bound;
      pair.time = finding.approaching ? finding.time : finding.time + kPartingLook * parting_time(pair);
      break;
  }
}

/// The least time in which the bodies of a pair can move by the sum of their bounding radii.
template <class Bodies>
double EventLoop<Bodies>::parting_time(const Pair& pair) const {
  const double reach = bodies_.bounding_radius(pair.i) + bodies_.bounding_radius(pair.j);
  const double speed = (bodies_.velocity(pair.j) - bodies_.velocity(pair.i)).norm();
  return reach / (speed + reach * (bodies_.turning(pair.i) + bodies_.turning(pair.j)));
}

/// The pair, which counts in the calendar entry of `owner` from now on.
template <class Bodies>
Pair& EventLoop<Bodies>::claim(std::int32_t index, int owner) {
  Pair& pair = lists_.pair(index);
  const std::int32_t partner = pair.partner(owner);
  if (bodies_.events(partner).first == index) orphans_.push_back(partner);
  pair.owner = owner;
  return pair;
}

template <class Bodies>
void EventLoop<Bodies>::predict(std::int32_t index, int owner, int max_evaluations) {
  search(claim(index, owner), max_evaluations);
}

template <class Bodies>
void EventLoop<Bodies>::queue(std::int32_t index, int owner) {
  Pair& pair = claim(index, owner);
  queue_.push_back({&pair, search_end(pair)});
}

template <class Bodies>
void EventLoop<Bodies>::fetch_pairs(int body) const {
  if (ahead_) sources().fetch_pairs(body);
}

template <class Bodies>
void EventLoop<Bodies>::fetch_partners(int body) const {
  if (ahead_) sources().fetch_partners(body);
}

template <class Bodies>
void EventLoop<Bodies>::queue_all_of(int body, std::int32_t skip) {
  for (const std::int32_t index : lists_.of(body)) {
    if (index != skip) queue(index, body);
  }
}

/// No pair may be added to the lists, or removed, and no body change, since they were queued.
template <class Bodies>
void EventLoop<Bodies>::predict_queued() {
  if (first_looks_) first_looks_->take(bodies_, now_, box_, queue_, finder_);
  for (const Look& look : queue_) {
    if (look.answered) {
      keep(*look.pair, look.finding);
    } else {
      search(*look.pair, kFirstLook);
    }
  }
  queue_.clear();
}

/// Every pair, for its body i. The calendar is to be made anew.
template <class Bodies>
void EventLoop<Bodies>::predict_all() {
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      if (lists_.pair(index).i == i) queue(index, i);
    }
    predict_queued();
  }
  orphans_.clear();
}

template <class Bodies>
void EventLoop<Bodies>::reschedule(int body) {
  double earliest = bodies_.events(body).exit;
  std::int32_t first = kExit;
  for (const std::int32_t index : lists_.of(body)) {
    const Pair& pair = lists_.pair(index);
    if (pair.owner == body && pair.time < earliest) {
      earliest = pair.time;
      first = index;
    }
  }
  bodies_.events(body).first = first;
  calendar_.set(body, earliest);
}

template <class Bodies>
void EventLoop<Bodies>::reschedule_orphans() {
  for (const int body : orphans_) fetch_pairs(body);
  for (const int body : orphans_) reschedule(body);
  orphans_.clear();
}

template <class Bodies>
void EventLoop<Bodies>::report(const Pair& pair, double time, FailureReason reason) {
  std::size_t& recorded = failures_of_[static_cast<std::size_t>(reason)];
  if (recorded == kMaxFailuresRecorded) {
    ++counters_.unrecorded_failures;
    return;
  }
  ++recorded;
  FailedPair& failed = failures_.emplace_back();  // reserved: no allocation
  failed.reason = reason;
  failed.shape_i = species_[at(species_of_[at(pair.i)])].shape;
  failed.shape_j = species_[at(species_of_[at(pair.j)])].shape;
  failed.motion_i = motion_of(pair.i, time);
  failed.motion_j = motion_of(pair.j, time);
  const Vector3d r = between(pair) + (time - now_) * (failed.motion_j.velocity - failed.motion_i.velocity);
  failed.motion_j.pose = geom::Pose(failed.motion_j.pose.rotation(), failed.motion_i.pose.position() + r);
  failed.time = failed.motion_i.time;
  failed.i = pair.i;
  failed.j = pair.j;
  failed.finder = options_.contact.finder;
  failed.eps_d = options_.contact.eps_d;
  if (reason == FailureReason::distance) failed.distance = unsolved_->call;
}

// ---- Envelopes and lists -------------------------------------------------------------------------------------------

template <class Bodies>
void EventLoop<Bodies>::renew_exit(int i) {
  ++counters_.envelope_checks;
  bodies_.events(i).exit = envelopes_->exit_time(i, bodies_, now_, box_);
}

template <class Bodies>
void EventLoop<Bodies>::rebuild(int i) {
  ++counters_.neighbour_rebuilds;
  fetch_pairs(i);
  bodies_.move(i, now_);
  wrap(i);
  envelopes_->place(i, bodies_, now_);
  const Vector3d position = bodies_.position_at(i, now_);
  cells_->place(i, position);
  old_pairs_.assign(lists_.of(i).begin(), lists_.of(i).end());
  if (ahead_) sources().fetch_lists_of_partners(i);
  for (const std::int32_t index : old_pairs_) {
    const Pair& pair = lists_.pair(index);
    const std::int32_t partner = pair.partner(i);
    if (bodies_.events(partner).first == index) orphans_.push_back(partner);
    lists_.remove(index);
  }
  renew_exit(i);
  const auto candidates = cells_->collect(position, envelopes_->reach(), near_);
  counters_.candidate_tests += candidates.size();
  envelopes_->find_meetings(i, candidates, 0, meetings_);
  for (const auto& [k, normal] : meetings_) lists_.add(i, k, normal);
  fetch_partners(i);
  queue_all_of(i, kNoPair);
  predict_queued();
  reschedule_orphans();
  reschedule(i);
}

/// Nothing allocates from here on, but for records that a long run breaks.
template <class Bodies>
void EventLoop<Bodies>::reserve_for_events() {
  const std::size_t longest = lists_.reserve();
  old_pairs_.reserve(longest);
  meetings_.reserve(longest);
  // Candidates are two to three times as many as neighbours.
  near_.resize(std::max(near_.size(), 2 * longest + kCandidatesReserved));
  // Of an event every pair of two bodies, or all that a body had and all that it gets.
  queue_.reserve(2 * longest);
  orphans_.reserve(2 * longest);
}

template <class Bodies>
void EventLoop<Bodies>::rebuild_all() {
  lists_ = NeighbourLists(number());
  // The cells shrink with the box between two calls of this, but what they must cover does not.
  cells_.emplace(number(), box_, envelopes_->reach() / envelopes_->least_scale(), options_.batches);
  list_scale_ = 1;
  for (int i = 0; i < number(); ++i) {
    bodies_.move(i, now_);
    wrap(i);
    envelopes_->place(i, bodies_, now_);
    cells_->place(i, bodies_.position_at(i, now_));
    renew_exit(i);
  }
  for (int i = 0; i < number(); ++i) {
    const auto candidates = cells_->collect(bodies_.position_at(i, now_), envelopes_->reach(), near_);
    envelopes_->find_meetings(i, candidates, i + 1, meetings_);
    for (const auto& [k, normal] : meetings_) lists_.add(i, k, normal);
  }
  predict_all();
  reserve_for_events();
  for (int i = 0; i < number(); ++i) reschedule(i);
}

// ---- Events --------------------------------------------------------------------------------------------------------

template <class Bodies>
bool EventLoop<Bodies>::run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) {
  const std::uint64_t last = counters_.collisions + std::min(max_collisions, ~std::uint64_t{0} - counters_.collisions);
  const std::uint64_t events_between_looks = kStallEvents * static_cast<std::uint64_t>(number());
  std::uint64_t events_left = max_events;
  while (counters_.collisions < last && !stall_) {
    const double local_end = time - epochs_ * epoch_;
    const double next = calendar_.earliest_time();
    if (next > std::min(local_end, epoch_)) {
      if (local_end <= epoch_) {
        now_ = std::max(now_, local_end);
        return true;
      }
      start_epoch();
      continue;
    }
    // Not before: without events left, too, the end is reached.
    if (events_left-- == 0) return false;
    process_next();
    if (++events_ >= events_between_looks) [[unlikely]]
      look_for_stall(std::min(local_end, epoch_));
  }
  return false;
}

template <class Bodies>
void EventLoop<Bodies>::start_epoch() {
  now_ = epoch_;
  for (int i = 0; i < number(); ++i) {
    bodies_.move(i, now_);
    bodies_.restart_clock(i, now_);
    bodies_.events(i).exit -= epoch_;
  }
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      Pair& pair = lists_.pair(index);
      if (pair.i == i) pair.time -= epoch_;
    }
  }
  now_ = 0;
  epochs_ += 1;
  for (int i = 0; i < number(); ++i) reschedule(i);
}

template <class Bodies>
void EventLoop<Bodies>::process_next() {
  if (ahead_) ahead_->step(sources(), now_);
  const int body = calendar_.earliest();
  now_ = std::max(now_, calendar_.earliest_time());
  const std::int32_t index = bodies_.events(body).first;
  if (index == kExit) {
    process_exit(body);
  } else if (lists_.pair(index).event == PairEvent::bound) {
    refine(index);
  } else {
    process_contact(index);
  }
}

template <class Bodies>
void EventLoop<Bodies>::process_exit(int i) {
  fetch_pairs(i);
  renew_exit(i);
  if (bodies_.events(i).exit - now_ < envelopes_->worthwhile(i, bodies_)) {
    rebuild(i);
    return;
  }
  // Still inside: pairs that were clear up to the earlier bound are looked at again.
  for (const std::int32_t index : lists_.of(i)) {
    if (lists_.pair(index).event == PairEvent::clear) queue(index, i);
  }
  predict_queued();
  reschedule_orphans();
  reschedule(i);
}

template <class Bodies>
void EventLoop<Bodies>::refine(std::int32_t index) {
  const auto search_evaluations = [this] { return finder_.evaluations - finder_.newton_evaluations; };
  const std::uint64_t before = search_evaluations();
  const int owner = lists_.pair(index).owner;
  fetch_pairs(owner);
  predict(index, owner, kSecondLook);
  counters_.refinements += search_evaluations() - before;
  reschedule(owner);
}

template <class Bodies>
void EventLoop<Bodies>::process_contact(std::int32_t index) {
  Pair& pair = lists_.pair(index);
  const int i = pair.i;
  const int j = pair.j;
  fetch_pairs(i);
  fetch_pairs(j);
  bodies_.move(i, now_);
  bodies_.move(j, now_);
  const Vector3d r = between(pair);
  const double J = bodies_.collide(i, j, r, pair.normal, now_);
  if (!(J > 0)) {
    // Nothing has changed, so that the same contact would be found again: look when the bodies have moved a little.
    ++counters_.parting_contacts;
    pair.event = PairEvent::bound;
    pair.time = now_ + kPartingLook * parting_time(pair);
    reschedule(pair.owner);
    return;
  }
  ++counters_.collisions;
  ++collisions_of_[at(i)];
  ++collisions_of_[at(j)];
  virial_ += J * r.dot(pair.normal);
  virial_tensor_ += r * (J * pair.normal).transpose();
  if (collisions_.size() < collisions_wanted_) collisions_.push_back({time(), std::min(i, j), std::max(i, j)});
  fetch_partners(i);
  fetch_partners(j);
  renew_exit(i);
  renew_exit(j);
  queue_all_of(i, kNoPair);
  queue_all_of(j, index);
  predict_queued();
  reschedule_orphans();
  reschedule(i);
  reschedule(j);
}

// ---- Compression ---------------------------------------------------------------------------------------------------

template <class Bodies>
double EventLoop<Bodies>::shrink_box(double target_box, double least_gain) {
  if (list_scale_ <= 0.9 * envelopes_->least_scale() + 0.1) set_envelope(0, true);
  for (int i = 0; i < number(); ++i) bodies_.move(i, now_);
  double factor = std::max({target_box / box_, envelopes_->least_scale() / list_scale_,
                            smallest_image_box(bodies_.bounding_radius()) / box_});
  factor = std::min(factor, 1.0);
  if (1 - factor < least_gain) return box_;
  // The last step may be small, however large the usual one is.
  least_gain = std::min(least_gain, 0.5 * (1 - target_box / box_));
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      const Pair& pair = lists_.pair(index);
      if (pair.i == i) {
        const double scale = bodies_.contact_scale(i, pair.j, between(pair), pair.normal, now_, factor);
        factor = std::max(factor, scale);
      }
      if (1 - factor < least_gain) return box_;
    }
  }
  // A tenth of the closest pair's gap is left: bodies that roll on each other in small hops would otherwise be squeezed
  // into ever smaller ones.
  if (factor * box_ > target_box) factor += 0.1 * (1 - factor);
  if (!(factor < 1)) return box_;
  box_ *= factor;
  list_scale_ *= factor;
  bodies_.scale_positions(factor, now_);
  envelopes_->scale(factor);
  cells_->scale(factor);
  for (int i = 0; i < number(); ++i) renew_exit(i);
  predict_all();
  for (int i = 0; i < number(); ++i) reschedule(i);
  return box_;
}

template class EventLoop<UniaxialBodies>;
template class EventLoop<GeneralBodies>;

}  // namespace ed::internal
