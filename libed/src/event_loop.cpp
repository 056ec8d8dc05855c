#include "event_loop.h"

#include "contact_checks.h"
#include "dilated_envelopes.h"
#include "motion_checks.h"
#include "oriented_envelopes.h"
#include "uniaxial_gauge.h"

#include <geom/distance.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using geom::internal::support_point;

/// Points in time that a pair is looked at when it is predicted, and when it comes up again. One gives a bound that
/// lasts for most pairs; what is left is close, and gets a second look at once.
constexpr int kFirstLook = 1;
constexpr int kSecondLook = 2;

/// While the box shrinks bodies count as leaving their envelopes at this share of the thickness.
constexpr double kShrinkingExit = 0.8;

/// Bodies that overlap and part are looked at again after this share of the time in which they could cross each other.
constexpr double kPartingLook = 1e-3;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

int symmetry_axis(const Species& species) {
  const auto axis = species.shape.symmetry_axis();
  if (!axis) {
    throw std::invalid_argument("semi_axes: three different semi-axes are not available yet; accepted: two equal ones");
  }
  return *axis;
}

geom::Ellipsoid upright(const Species& species) {
  const int axis = symmetry_axis(species);
  const Vector3d& a = species.shape.semi_axes();
  return geom::Ellipsoid({a[(axis + 1) % 3], a[(axis + 2) % 3], a[axis]});
}

UniaxialInertia uniaxial_inertia(const Species& species, int axis) {
  if (!(species.mass > 0) || !std::isfinite(species.mass)) {
    throw std::invalid_argument("mass is not positive; accepted: a positive number");
  }
  const double perpendicular = species.inertia[(axis + 1) % 3];
  if (perpendicular != species.inertia[(axis + 2) % 3]) {
    throw std::invalid_argument(
        "inertia: the two moments across the axis of revolution differ, which is not available yet; accepted: equal "
        "ones");
  }
  if (species.spins) check_inertia(species.inertia);
  if (!(perpendicular > 0) || !std::isfinite(perpendicular)) {
    throw std::invalid_argument("inertia is not positive; accepted: positive moments");
  }
  return {species.mass, perpendicular, species.inertia[axis], species.spins};
}

}  // namespace

EventLoop::EventLoop(const System& system, const SimulationOptions& options)
    : options_(options),
      species_(system.species),
      upright_(upright(system.species)),
      shape_axis_(symmetry_axis(system.species)),
      shape_(species_.shape.semi_axes()[shape_axis_], species_.shape.semi_axes()[(shape_axis_ + 1) % 3]),
      inertia_(uniaxial_inertia(species_, shape_axis_)),
      bounding_radius_(species_.shape.bounding_radius()),
      box_(system.box),
      images_(at(system.size()), Eigen::Vector3i::Zero()),
      lists_(system.size()),
      calendar_(system.size()),
      exits_(at(system.size()), 0.0),
      first_(at(system.size()), kExit) {
  if (!(box_ >= smallest_box(bounding_radius_) * (1 - 1e-12))) {
    std::ostringstream message;
    message << "box: an edge of " << box_ << " is too short for bodies of bounding radius " << bounding_radius_
            << ": a body could meet two images of another; accepted: at least " << smallest_box(bounding_radius_)
            << " (number: at least " << smallest_number(species_.shape, packing_fraction(system))
            << " at this packing fraction)";
    throw std::invalid_argument(message.str());
  }
  check_contact_options(options.contact, species_.shape.inscribed_radius());
  if (options.neighbours == Neighbours::cells) check_cells();
  motions_.resize(at(system.size()));
  frames_.resize(at(system.size()));
  for (int i = 0; i < system.size(); ++i) {
    const Body& body = system.bodies[at(i)];
    AxisMotion& motion = motions_[at(i)];
    BodyFrame& frame = frames_[at(i)];
    const Vector3d u = body.rotation.col(shape_axis_);
    motion.position = body.position;
    motion.velocity = body.velocity;
    motion.time = 0;
    frame.x_axis = body.rotation.col((shape_axis_ + 1) % 3);
    const double spin = body.angular_velocity.dot(u);
    frame.spin = inertia_.spins ? spin : 0;
    set_rotation(inertia_, u, body.angular_velocity - spin * u, motion, frame);
  }
  failures_.reserve(kReasons * kMaxFailuresRecorded);
  set_envelope(options.envelope);
}

