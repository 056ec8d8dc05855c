#pragma once

#include <ed/contact_options.h>
#include <ed/export.h>
#include <ed/motion.h>
#include <ed/shape.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <limits>

namespace ed {

/// Outcome of a contact search.
enum class ContactStatus {
  hit,          ///< the bodies touch at `time`, approaching, and not before
  separated,    ///< no contact up to `time` = t_max; certified by Finder::certified, not found by Finder::bracketing
  overlapping,  ///< the bodies overlap at `time` by more than kOverlap times the sum of their bounding radii
  /// ContactOptions::max_evaluations are used up. `time` is a lower bound of the time of contact, if there is one,
  /// certified in the same sense as `separated`. To continue, search again from the motions at that time (propagate).
  budget_exhausted,
  /// No method can decide whether the bodies overlap at `time`; no contact before, in the same sense as `separated`.
  failed,
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(ContactStatus status);

/// Answer of a contact search; `point` and `normal` are NaN unless it is a hit.
struct [[nodiscard]] ContactResult {
  ContactStatus status = ContactStatus::failed;
  double time = std::numeric_limits<double>::quiet_NaN();
  /// Contact point, world frame at `time`.
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit normal from A to B.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  int evaluations = 0;  ///< evaluations of the pair at points in time
  int rescues = 0;      ///< distances that newton8 or newton5 declined and the dual method answered
};

/// Returns the first time in [max of the motions' times, t_max] at which two freely moving bodies touch and approach.
///
/// Certificate: for a direction n the gap g_n(t) = n.r(t) - hA(n, t) - hB(-n, t) is a lower bound of the distance, and
/// over any interval ahead it is bounded below by a function of the motion and of the shapes at n: a parabola for
/// smooth bodies, chords where faces or edges leave it no second derivative. The search advances to the first root of
/// that bound and improves n there; it never steps over a contact, however grazing, and converges quadratically on
/// smooth bodies (docs/time-of-contact.md has the proof). t_max may be infinite.
///
/// Accuracy: for bodies of revolution the distance at the returned time is below 2e-15 times the size of the pair or
/// the rounding error of the time itself. For others it mostly is too; in one of 400,000 trials it was above 1e-13, at
/// the tips of bodies with exponents of 1.6. The time of a head-on contact is accurate to about that distance over the
/// normal velocity, that of a grazing contact to the square root. Never allocates in the search.
///
/// Effort is limited by `options.max_evaluations`: by default a few milliseconds for ellipsoids of revolution, up to 20
/// for other bodies and 100 for a user's own. If this does not suffice, the status is `budget_exhausted`, and `time` a
/// certified lower bound of the time of contact. Bodies that touch without approaching, slide on flat faces or rotate
/// fast without getting nearer take few evaluations: the convex hulls of the regions that they sweep by rotating limit
/// where they may touch. The hulls are exact for ellipsoids of revolution and nearly so for any body that rotates about
/// a fixed axis; a body without two equal moments of inertia that wobbles is assumed to sweep its bounding sphere.
/// Bodies that rotate many times within each other's reach, like meshing wheels, exhaust the budget.
///
/// Bodies: ellipsoids, superellipsoids whose exponents are within [kMinExponentInMotion, kMaxExponentInMotion],
/// spheres, capsules, boxes, polyhedra, cylinders, cones, rounded ones, and a user's own (CustomShape), with any
/// moments of inertia that a body can have. Ellipsoids of revolution about an axis that their moments share are the
/// fast case: about 0.3 microseconds an evaluation instead of one. The bounds of rounding errors hold for
/// superellipsoids with semi-axes from 1/1000 to 1000 units of length. Throws std::invalid_argument for values that are
/// not finite, exponents out of range, inertia that no body can have, speeds that Motion does not allow, and bodies
/// that are beyond geom::kMaxCoordinate when the search begins.
///
/// `options.finder = Finder::bracketing` searches as the paper does instead, without a certificate; its budget of a
/// million distances is not an option.
ED_EXPORT ContactResult time_of_contact(const geom::Ellipsoid& a, const Motion& motion_a, const geom::Ellipsoid& b,
                                        const Motion& motion_b, double t_max, const ContactOptions& options = {});

/// Overload for shapes chosen at run time, and for pairs of unlike kinds.
ED_EXPORT ContactResult time_of_contact(const BodyShape& a, const Motion& motion_a, const BodyShape& b,
                                        const Motion& motion_b, double t_max, const ContactOptions& options = {});

}  // namespace ed
