#pragma once

/// The state of ellipsoids of revolution, one or several species, and what an event loop asks of them: the fast case.
///
/// What an event loop asks of its bodies is the public interface below; GeneralBodies has the same.

#include "base/large_vector.h"
#include "base/prefetch.h"
#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "motion/axis_motion.h"
#include "vectors/kernels.h"

#include <ed/contact_options.h>
#include <ed/impulse.h>
#include <ed/motion.h>
#include <ed/snapshot.h>
#include <ed/system.h>

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace ed::internal {

/// What the bodies of one species share.
struct UniaxialKind {
  geom::kernel::Spheroid shape;
  geom::Ellipsoid upright;  ///< the shape with its axis of revolution along body z
  int axis;                 ///< of revolution, in the user's body frame
  UniaxialInertia inertia;
  double bounding_radius;
  double inscribed_radius;
};

class UniaxialBodies {
 public:
  /// Whether all species are ellipsoids of revolution about an axis that their inertia shares.
  static bool can_hold(const System& system);

  explicit UniaxialBodies(const System& system);

  int number() const { return static_cast<int>(entries_.size()); }
  double bounding_radius() const { return bounding_radius_; }    ///< the largest
  double inscribed_radius() const { return inscribed_radius_; }  ///< the smallest
  double bounding_radius(int i) const { return kind_of(i).bounding_radius; }

  /// Position of the centre, at any time of the flight.
  Eigen::Vector3d position_at(int i, double t) const { return entries_[at(i)].motion.position_at(t); }
  /// The state of the body is read soon.
  void fetch(int i) const {
    prefetch_line(&entries_[at(i)]);
    prefetch_line(&entries_[at(i)].motion.time);
  }
  /// All that there is of it.
  void fetch_all(int i) const {
    prefetch(entries_[at(i)]);
    prefetch(frames_[at(i)]);
  }
  BodyEvents& events(int i) { return entries_[at(i)].events; }
  const BodyEvents& events(int i) const { return entries_[at(i)].events; }
  const Eigen::Vector3d& velocity(int i) const { return entries_[at(i)].motion.velocity; }
  /// How fast the body turns at the most.
  double angular_speed_bound(int i) const { return entries_[at(i)].motion.rate; }
  Motion motion(int i, double t) const;
  static constexpr bool kSamplesRotations = false;  ///< of a Snapshot
  /// Orientation and the integrals of the angular velocity; not the position.
  void sample(int i, double t, Snapshot& snapshot) const;

  /// Keeps the state at t instead of that of an earlier time.
  void move(int i, double t) {
    AxisMotion& m = entries_[at(i)].motion;
    advance(kind_of(i).inertia, t, m, frames_[at(i)]);
  }
  void shift(int i, const Eigen::Vector3d& by) { entries_[at(i)].motion.position += by; }
  /// Its clock, at `t` now, shows 0; after move(i, t).
  void restart_clock(int i, double /*t*/) { entries_[at(i)].motion.time = 0; }
  void scale_positions(double factor, double /*now*/) {
    for (Entry& entry : entries_) entry.motion.position *= factor;
  }

  /// Searches [now, end] for a contact of i and j, whose centres are r apart now.
  Finding find_contact(int i, int j, const Eigen::Vector3d& r, double now, double end, int max_evaluations,
                       const ContactOptions& options, Eigen::Vector3d& n, FinderCounters& count,
                       std::optional<Unsolved>& unsolved) const;

  /// Two bodies in contact.
  struct Contact {
    ContactBody a;
    ContactBody b;
  };
  /// Returns i and j in contact along n, both moved to that time.
  Contact contact(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& n, double now) const;
  /// Gives i and j the velocities with which they leave the contact.
  void leave(int i, int j, const Contact& contact, double now);
  /// Sets the velocity of the centre from now on.
  void set_velocity(int i, const Eigen::Vector3d& velocity, double now) {
    move(i, now);
    entries_[at(i)].motion.velocity = velocity;
  }

  /// The factor by which r would have to shrink for the pair to touch, from above and no better than `enough`.
  double contact_scale(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& n, double now,
                       double enough) const;

  /// None if pairs are better answered one by one.
  UniaxialKernels kernels(const std::optional<geom::InstructionSet>& batches) const;

  const std::vector<UniaxialKind>& kinds() const { return kinds_; }
  const UniaxialKind& kind_of(int i) const { return kinds_[at(kind_[at(i)])]; }
  bool spins() const { return spins_; }  ///< some body may
  int kind_index(int i) const { return kind_[at(i)]; }
  /// The states; read into bodies of the same kinds.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.entries_, self.frames_);
    expect(archive, self.entries_.size() == self.kind_.size() && self.frames_.size() == self.kind_.size(),
           "the number of bodies");
  }

  const AxisMotion& axis_motion(int i) const { return entries_[at(i)].motion; }
  const BodyFrame& frame(int i) const { return frames_[at(i)]; }

 private:
  /// Of a neighbour without spin two cache lines are read, all but AxisMotion::e0: of large systems, what a collision
  /// costs is the number of lines that it reads.
  struct alignas(64) Entry {
    BodyEvents events;
    AxisMotion motion;

    template <class Archive, class Self>
    static void fields(Archive& archive, Self& self) {
      archive(self.events, self.motion);
    }
  };
  static_assert(sizeof(BodyEvents) + offsetof(AxisMotion, e0) == 128);

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  std::vector<UniaxialKind> kinds_;
  std::vector<int> kind_;
  LargeVector<Entry> entries_;
  LargeVector<BodyFrame> frames_;
  double bounding_radius_ = 0;
  double inscribed_radius_ = kNever;
  bool spins_ = false;
};

}  // namespace ed::internal