void EventLoop::check_cells() const {
  const int cells = CellEnvelopes::cells_along(box_, bounding_radius_);
  if (cells >= CellEnvelopes::kLeastCells) return;
  std::ostringstream message;
  message << "neighbours = \"cells\": only " << cells << " cells of twice the bounding radius " << bounding_radius_
          << " fit along the box's edge of " << box_ << "; accepted: at least " << CellEnvelopes::kLeastCells;
  throw std::invalid_argument(message.str());
}

void EventLoop::set_envelope(double thickness, bool shrinking) {
  // A share of the mean distance of neighbours: a first guess that is within a factor of two of the best.
  if (!(thickness > 0)) thickness = 0.22 * box_ / std::cbrt(static_cast<double>(number()));
  const double thinnest = kThinnestEnvelope * bounding_radius_;
  const double exit_share = shrinking ? kShrinkingExit : 1.0;
  switch (options_.neighbours) {
    case Neighbours::dilated:
      thickness = std::clamp(thickness, thinnest, std::max(thinnest, thickest_envelope(box_, bounding_radius_)));
      envelopes_ =
          std::make_unique<DilatedEnvelopes>(number(), shape_, bounding_radius_ - species_.shape.inscribed_radius(),
                                             bounding_radius_, thickness, exit_share * thickness);
      break;
    case Neighbours::obp:
      thickness = std::min(thickness, thickest_oriented_envelope(shape_, bounding_radius_, box_));
      envelopes_ = std::make_unique<OrientedEnvelopes>(number(), shape_, bounding_radius_, thickness, inertia_.spins);
      break;
    case Neighbours::cells: {
      auto cells = std::make_unique<CellEnvelopes>(number(), box_, bounding_radius_);
      body_cells_ = cells.get();
      envelopes_ = std::move(cells);
      break;
    }
  }
  rebuild_all();
}

Counters EventLoop::counters() const {
  Counters c = counters_;
  c.predictions = finder_.predictions;
  c.evaluations = finder_.evaluations;
  c.kernel_calls = finder_.kernel_calls;
  c.cold_restarts = finder_.cold_restarts;
  c.rescues = finder_.rescues;
  return c;
}

void EventLoop::record_collisions(std::size_t number) {
  collisions_.clear();
  collisions_.reserve(std::min<std::size_t>(number, std::size_t{1} << 20));  // more grow as they come
  collisions_wanted_ = number;
}

// ---- State of the bodies -------------------------------------------------------------------------------------------

void EventLoop::move(int i) {
  advance(inertia_, now_, motions_[at(i)], frames_[at(i)]);
}

Vector3d EventLoop::position_now(int i) const {
  return motions_[at(i)].position_at(now_);
}

void EventLoop::wrap(int i) {
  Vector3d& r = motions_[at(i)].position;
  for (int k = 0; k < 3; ++k) {
    const double boxes = nearest_integer(r[k] / box_);
    if (boxes == 0) continue;
    r[k] -= boxes * box_;
    images_[at(i)][k] += static_cast<int>(boxes);
  }
}

KineticState EventLoop::kinetic() const {
  KineticState state;
  for (int i = 0; i < number(); ++i) {
    const AxisMotion& m = motions_[at(i)];
    const double spin = frames_[at(i)].spin;
    state.translational_energy += 0.5 * inertia_.mass * m.velocity.squaredNorm();
    state.rotational_energy += 0.5 * inertia_.perpendicular * omega_across(m).squaredNorm();
    state.spin_energy += 0.5 * inertia_.axial * spin * spin;
    state.momentum += inertia_.mass * m.velocity;
  }
  state.translational_kT = 2 * state.translational_energy / std::max(1, 3 * number() - 3);
  state.rotational_kT = 2 * state.rotational_energy / (2 * number());
  return state;
}

