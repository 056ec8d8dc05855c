#pragma once

/// @file
/// Time of contact of bodies whose motions are given as functions of time.

#include <ed/export.h>
#include <ed/given/motion.h>
#include <ed/shape.h>
#include <ed/time_of_contact.h>

namespace ed {

/// Options of searches on given motions.
struct GivenContactOptions {
  /// Budget, >= 1: number of points in time at which poses are asked for; the last step may be one more. Random motions
  /// take 14 to 32 of them, bodies that slide along each other at a distance d about sqrt(size / d) in the time in
  /// which they move by their size.
  int max_evaluations = 10000;
  /// Distance at which bodies touch, of their size (the sum of both bounding radii), within [1e-14, 1e-3].
  double tolerance = 1e-13;
};

/// Returns the first time in [t_min, t_max] at which two bodies touch; t_max is finite, and the bodies stay within
/// geom::kMaxCoordinate until then.
///
/// Certificate: let f(t) be the gap of both bodies along a direction n that stays, the least height of B along n above
/// the greatest one of A. It is a lower bound of the distance. A point s of A is at the height z(t) = n.x(t), and
/// |z''| <= a + |s| (alpha + omega^2) with the bounds of A's motion; z is below its chord over an interval of length T
/// plus that bound times tau (T - tau) / 2, tau from the interval's beginning, and so is the greatest height of all
/// points. Hence
///
///     f(tau) >= f(0) + (f(T) - f(0)) tau / T - K tau (T - tau) / 2,    K = sum of a + R (alpha + omega^2) of A and B,
///
/// R the bounding radii. Where accelerations are not known, f(tau) >= max(f(0) - V tau, f(T) - V (T - tau)) with V the
/// sum of v + R omega. If n turns uniformly, at the rate w, K grows by 2 w (v + R omega) + w^2 D for each body, D the
/// largest distance of its points from the middle of the closest points; so n turns from the normal at the beginning to
/// that at the end, with edges and faces. The search goes to the first root of the best bound, takes n anew from
/// geom::distance, and repeats: it steps over no contact as long as the bounds hold, apart from rounding. Convergence
/// is quadratic with accelerations, else linear.
///
/// A hit: the distance at `time` is at most options.tolerance of the size, or the rounding of poses if that is more,
/// plus what geom::distance is uncertain by, 1e-12 of the size at most; and it is not certain that the bodies move
/// apart from there. Bodies that touch and move apart, as after a collision, are no hit if the bounds of accelerations
/// tell; where these are infinite, if the bodies part nearly as fast as the bounds of their speeds allow. Other
/// outcomes are those of ContactStatus.
///
/// Exceptions: std::invalid_argument if an option or a time is out of range, or if a motion breaks its bounds at the
/// times that the search looks at: speeds in all builds, accelerations where NDEBUG is not defined. Those of the
/// motions' functions are passed on. Superellipsoids may have any exponents.
ED_EXPORT ContactResult time_of_contact(const BodyShape& a, const GivenMotion& motion_a, const BodyShape& b,
                                        const GivenMotion& motion_b, double t_min, double t_max,
                                        const GivenContactOptions& options = {});

}  // namespace ed
