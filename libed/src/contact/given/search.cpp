#include "contact/given/search.h"

#include "motion/given/point_bounds.h"

#include <ed/tolerances.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using geom::Pose;

constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Roundings of a gap, of the coordinates and of the way during a rounding of the time.
constexpr double kGapRoundings = 16;
/// Overlap, of the size, that no rounding explains once the bodies were apart.
constexpr double kBrokenBounds = 1e-8;
/// Largest ratio of the interval that bounds are about to the step that they allow.
constexpr double kWindow = 8;
/// Largest ratio of a step to what the last one was certain about.
constexpr double kGrowth = 4;
/// Largest number of times that bounds are asked for again for a step.
constexpr int kMostWindows = 12;
#ifdef NDEBUG
constexpr bool kLooksBetween = false;
#else
constexpr bool kLooksBetween = true;
#endif

/// Bounds of the derivatives of a gap.
struct GapBounds {
  double first = 0, second = 0;
};

/// Gap at both ends of an interval, and bounds in between.
struct Chord {
  double from, to, duration;
  GapBounds bounds;

  /// Returns how long the gap is certainly above -depth.
  double clear(double depth) const {
    const double f = from + depth, g = to + depth;
    return std::min(duration, std::max({f / bounds.first, by_speeds(f, g), by_parabola(f, g)}));
  }

 private:
  double by_speeds(double f, double g) const { return f + g >= bounds.first * duration ? duration : 0; }
  double by_parabola(double f, double g) const {
    const double K = bounds.second;
    if (!std::isfinite(K)) return 0;
    const double slope = (g - f) / duration - 0.5 * K * duration;
    const double root2 = slope * slope - 2 * K * f;
    if (slope >= 0 || root2 < 0) return duration;
    return 2 * f / (std::sqrt(root2) - slope);
  }
};

/// Search under way.
class GivenSearch {
 public:
  GivenSearch(const GivenPair& pair, const GivenMotion& a, const GivenMotion& b, const GivenNames& names, double t_max,
              const GivenContactOptions& options)
      : pair_(pair),
        a_(a),
        b_(b),
        names_(names),
        t_max_(t_max),
        options_(options),
        size_(pair.radius_a + pair.radius_b) {}

  ContactResult find(double t_min) {
    look(t_min);
    ask(kGapRoundings * kEps * std::max(1.0, std::abs(t_min)));  // for the rounding of the time
    for (bool begins = true;; begins = false) {
      geom::DistanceOptions distance_options;
      distance_options.start = n_;
      at_ = pair_.distance(X_A_, X_B_, distance_options);
      if (at_.status != geom::DistanceStatus::separated && at_.status != geom::DistanceStatus::overlapping) {
        return ended(ContactStatus::failed);
      }
      n_ = at_.normal;
      const double touching = touching_gap();
      const double deepest = begins ? std::max(kOverlap * size_, touching) : kBrokenBounds * size_ + touching;
      if (at_.distance < -deepest) {
        if (begins) return ended(ContactStatus::overlapping);
        refuse_overlap();
      }
      if (!(time_ < t_max_)) return at_.distance <= touching ? hit() : ended(ContactStatus::separated);
      const std::optional<ContactStatus> outcome = at_.distance <= touching ? part(touching) : step(touching);
      if (outcome) return *outcome == ContactStatus::hit ? hit() : ended(*outcome);
    }
  }

 private:
  /// Moves to a time.
  void look(double t) {
    time_ = t;
    X_A_ = a_.pose(t);
    X_B_ = b_.pose(t);
    ++evaluations_;
  }

  /// Returns the gap at which the bodies touch: the tolerance, or what roundings may be.
  double touching_gap() const {
    const double reach = X_A_.position().cwiseAbs().maxCoeff() + X_B_.position().cwiseAbs().maxCoeff() + size_;
    const double scale = reach + a_.scales().length + b_.scales().length;
    const double clock = std::abs(time_) + a_.scales().time + b_.scales().time;
    return std::max(options_.tolerance * size_, kGapRoundings * kEps * (scale + bounds_.first * clock));
  }

  /// Asks for the bounds over an interval from now.
  void ask(double duration) {
    const double until = duration < t_max_ - time_ ? time_ + duration : t_max_;
    bounds_a_ = a_.bounds(time_, until);
    bounds_b_ = b_.bounds(time_, until);
    points_a_ = PointBounds(bounds_a_, pair_.radius_a);
    points_b_ = PointBounds(bounds_b_, pair_.radius_b);
    bounds_ = {points_a_.speed + points_b_.speed, points_a_.acceleration + points_b_.acceleration};
    asked_ = until - time_;
    if (!std::isfinite(bounds_.first)) refuse_infinite_speeds(names_, time_, until);
  }

