#pragma once

/// State of rigid bodies of any shape and moments of inertia, with the interface that an event loop needs
/// (bodies/uniaxial.h).
///
/// Each body's flight is kept as it began after its last collision, so that nothing is computed again while only time
/// passes.

#include "base/large_vector.h"
#include "base/prefetch.h"
#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "contact/pair_gaps.h"
#include "motion/rigid_motion.h"

#include <ed/contact_options.h>
#include <ed/impulse.h>
#include <ed/motion.h>
#include <ed/snapshot.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace ed::internal {

/// Constants of the bodies of one species.
struct GeneralKind {
  GapShape body;
  double bounding_radius;
  double inscribed_radius;
  Eigen::Vector3d half_extents;
  double lever;  ///< turning_lever
  double mass;
  Eigen::Vector3d inertia;
  /// Symmetry axis of shape and inertia, about which contacts have no moment; -1: none.
  int symmetry_axis;
  bool spins;
  bool sphere;  ///< geom::Sphere: pairs of them meet in closed form
  int axis;     ///< body axis that is reported as the body's: symmetry_axis, or z
};

class GeneralBodies {
 public:
  explicit GeneralBodies(const System& system);

  int number() const { return static_cast<int>(motions_.size()); }
  double bounding_radius() const { return bounding_radius_; }    ///< largest of all
  double inscribed_radius() const { return inscribed_radius_; }  ///< smallest of all
  double bounding_radius(int i) const { return kind_of(i).bounding_radius; }
  const std::vector<GeneralKind>& kinds() const { return kinds_; }

  Eigen::Vector3d position_at(int i, double t) const { return motions_[at(i)].position_at(t); }
  /// Prefetches the state of body i.
  void fetch(int i) const {
    prefetch(motions_[at(i)]);
    prefetch(events_[at(i)]);
  }
  /// Prefetches all data of body i.
  void fetch_all(int i) const {
    fetch(i);
    prefetch(turned_[at(i)]);
  }
  BodyEvents& events(int i) { return events_[at(i)]; }
  const BodyEvents& events(int i) const { return events_[at(i)]; }
  const Eigen::Vector3d& velocity(int i) const { return motions_[at(i)].velocity; }
  /// Returns an upper bound of the angular speed.
  double angular_speed_bound(int i) const { return motions_[at(i)].top.max_omega(); }
  Motion motion(int i, double t) const;
  static constexpr bool kSamplesRotations = true;  ///< whether sample() sets Snapshot::rotation
  /// Sets the numbers of all bodies in a Snapshot, without their positions.
  void sample(double t, Snapshot& snapshot) const;
  /// Returns the time at which the flight of body i has begun.
  double flight_start(int i) const { return motions_[at(i)].time; }

  void move(int /*i*/, double /*t*/) {}
  void shift(int i, const Eigen::Vector3d& by) { motions_[at(i)].position += by; }
  /// Shifts the clock of body i so that it shows 0 at t.
  void restart_clock(int i, double t) { motions_[at(i)].time -= t; }
  void scale_positions(double factor, double now);

  /// Searches [now, end] for a contact of i and j, whose centres are r apart now.
  Finding find_contact(int i, int j, const Eigen::Vector3d& r, double now, double end, int max_evaluations,
                       const ContactOptions& options, Eigen::Vector3d& n, FinderCounters& count,
                       std::optional<Unsolved>& unsolved) const;

  /// Two bodies in contact, and what else their motion is made of.
  struct Contact {
    ContactBody a;  ///< angular velocity without spin
    ContactBody b;
    TopState top_a;
    TopState top_b;
    Eigen::Vector3d spin_a;  ///< part of the angular velocity that contacts do not change
    Eigen::Vector3d spin_b;
  };
  /// Returns i and j, r apart, in contact along n now.
  Contact contact(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& n, double now) const;
  /// Gives i and j the velocities with which they leave the contact.
  void leave(int i, int j, const Contact& contact, double now);
  /// Sets the velocity of the centre from now on.
  void set_velocity(int i, const Eigen::Vector3d& velocity, double now);

  /// Returns an upper bound of the factor by which r would have to shrink for the pair to touch, no better than needed
  /// to see that it is at most `enough`.
  double contact_scale(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& n, double now,
                       double enough) const;

  /// The states; read into bodies of the same kinds.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.motions_, self.turned_, self.events_);
    const std::size_t number = self.kind_.size();
    expect(archive, self.motions_.size() == number && self.turned_.size() == number && self.events_.size() == number,
           "the number of bodies");
  }

  const GeneralKind& kind_of(int i) const { return kinds_[at(kind_[at(i)])]; }
  const RigidMotion& rigid_motion(int i) const { return motions_[at(i)]; }
  Eigen::Matrix3d rotation_at(int i, double t) const {
    const RigidMotion& m = motions_[at(i)];
    return m.top.rotation(t - m.time);
  }

 private:
  /// Returns f(gap) with the pair gap of i and j.
  template <class F>
  decltype(auto) with_gap(int i, int j, const Eigen::Vector3d& r, double now, F&& f) const;

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  void start_flight(int i, double now, const TopState& state, const Eigen::Vector3d& velocity,
                    const Eigen::Vector3d& omega);
  TurnedAngles turned_at(int i, double t) const;

  std::vector<GeneralKind> kinds_;
  std::vector<int> kind_;
  LargeVector<RigidMotion> motions_;
  LargeVector<TurnedAngles> turned_;  ///< angles turned up to the start of the flight
  LargeVector<BodyEvents> events_;
  double bounding_radius_ = 0;
  double inscribed_radius_ = kNever;
};

}  // namespace ed::internal
