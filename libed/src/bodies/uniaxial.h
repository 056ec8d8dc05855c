#pragma once

/// State of bodies of revolution of one or several species: the fast case of an event loop. They are of one family:
/// ellipsoids and spheres; or rods, which are capsules and spheres; or a mixture of ellipsoids and rods.
///
/// The public interface is what an event loop needs of its bodies; GeneralBodies has the same.

#include "base/large_vector.h"
#include "base/prefetch.h"
#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "contact/bracketing.h"
#include "contact/certified.h"
#include "contact/rods/rod.h"
#include "motion/axis_motion.h"
#include "vectors/kernels.h"

#include <ed/contact_options.h>
#include <ed/impulse.h>
#include <ed/motion.h>
#include <ed/snapshot.h>
#include <ed/system.h>

#include <geom/batch.h>
#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace ed::internal {

/// Pairs of bodies of revolution, by their pair gap: UniaxialGap, RodGap, MixedGap. Of all bodies of a system: the
/// pairs that there may be, `mixed` all three.
enum class UniaxialFamily { spheroids, rods, mixed };

/// Constants of the bodies of one species.
struct UniaxialKind {
  geom::kernel::Spheroid shape;            ///< shape of an ellipsoid, and of a sphere in a mixture
  Rod rod;                                 ///< shape of a rod
  std::optional<geom::Ellipsoid> upright;  ///< ellipsoid or sphere with its axis along body z; nullopt: a capsule
  int axis;                                ///< axis of revolution, in the user's body frame
  UniaxialInertia inertia;
  double bounding_radius;
  double inscribed_radius;
  bool is_rod = false;  ///< whether it is a rod, among spheres or other rods
  bool sphere = false;  ///< a sphere among rods: contacts never turn it, and its rotation is that at 0 of the clock
};

/// Returns the family of a pair. A sphere is a rod beside rods and an ellipsoid beside ellipsoids.
template <class Kind>
UniaxialFamily family_of(const Kind& a, const Kind& b) {
  if (a.is_rod && b.is_rod) return UniaxialFamily::rods;
  const bool capsule = (a.is_rod && !a.sphere) || (b.is_rod && !b.sphere);
  return capsule ? UniaxialFamily::mixed : UniaxialFamily::spheroids;
}

class UniaxialBodies {
 public:
  /// Returns whether all species are ellipsoids of revolution, capsules or spheres, about axes that their inertia
  /// shares.
  static bool can_hold(const System& system);

  explicit UniaxialBodies(const System& system);

  int number() const { return static_cast<int>(entries_.size()); }
  double bounding_radius() const { return bounding_radius_; }    ///< largest of all
  double inscribed_radius() const { return inscribed_radius_; }  ///< smallest of all
  double bounding_radius(int i) const { return kind_of(i).bounding_radius; }

  /// Returns the position of the centre at any time of the flight.
  Eigen::Vector3d position_at(int i, double t) const { return entries_[at(i)].motion.position_at(t); }
  /// Prefetches the state of body i.
  void fetch(int i) const {
    prefetch_line(&entries_[at(i)]);
    prefetch_line(&entries_[at(i)].motion.time);
  }
  /// Prefetches all data of body i.
  void fetch_all(int i) const {
    prefetch(entries_[at(i)]);
    prefetch(frames_[at(i)]);
  }
  BodyEvents& events(int i) { return entries_[at(i)].events; }
  const BodyEvents& events(int i) const { return entries_[at(i)].events; }
  const Eigen::Vector3d& velocity(int i) const { return entries_[at(i)].motion.velocity; }
  /// Returns an upper bound of the angular speed.
  double angular_speed_bound(int i) const { return entries_[at(i)].motion.rate; }
  Motion motion(int i, double t) const;
  static constexpr bool kSamplesRotations = false;  ///< whether sample() sets Snapshot::rotation
  /// Sets orientations, integrals of the angular velocities and velocities in a Snapshot, without positions.
  void sample(double t, Snapshot& snapshot) const;
  /// Returns the time at which the flight of body i has begun.
  double flight_start(int i) const { return entries_[at(i)].motion.time; }