  /// Returns the length of the next step, not longer than what the bounds are about.
  double wanted(double gap) const {
    const double K = bounds_.second;
    double duration = 2 * gap / bounds_.first;
    if (std::isfinite(K)) {
      duration = std::max(duration, std::sqrt(8 * gap / K));
      // Twice the time to the root of the last chord, or as long as the chord rises faster than the bound bends it.
      if (approach_ > 0) duration = std::min(duration, 2 * gap / approach_);
      if (approach_ < 0) duration = std::max(duration, -2 * approach_ / K);
    }
    return std::min(asked_, std::max(std::min(duration, limit_), gap / bounds_.first));
  }

  /// Evaluates the gap along n_ after a duration, and moves there. Returns the chord.
  Chord advance(double duration) {
    const Pose X_A = X_A_, X_B = X_B_;
    const double from = time_;
    look(duration < t_max_ - from ? from + duration : t_max_);
    check_bounds(names_.a, "A", bounds_a_, a_, from, X_A, X_A_);
    check_bounds(names_.b, "B", bounds_b_, b_, from, X_B, X_B_);
    const double gap = n_.dot(X_B_.position() - X_A_.position()) - pair_.height_a(X_A_.rotation().transpose() * n_) -
                       pair_.height_b(X_B_.rotation().transpose() * -n_);
    return {at_.distance, gap, time_ - from, bounds_};
  }

  /// Distance where the bodies are, and the chord from `from` to it along a direction that turns from the normal there
  /// to the normal here. Bodies with edges and faces turn them as they get nearer; along a direction that stays, their
  /// gap closes faster than their distance.
  std::optional<Chord> turning(const Chord& stays, const Pose& X_A, const Pose& X_B) {
    geom::DistanceOptions options;
    options.start = n_;
    options.penetration = geom::Penetration::local;
    const geom::DistanceResult there = pair_.distance(X_A_, X_B_, options);
    if (there.status != geom::DistanceStatus::separated && there.status != geom::DistanceStatus::overlapping) {
      return std::nullopt;
    }
    const double turn = 2 * std::asin(std::min(1.0, 0.5 * (there.normal - n_).norm())) / stays.duration;
    const Vector3d centre = 0.5 * (at_.point_a + at_.point_b);
    // z = n.(x - centre): z'' = n''.(x - centre) + 2 n'.x' + n.x'', with |n'| = turn and n'' = -turn^2 n.
    const auto second = [&](const PointBounds& points, const Pose& X, double radius) {
      const double reach = (X.position() - centre).norm() + radius + points.speed * stays.duration;
      return points.acceleration + 2 * turn * points.speed + turn * turn * reach;
    };
    const double K = second(points_a_, X_A, pair_.radius_a) + second(points_b_, X_B, pair_.radius_b);
    return Chord{stays.from, there.distance, stays.duration, {std::numeric_limits<double>::infinity(), K}};
  }

  /// Throws std::invalid_argument if a body has moved more than its bounds allow. `body`: its number in a scene, or -1.
  void check_bounds(std::int64_t body, const char* letter, const MotionBounds& bounds, const GivenMotion& motion,
                    double from, const Pose& X, const Pose& Y) const {
    check_way(names_.function, body, letter, bounds, motion, {from, X}, {time_, Y}, size_);
  }

  /// Advances to the first time at which the bodies may touch, as far as the bounds tell. Returns how the search ends,
  /// if so.
  std::optional<ContactStatus> step(double touching) {
    const double left = t_max_ - time_, gap = at_.distance;
    ask(std::min(left, window_));
    double duration = wanted(gap);
    for (int k = 0; k < kMostWindows && kWindow * duration < asked_; ++k) {
      ask(kWindow * duration);
      duration = wanted(gap);
    }
    window_ = 4 * kWindow * duration;
    if (bounds_.first * asked_ < gap - touching && asked_ >= left) {
      // Bounds alone decide: whether the motions keep them is seen at the end.
      if (evaluations_ < options_.max_evaluations) (void)advance(left);
      time_ = t_max_;
      return ContactStatus::separated;
    }
    if (evaluations_ >= options_.max_evaluations) return ContactStatus::budget_exhausted;
    const double from = time_;
    const Pose X_A = X_A_, X_B = X_B_;
    const Chord chord = advance(duration);
    if (!(chord.duration > 0)) return ContactStatus::hit;  // the clock is too coarse to get nearer
    approach_ = (chord.from - chord.to) / chord.duration;
    double clear = chord.clear(0);
    if (clear < chord.duration && std::isfinite(bounds_.second)) {
      if (const std::optional<Chord> turns = turning(chord, X_A, X_B)) {
        approach_ = std::min(approach_, (turns->from - turns->to) / turns->duration);
        clear = std::max(clear, turns->clear(0));
      }
    }
    if (clear >= chord.duration) {
      limit_ = kGrowth * chord.duration;
      return std::nullopt;
    }
    limit_ = kGrowth * clear;
    const double time = from + clear;
    look(time);
    if (time == from) return ContactStatus::hit;
    return std::nullopt;
  }

