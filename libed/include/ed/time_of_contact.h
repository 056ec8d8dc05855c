#pragma once

#include <ed/contact_options.h>
#include <ed/export.h>
#include <ed/motion.h>
#include <ed/shape.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <limits>

namespace ed {

/// How a contact search ended.
enum class ContactStatus {
  hit,          ///< the bodies touch at `time`, approaching, and not before
  separated,    ///< no contact up to `time` = t_max; certified by Finder::certified, not found by Finder::bracketing
  overlapping,  ///< they overlap at `time` by more than kOverlap times the sum of their bounding radii
  /// ContactOptions::max_evaluations are spent. `time` is a lower bound of the time of contact, if there is one,
  /// certified in the same sense as `separated`. To go on, search again from the motions at that time (propagate).
  budget_exhausted,
  failed,  ///< no method tells whether the bodies overlap at `time`; no contact before, in the same sense as
           ///< `separated`
};

/// The enumerator's name.
ED_EXPORT const char* to_string(ContactStatus status);

/// The answer of a contact search; `point` and `normal` are NaN unless it is a hit.
struct [[nodiscard]] ContactResult {
  ContactStatus status = ContactStatus::failed;
  double time = std::numeric_limits<double>::quiet_NaN();
  /// Where they touch, world frame at `time`.
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit, from A to B.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  int evaluations = 0;  ///< points in time that were looked at
  int rescues = 0;      ///< distances that newton8 or newton5 declined and the dual answered
};

/// The first time in [max of the motions' times, t_max] at which two freely moving bodies touch and approach.
///
/// Certified: for a direction n the gap g_n(t) = n.r(t) - hA(n, t) - hB(-n, t) is a lower bound of the distance, and
/// over any interval ahead it is bounded below by what the motion and the shapes at n tell: a parabola for smooth
/// bodies, chords where faces or edges leave it no second derivative. The search advances to the first root of that
/// bound and improves n there; it never steps over a contact, however grazing, and converges quadratically on smooth
/// bodies (docs/time-of-contact.md has the proof). t_max may be infinite.
///
/// Accuracy: at the returned time the distance is below 2e-15 times the size of the pair or the rounding error of the
/// time itself, for bodies of revolution; for others mostly too, and in one of 400,000 trials it was above 1e-13, at
/// the tips of bodies with exponents of 1.6. The time of a contact met head-on is right to about that over the normal
/// velocity, that of a grazing one to the square root. Never allocates in the search.
///
/// Effort is limited by `options.max_evaluations`: by default a few milliseconds for ellipsoids of revolution, up to 20
/// for other bodies and 100 for a user's own. Where it does not suffice, the status is `budget_exhausted`, and `time` a
/// certified lower bound of the time of contact. Bodies that touch without approaching, slide on flat faces or turn
/// fast without getting nearer take few evaluations: the convex hulls of what they sweep by turning tell where they may
/// meet. The hulls are exact for ellipsoids of revolution and nearly so for any body that turns about a fixed axis; a
/// body without two equal moments of inertia that wobbles is taken to sweep its bounding sphere. Bodies that turn many
/// times within each other's reach, like wheels that mesh, exhaust the budget.
///
/// Bodies: ellipsoids and superellipsoids whose exponents are within [kMinExponentInMotion, kMaxExponentInMotion], and
/// a user's own (CustomShape), with any moments of inertia that a body can have. Ellipsoids of revolution about an axis
/// that their moments share are the fast case: some 0.3 microseconds a point in time instead of one. What rounding may
/// hide is bounded for superellipsoids with semi-axes from 1/1000 to 1000 units of length. Values that are not finite,
/// exponents out of range and inertia that no body can have throw std::invalid_argument.
///
/// `options.finder = Finder::bracketing` searches as the paper does instead, which is no proof; its budget of a million
/// distances is not an option.
ED_EXPORT ContactResult time_of_contact(const geom::Ellipsoid& a, const Motion& motion_a, const geom::Ellipsoid& b,
                                        const Motion& motion_b, double t_max, const ContactOptions& options = {});

/// The same for shapes chosen at run time, and for pairs of unlike kinds.
ED_EXPORT ContactResult time_of_contact(const BodyShape& a, const Motion& motion_a, const BodyShape& b,
                                        const Motion& motion_b, double t_max, const ContactOptions& options = {});

}  // namespace ed