System EventLoop::system() const {
  System result;
  result.box = box_;
  result.species = species_;
  result.bodies.resize(motions_.size());
  for (int i = 0; i < number(); ++i) {
    const Motion motion = motion_of(i, now_);
    result.bodies[at(i)] = {nearest_image(motion.pose.position(), box_), motion.pose.rotation(), motion.velocity,
                            motion.angular_velocity};
  }
  return result;
}

Motion EventLoop::motion_of(int i, double t) const {
  AxisMotion m = motions_[at(i)];
  BodyFrame f = frames_[at(i)];
  advance(inertia_, t, m, f);
  const Vector3d u = m.axis();
  Eigen::Matrix3d R;
  R.col(shape_axis_) = u;
  R.col((shape_axis_ + 1) % 3) = f.x_axis;
  R.col((shape_axis_ + 2) % 3) = u.cross(f.x_axis);
  return {geom::Pose(R, m.position), m.velocity, omega_across(m) + f.spin * u, species_.inertia, epochs_ * kEpoch + t};
}

void EventLoop::sample(Snapshot& snapshot) const {
  snapshot.time = time();
  snapshot.position.resize(motions_.size());
  snapshot.axis.resize(motions_.size());
  snapshot.phi_lab.resize(motions_.size());
  snapshot.phi_body.resize(motions_.size());
  for (int i = 0; i < number(); ++i) {
    AxisMotion m = motions_[at(i)];
    BodyFrame f = frames_[at(i)];
    advance(inertia_, now_, m, f);
    snapshot.position[at(i)] = m.position + box_ * images_[at(i)].cast<double>();
    snapshot.axis[at(i)] = m.axis();
    snapshot.phi_lab[at(i)] = f.phi_lab;
    snapshot.phi_body[at(i)] = f.phi_body;
  }
}

// ---- Prediction ----------------------------------------------------------------------------------------------------

/// From the centre of i to that of j now, in the image in which they can touch.
Vector3d EventLoop::between(const Pair& pair) const {
  const Vector3d d = position_now(pair.j) - position_now(pair.i);
  return body_cells_ != nullptr ? body_cells_->image_of_cells(pair.i, pair.j, d) : nearest_image(d, box_);
}

Finding EventLoop::find_contact(Pair& pair, double end, int max_evaluations) {
  const AxisMotion& a = motions_[at(pair.i)];
  const AxisMotion& b = motions_[at(pair.j)];
  const Vector3d r = between(pair);
  if (options_.contact.finder == Finder::bracketing) {
    return bracketing_contact({upright_, upright_, a, b, r, now_}, now_, end, options_.contact, pair.normal, finder_,
                              unsolved_);
  }
  if (inertia_.spins) {
    const UniaxialGauge<true> gauge(shape_, a, shape_, b, r, now_, 2 * bounding_radius_);
    return certified_contact(gauge, now_, end, max_evaluations, pair.normal, finder_);
  }
  const UniaxialGauge<false> gauge(shape_, a, shape_, b, r, now_, 2 * bounding_radius_);
  return certified_contact(gauge, now_, end, max_evaluations, pair.normal, finder_);
}