  /// Advances bodies that touch to a time at which they are apart, if it is certain that they only move apart until
  /// then. Returns how the search ends, if so.
  std::optional<ContactStatus> part(double touching) {
    const double from = time_;
    const Pose X_A = X_A_, X_B = X_B_;
    double duration = std::min(t_max_ - time_, window_);
    for (;; duration *= 0.25) {
      ask(duration);
      duration = std::min(asked_, size_ / bounds_.first);
      if (bounds_.first * duration < touching) return ContactStatus::hit;
      if (evaluations_ >= options_.max_evaluations) return ContactStatus::budget_exhausted;
      const Chord chord = advance(duration);
      approach_ = (chord.from - chord.to) / chord.duration;
      if (chord.to > 2 * touching && chord.clear(2 * touching) >= chord.duration) return std::nullopt;
      if (const std::optional<Chord> turns = turning(chord, X_A, X_B)) {
        approach_ = std::min(approach_, (turns->from - turns->to) / turns->duration);
        if (turns->to > 2 * touching && turns->clear(2 * touching) >= turns->duration) return std::nullopt;
      }
      time_ = from;
      X_A_ = X_A;
      X_B_ = X_B;
      // The rate at the beginning differs from that of the chord by K T / 2 at most.
      if (approach_ > 0.5 * bounds_.second * chord.duration) return ContactStatus::hit;
    }
  }

  [[noreturn]] void refuse_overlap() const {
    std::ostringstream message;
    message << names_.function << ": a motion breaks its bounds, as the bodies overlap by " << -at_.distance
            << " at time " << time_ << ", before which the bounds exclude a contact";
    throw std::invalid_argument(message.str());
  }

  ContactResult ended(ContactStatus status) const {
    ContactResult result;
    result.status = status;
    result.time = time_;
    result.evaluations = evaluations_;
    return result;
  }
  ContactResult hit() const {
    ContactResult result = ended(ContactStatus::hit);
    result.point = 0.5 * (at_.point_a + at_.point_b);
    result.normal = n_;
    return result;
  }

  const GivenPair& pair_;
  const GivenMotion& a_;
  const GivenMotion& b_;
  const GivenNames& names_;
  double t_max_;
  const GivenContactOptions& options_;
  double size_;
  double time_ = 0;
  Pose X_A_, X_B_;
  Vector3d n_ = Vector3d::Zero();
  geom::DistanceResult at_;
  MotionBounds bounds_a_, bounds_b_;  ///< bounds over [time_, time_ + asked_]
  PointBounds points_a_, points_b_;
  GapBounds bounds_;  ///< last bounds of the gap along a direction that stays
  double asked_ = 0;
  double approach_ = 0;                                     ///< rate of the last chord, towards each other
  double limit_ = std::numeric_limits<double>::infinity();  ///< longest step, by how far the last one got
  double window_ = std::numeric_limits<double>::infinity();
  int evaluations_ = 0;
};

}  // namespace

void check_given(const char* function, const GivenContactOptions& options, double t_min, double t_max) {
  std::ostringstream message;
  if (options.max_evaluations < 1) {
    message << "max_evaluations is " << options.max_evaluations << "; accepted: 1 or more";
  } else if (!(options.tolerance >= 1e-14 && options.tolerance <= 1e-3)) {
    message << "tolerance is " << options.tolerance << "; accepted: 1e-14 to 1e-3";
  } else if (!std::isfinite(t_min) || !std::isfinite(t_max) || t_max < t_min) {
    message << "t_min is " << t_min << " and t_max " << t_max << "; accepted: finite times, t_max no earlier";
  } else if (!std::isfinite(t_max - t_min)) {
    message << "t_min is " << t_min << " and t_max " << t_max << "; accepted: a finite duration";
  } else {
    return;
  }
  throw std::invalid_argument(std::string(function) + ": " + message.str());
}

void check_way(const char* function, std::int64_t body, const char* letter, const MotionBounds& bounds,
               const GivenMotion& motion, const PoseAt& from, const PoseAt& to, double size) {
  MotionScales scales = motion.scales();
  scales.length += size;
  std::string fault = broken_speed(bounds, from.time, from.X, to.time, to.X, scales);
  if (kLooksBetween && fault.empty()) {
    const Pose middle = motion.pose(0.5 * (from.time + to.time));
    fault = broken_acceleration(bounds, from.time, from.X, middle, to.time, to.X, scales);
  }
  if (fault.empty()) return;
  const std::string name = body < 0 ? std::string(letter) : "body " + std::to_string(body);
  throw std::invalid_argument(std::string(function) + ": the motion of " + name + " breaks its bounds: " + fault);
}

void refuse_infinite_speeds(const GivenNames& names, double from, double to) {
  std::ostringstream message;
  message << names.function << ": bounds of speed and angular speed from time " << from << " to " << to
          << " are infinite; accepted: finite ones";
  throw std::invalid_argument(message.str());
}

ContactResult given_contact(const GivenPair& pair, const GivenMotion& motion_a, const GivenMotion& motion_b,
                            const GivenNames& names, double t_min, double t_max, const GivenContactOptions& options) {
  return GivenSearch(pair, motion_a, motion_b, names, t_max, options).find(t_min);
}

}  // namespace ed::internal
