#pragma once

#include "bodies/first_looks.h"
#include "bodies/pair.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "loop/parts/epoch_clock.h"
#include "loop/parts/failure_log.h"
#include "loop/parts/neighbourhood.h"
#include "loop/parts/periodic_box.h"

#include <ed/simulation.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace ed::internal {

/// Searches for the contacts of pairs.
///
/// Each pair of neighbours carries a certified lower bound of its contact time, made after the last collision of either
/// body, and is refined only when the calendar comes to it.
template <class Bodies>
class Predictor {
 public:
  /// Number of evaluations when a pair is predicted, and when its bound comes up. One gives a bound that lasts for most
  /// pairs; the others are close, and get a second one at once.
  static constexpr int kFirstLook = 1;
  static constexpr int kSecondLook = 2;

  /// State that predictions depend on, and the places where they are counted and reported. All must outlive the
  /// predictor.
  struct Sources {
    const Bodies& bodies;
    const Neighbourhood<Bodies>& neighbourhood;
    const PeriodicBox& box;
    const EpochClock& clock;
    Counters& counters;
    FailureLog& failures;
  };
  /// `first_looks`: null if pairs are to be looked at one by one. `options` must outlive the predictor.
  Predictor(const Sources& from, const ContactOptions& options, std::unique_ptr<FirstLooks<Bodies>> first_looks)
      : from_(from), options_(options), first_looks_(std::move(first_looks)) {}

  /// Searches for the contact of the pair with up to `max_evaluations` evaluations, and sets its event.
  void search(Pair& pair, int max_evaluations);

  /// Queues the pair for predict_queued().
  void queue(Pair& pair) { queue_.push_back({&pair, search_end(pair)}); }
  /// Predicts all queued pairs. Since they were queued no pair may have been added to the lists or removed, and no body
  /// may have changed.
  void predict_queued();

  /// Sets the next search of a pair whose bodies overlap or touch but do not approach: a little after the time t, when
  /// they have moved.
  void retry_after(double t, Pair& pair) const {
    pair.event = PairEvent::bound;
    pair.time = t + kPartingLook * parting_time(pair);
  }

  bool has_first_looks() const { return first_looks_ != nullptr; }
  /// Uses the kernels of an instruction set from now on; there must be first looks.
  void use(geom::InstructionSet set) { first_looks_->use(from_.bodies, set); }

  const FinderCounters& count() const { return count_; }
  void reserve(std::size_t pairs) { queue_.reserve(pairs); }

  /// Counters of the searches; states hold them apart.
  template <class Self>
  static auto members(Self& self) {
    return std::tie(self.count_);
  }

 private:
  /// Time to the next search of bodies that overlap and part, in units of the time in which they could cross each
  /// other.
  static constexpr double kPartingLook = 1e-3;

  double now() const { return from_.clock.now(); }
  double search_end(const Pair& pair) const {
    return std::max(now(), std::min(from_.bodies.events(pair.i).exit, from_.bodies.events(pair.j).exit));
  }
  void keep(Pair& pair, const Finding& finding);
  double parting_time(const Pair& pair) const;
  void report(const Pair& pair, double time, FailureReason reason);
  Motion motion_of(int body, double t) const;

  Sources from_;
  const ContactOptions& options_;
  std::unique_ptr<FirstLooks<Bodies>> first_looks_;
  std::vector<PairLook> queue_;
  FinderCounters count_;
  std::optional<Unsolved> unsolved_;  ///< set by the last search
};

template <class Bodies>
void Predictor<Bodies>::search(Pair& pair, int max_evaluations) {
  const Finding finding =
      from_.bodies.find_contact(pair.i, pair.j, from_.neighbourhood.between(pair, now()), now(), search_end(pair),
                                max_evaluations, options_, pair.normal, count_, unsolved_);
  if (unsolved_) {
    report(pair, unsolved_->time, FailureReason::distance);
    unsolved_.reset();
  }
  keep(pair, finding);
}

template <class Bodies>
void Predictor<Bodies>::predict_queued() {
  if (first_looks_) first_looks_->take(from_.bodies, now(), from_.box.edge(), queue_, count_);
  for (const PairLook& look : queue_) {
    if (look.answered) {
      keep(*look.pair, look.finding);
    } else {
      search(*look.pair, kFirstLook);
    }
  }
  queue_.clear();
}

template <class Bodies>
void Predictor<Bodies>::keep(Pair& pair, const Finding& finding) {
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
      ++from_.counters.declined;
      report(pair, finding.time, FailureReason::declined);
      retry_after(finding.time, pair);
      break;
    case Outcome::overlapping:
      ++from_.counters.overlaps;
      report(pair, finding.time, FailureReason::overlap);
      // Approaching: let them collide now. Parting: look again when they have moved a little.
      if (finding.approaching) {
        pair.event = PairEvent::contact;
        pair.time = finding.time;
      } else {
        retry_after(finding.time, pair);
      }
      break;
  }
}

/// Returns the least time in which the bodies of a pair can move by the sum of their bounding radii.
template <class Bodies>
double Predictor<Bodies>::parting_time(const Pair& pair) const {
  const Bodies& bodies = from_.bodies;
  const double reach = bodies.bounding_radius(pair.i) + bodies.bounding_radius(pair.j);
  const double speed = (bodies.velocity(pair.j) - bodies.velocity(pair.i)).norm();
  return reach / (speed + reach * (bodies.angular_speed_bound(pair.i) + bodies.angular_speed_bound(pair.j)));
}

template <class Bodies>
Motion Predictor<Bodies>::motion_of(int i, double t) const {
  Motion motion = from_.bodies.motion(i, t);
  motion.time = from_.clock.time_at(t);
  return motion;
}

template <class Bodies>
void Predictor<Bodies>::report(const Pair& pair, double time, FailureReason reason) {
  FailedPair* const failed = from_.failures.add(reason, pair.i, pair.j);
  if (failed == nullptr) {
    ++from_.counters.unrecorded_failures;
    return;
  }
  failed->motion_i = motion_of(pair.i, time);
  failed->motion_j = motion_of(pair.j, time);
  const Eigen::Vector3d r = from_.neighbourhood.between(pair, now()) +
                            (time - now()) * (failed->motion_j.velocity - failed->motion_i.velocity);
  failed->motion_j.pose = geom::Pose(failed->motion_j.pose.rotation(), failed->motion_i.pose.position() + r);
  failed->time = failed->motion_i.time;
  failed->finder = options_.finder;
  failed->eps_d = options_.eps_d;
  if (reason == FailureReason::distance) failed->distance = unsolved_->call;
}

}  // namespace ed::internal