void EventLoop::search(Pair& pair, int max_evaluations) {
  const double end = std::max(now_, std::min(exits_[at(pair.i)], exits_[at(pair.j)]));
  const Finding finding = find_contact(pair, end, max_evaluations);
  if (unsolved_) {
    report(pair, unsolved_->time, FailureReason::distance);
    unsolved_.reset();
  }
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
double EventLoop::parting_time(const Pair& pair) const {
  const AxisMotion& a = motions_[at(pair.i)];
  const AxisMotion& b = motions_[at(pair.j)];
  const double reach = 2 * bounding_radius_;
  return reach / ((b.velocity - a.velocity).norm() + reach * (a.rate + b.rate));
}

void EventLoop::predict(std::int32_t index, int owner, int max_evaluations) {
  Pair& pair = lists_.pair(index);
  const std::int32_t partner = pair.partner(owner);
  if (pair.owner == partner && first_[at(partner)] == index) orphans_.push_back(partner);
  pair.owner = owner;
  search(pair, max_evaluations);
}

void EventLoop::predict_all_of(int body, std::int32_t skip) {
  for (const std::int32_t index : lists_.of(body)) {
    if (index != skip) predict(index, body, kFirstLook);
  }
}

void EventLoop::reschedule(int body) {
  double earliest = exits_[at(body)];
  std::int32_t first = kExit;
  for (const std::int32_t index : lists_.of(body)) {
    const Pair& pair = lists_.pair(index);
    if (pair.owner == body && pair.time < earliest) {
      earliest = pair.time;
      first = index;
    }
  }
  first_[at(body)] = first;
  calendar_.set(body, earliest);
}

void EventLoop::reschedule_orphans() {
  for (const int body : orphans_) reschedule(body);
  orphans_.clear();
}

void EventLoop::report(const Pair& pair, double time, FailureReason reason) {
  std::size_t& recorded = failures_of_[static_cast<std::size_t>(reason)];
  if (recorded == kMaxFailuresRecorded) {
    ++counters_.unrecorded_failures;
    return;
  }
  ++recorded;
  FailedPair& failed = failures_.emplace_back();  // reserved: no allocation
  failed.reason = reason;
  failed.shape_i = failed.shape_j = species_.shape;
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

void EventLoop::renew_exit(int i) {
  ++counters_.envelope_checks;
  exits_[at(i)] = envelopes_->exit_time(i, motions_[at(i)], position_now(i), motions_[at(i)].axis_at(now_), now_, box_);
}

void EventLoop::rebuild(int i) {
  ++counters_.neighbour_rebuilds;
  move(i);
  wrap(i);
  const AxisMotion& motion = motions_[at(i)];
  envelopes_->place(i, motion.position, motion.axis(), frames_[at(i)].x_axis);
  cells_->place(i, motion.position);
  old_pairs_.assign(lists_.of(i).begin(), lists_.of(i).end());
  for (const std::int32_t index : old_pairs_) {
    const Pair& pair = lists_.pair(index);
    const std::int32_t partner = pair.partner(i);
    if (pair.owner == partner && first_[at(partner)] == index) orphans_.push_back(partner);
    lists_.remove(index);
  }
  renew_exit(i);
  const auto candidates = cells_->collect(motion.position, envelopes_->reach(), near_);
  counters_.candidate_tests += candidates.size();
  for (const auto& [k, r] : candidates) {
    Vector3d normal;
    if (k != i && envelopes_->may_meet(i, k, r, normal)) predict(lists_.add(i, k, normal), i, kFirstLook);
  }
  reschedule_orphans();
  reschedule(i);
}

void EventLoop::rebuild_all() {
  lists_ = NeighbourLists(number());
  // The cells shrink with the box between two calls of this, but what they must cover does not.
  cells_.emplace(number(), box_, envelopes_->reach() / envelopes_->least_scale());
  list_scale_ = 1;
  for (int i = 0; i < number(); ++i) {
    move(i);
    wrap(i);
    envelopes_->place(i, motions_[at(i)].position, motions_[at(i)].axis(), frames_[at(i)].x_axis);
    cells_->place(i, motions_[at(i)].position);
    renew_exit(i);
  }
  for (int i = 0; i < number(); ++i) {
    for (const auto& [k, r] : cells_->collect(motions_[at(i)].position, envelopes_->reach(), near_)) {
      Vector3d normal;
      if (k > i && envelopes_->may_meet(i, k, r, normal)) predict(lists_.add(i, k, normal), i, kFirstLook);
    }
  }
  // Nothing allocates from here on, but for records that a long run breaks.
  old_pairs_.reserve(lists_.reserve());
  orphans_.clear();
  for (int i = 0; i < number(); ++i) reschedule(i);
}

// ---- Events --------------------------------------------------------------------------------------------------------

bool EventLoop::run_until(double time, std::uint64_t max_collisions) {
  const std::uint64_t last = counters_.collisions + std::min(max_collisions, ~std::uint64_t{0} - counters_.collisions);
  while (counters_.collisions < last) {
    const double local_end = time - epochs_ * kEpoch;
    const double next = calendar_.earliest_time();
    if (next > std::min(local_end, kEpoch)) {
      if (local_end <= kEpoch) {
        now_ = std::max(now_, local_end);
        return true;
      }
      start_epoch();
      continue;
    }
    process_next();
  }
  return false;
}

void EventLoop::start_epoch() {
  now_ = kEpoch;
  for (int i = 0; i < number(); ++i) {
    move(i);
    motions_[at(i)].time = 0;
    exits_[at(i)] -= kEpoch;
  }
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      Pair& pair = lists_.pair(index);
      if (pair.i == i) pair.time -= kEpoch;
    }
  }
  now_ = 0;
  epochs_ += 1;
  for (int i = 0; i < number(); ++i) reschedule(i);
}