  /// Moves body i to the time t, which is not before that of its state.
  void move(int i, double t) {
    AxisMotion& m = entries_[at(i)].motion;
    const UniaxialKind& kind = kind_of(i);
    if (!kind.sphere) return advance(kind.inertia, t, m, frames_[at(i)]);
    m.position = m.position_at(t);
    m.time = t;
  }
  void shift(int i, const Eigen::Vector3d& by) { entries_[at(i)].motion.position += by; }
  /// Shifts the clock of body i so that it shows 0 at t; after move(i, t).
  void restart_clock(int i, double t) {
    AxisMotion& m = entries_[at(i)].motion;
    if (kind_of(i).sphere) rotate_sphere(i, t);
    m.time = 0;
  }
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

  /// Returns an upper bound of the factor by which r would have to shrink for the pair to touch, no better than needed
  /// to see that it is at most `enough`.
  double contact_scale(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& n, double now,
                       double enough) const;

  /// Returns the vector kernels for the pairs of one family of these bodies; none where one pair at a time is faster.
  FamilyKernels kernels(const std::optional<geom::InstructionSet>& batches, UniaxialFamily pairs) const;
  FamilyKernels kernels(const std::optional<geom::InstructionSet>& batches) const { return kernels(batches, family_); }

  const std::vector<UniaxialKind>& kinds() const { return kinds_; }
  const UniaxialKind& kind_of(int i) const { return kinds_[at(kind_[at(i)])]; }
  bool spins() const { return spins_; }  ///< whether some body may spin
  UniaxialFamily family() const { return family_; }
  bool rods() const { return family_ == UniaxialFamily::rods; }  ///< whether all are rods
  /// Returns the family of the pair.
  UniaxialFamily family_of(int i, int j) const {
    return family_ == UniaxialFamily::mixed ? internal::family_of(kind_of(i), kind_of(j)) : family_;
  }
  /// Returns whether i and j, of rods, are spheres, which meet in closed form.
  bool are_spheres(int i, int j) const { return kind_of(i).sphere && kind_of(j).sphere; }
  bool all_spheres() const;  ///< whether all are spheres among rods
  int kind_index(int i) const { return kind_[at(i)]; }
  /// The states; read into bodies of the same kinds.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.entries_, self.frames_);
    expect(archive, self.entries_.size() == self.kind_.size() && self.frames_.size() == self.kind_.size(),
           "the number of bodies");
  }

  /// Returns the motion of body i. Of spheres among rods the axis means nothing.
  const AxisMotion& axis_motion(int i) const { return entries_[at(i)].motion; }
  /// Returns the axis at time t; across the x_axis of frame(i) if t is that of the state.
  Eigen::Vector3d axis_at(int i, double t) const {
    const AxisMotion& m = entries_[at(i)].motion;
    return kind_of(i).sphere ? m.axis() : m.axis_at(t);
  }
  const BodyFrame& frame(int i) const { return frames_[at(i)]; }

 private:
  /// Returns the motion that a body's rotation is computed from.
  AxisMotion rotation_of(int i) const {
    AxisMotion m = entries_[at(i)].motion;
    if (kind_of(i).sphere) m.time = 0;
    return m;
  }
  /// Does what sample() does for one body.
  void sample(int i, double t, Snapshot& snapshot) const;
  /// Turns a sphere as it turns until the clock shows t.
  void rotate_sphere(int i, double t);

  template <bool kSpin>
  Finding find_contact(int i, int j, const Eigen::Vector3d& r, double now, double end, int max_evaluations,
                       Eigen::Vector3d& n, FinderCounters& count) const;
  /// Searches for a contact of an ellipsoid i and a rod j.
  template <bool kSpin>
  Finding find_mixed_contact(int i, int j, const Eigen::Vector3d& r, double now, double end, int max_evaluations,
                             Eigen::Vector3d& n, FinderCounters& count) const;
  /// Returns the point of a rod's axis that is nearest an ellipsoid, as a multiple of the axis, r from the ellipsoid's
  /// centre, with the normal n from the ellipsoid to the rod.
  double point_beside_spheroid(int rod, int spheroid, const Eigen::Vector3d& r, const Eigen::Vector3d& n) const;
  /// Returns what contact_scale does, of an ellipsoid i and a rod j.
  double mixed_contact_scale(int i, int j, const Eigen::Vector3d& r, const Eigen::Vector3d& start, double now,
                             double enough) const;

  /// Events and motion of a body. Of a neighbour without spin two cache lines are read, all but AxisMotion::e0: in
  /// large systems the cost of a collision is the number of lines that it reads.
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
  UniaxialFamily family_;
};

}  // namespace ed::internal