void EventLoop::process_next() {
  const int body = calendar_.earliest();
  now_ = std::max(now_, calendar_.earliest_time());
  const std::int32_t index = first_[at(body)];
  if (index == kExit) {
    process_exit(body);
  } else if (lists_.pair(index).event == PairEvent::bound) {
    refine(index);
  } else {
    process_contact(index);
  }
}

void EventLoop::process_exit(int i) {
  renew_exit(i);
  if (exits_[at(i)] - now_ < envelopes_->worthwhile(motions_[at(i)])) {
    rebuild(i);
    return;
  }
  // Still inside: pairs that were clear up to the earlier bound are looked at again.
  for (const std::int32_t index : lists_.of(i)) {
    if (lists_.pair(index).event == PairEvent::clear) predict(index, i, kFirstLook);
  }
  reschedule_orphans();
  reschedule(i);
}

void EventLoop::refine(std::int32_t index) {
  const auto search_evaluations = [this] { return finder_.evaluations - finder_.newton_evaluations; };
  const std::uint64_t before = search_evaluations();
  const int owner = lists_.pair(index).owner;
  predict(index, owner, kSecondLook);
  counters_.refinements += search_evaluations() - before;
  reschedule(owner);
}

ContactBody EventLoop::contact_body(int i, const Vector3d& normal) const {
  const AxisMotion& m = motions_[at(i)];
  // The impulse of a body of revolution has no moment along the axis: any multiple of the identity with 1/I_perp does.
  return {1 / inertia_.mass, Eigen::Matrix3d::Identity() / inertia_.perpendicular,
          support_point(shape_, m.axis(), normal), m.velocity, omega_across(m)};
}

void EventLoop::process_contact(std::int32_t index) {
  Pair& pair = lists_.pair(index);
  const int i = pair.i;
  const int j = pair.j;
  move(i);
  move(j);
  const Vector3d n = pair.normal;
  ContactBody a = contact_body(i, n);
  ContactBody b = contact_body(j, -n);
  const double J = collide(a, b, n);
  if (!(J > 0)) {
    // Nothing has changed, so that the same contact would be found again: look when the bodies have moved a little.
    ++counters_.parting_contacts;
    pair.event = PairEvent::bound;
    pair.time = now_ + kPartingLook * parting_time(pair);
    reschedule(pair.owner);
    return;
  }
  ++counters_.collisions;
  const Vector3d r = nearest_image(motions_[at(j)].position - motions_[at(i)].position, box_);
  virial_ += J * r.dot(n);
  if (collisions_.size() < collisions_wanted_) collisions_.push_back({time(), std::min(i, j), std::max(i, j)});
  for (const auto& [body, state] : {std::pair<int, const ContactBody&>{i, a}, {j, b}}) {
    AxisMotion& m = motions_[at(body)];
    m.velocity = state.velocity;
    const Vector3d u = m.axis();
    const Vector3d omega = state.angular_velocity - state.angular_velocity.dot(u) * u;
    set_rotation(inertia_, u, omega, m, frames_[at(body)]);
    renew_exit(body);
  }
  predict_all_of(i, -1);
  predict_all_of(j, index);
  reschedule_orphans();
  reschedule(i);
  reschedule(j);
}

// ---- Compression ---------------------------------------------------------------------------------------------------

/// The factor by which r would have to shrink for the pair to touch, from above and no better than `enough`.
///
/// For every n with n.r > 0 the pair is apart for scales above (hA + hB) / n.r = 1 - g / n.r; the best n is near the
/// one that maximises g, which is improved until the pair is out of the question or converged.
double EventLoop::contact_scale(const Pair& pair, double enough) const {
  const AxisMotion& a = motions_[at(pair.i)];
  const AxisMotion& b = motions_[at(pair.j)];
  const Vector3d r = nearest_image(b.position - a.position, box_);
  const Vector3d u_a = a.axis();
  const Vector3d u_b = b.axis();
  Vector3d n = pair.normal.isZero(0) ? geom::internal::cold_normal(shape_, shape_, r, u_a, u_b) : pair.normal;
  double best = 1;
  const auto evaluate = [&](const Vector3d& m) { return evaluate_uniaxial(shape_, shape_, r, u_a, u_b, m); };
  const auto done = [&](const UniaxialEvaluation& e) {
    if (n.dot(r) > 0) best = std::min(best, 1 - e.g / n.dot(r));
    return best <= enough || e.step2 < geom::kNormalTolerance2;
  };
  UniaxialEvaluation e = evaluate(n);
  int budget = geom::kMaxIterations;
  (void)geom::internal::ascend(evaluate, geom::kRoundingFactor * 2 * bounding_radius_, done, budget, n, e);
  return best;
}

double EventLoop::shrink_box(double target_box, double least_gain) {
  if (list_scale_ <= 0.9 * envelopes_->least_scale() + 0.1) set_envelope(0, true);
  for (int i = 0; i < number(); ++i) move(i);
  double factor =
      std::max({target_box / box_, envelopes_->least_scale() / list_scale_, smallest_box(bounding_radius_) / box_});
  factor = std::min(factor, 1.0);
  if (1 - factor < least_gain) return box_;
  // The last step may be small, however large the usual one is.
  least_gain = std::min(least_gain, 0.5 * (1 - target_box / box_));
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      const Pair& pair = lists_.pair(index);
      if (pair.i == i) factor = std::max(factor, contact_scale(pair, factor));
      if (1 - factor < least_gain) return box_;
    }
  }
  // A tenth of the closest pair's gap is left: bodies that roll on each other in small hops would otherwise be squeezed
  // into ever smaller ones.
  if (factor * box_ > target_box) factor += 0.1 * (1 - factor);
  if (!(factor < 1)) return box_;
  box_ *= factor;
  list_scale_ *= factor;
  for (AxisMotion& m : motions_) m.position *= factor;
  envelopes_->scale(factor);
  cells_->scale(factor);
  for (int i = 0; i < number(); ++i) renew_exit(i);
  for (int i = 0; i < number(); ++i) {
    for (const std::int32_t index : lists_.of(i)) {
      if (lists_.pair(index).i == i) predict(index, i, kFirstLook);
    }
  }
  orphans_.clear();
  for (int i = 0; i < number(); ++i) reschedule(i);
  return box_;
}

}  // namespace ed::internal
