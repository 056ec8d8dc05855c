#pragma once

/// @file
/// Tolerances of libed, with the inequality that each enters and its unit. "size" is the sum of both bounding radii.

namespace ed {

/// Contact search: the normal is good enough for a step when decrement <= kLooseDecrement * g. Dimensionless. Any
/// normal is valid; a better one gives a longer step, and beyond this the next Newton step costs more than it gains.
inline constexpr double kLooseDecrement = 0.05;

/// Contact search: the normal is converged when decrement <= kTightDecrement * size. Dimensionless.
inline constexpr double kTightDecrement = 2e-17;

/// Contact search: Newton's method on d(t) ends at |d| <= kTouching * size; bodies that touch and do not approach are
/// moved on as long as g falls by no more. Dimensionless; a few times the usual rounding error of g. (Whether bodies
/// touch is decided by the proved bound of that error, libed/src/contact/rounding.h; in the paper's search, by
/// kTouching * size.)
inline constexpr double kTouching = 2e-15;

/// Contact search: bodies that touch approach when g' < -kResting * speed, speed a bound of |g'|. Dimensionless; some
/// tens of rounding errors, so that the impulse's normal velocity has the same sign.
inline constexpr double kResting = 1e-14;

/// Contact search: g < -kOverlap * size is an overlap; a smaller overlap is treated as a contact whose time was rounded
/// (in late collisions of a run, or in a state that was written and read). Dimensionless.
inline constexpr double kOverlap = 1e-12;

/// Contact search: Newton's method on d(t) is tried when the root of the certified parabola and that of its tangent
/// differ by at most kTangentAgreement * size / speed. Dimensionless. Its result is certified independently; this
/// criterion only avoids useless attempts.
inline constexpr double kTangentAgreement = 3e-4;

/// Species: principal moments of inertia >= kLeastMoment * mass * (inscribed radius)^2. Dimensionless. Below, thermal
/// bodies rotate a hundred times while they move by their own size, and nothing is tested. (Moments above mass *
/// (bounding radius)^2 are impossible.)
inline constexpr double kLeastMoment = 1e-4;

/// Superellipsoids in motion: kMinExponentInMotion <= e1, e2 <= kMaxExponentInMotion, the range in which contact
/// searches are tested. Flatter faces lose support points and their curvature to rounding. Dimensionless.
/// @{
inline constexpr double kMinExponentInMotion = 0.25;
inline constexpr double kMaxExponentInMotion = 1.6;
/// @}

/// Motion: |velocity| and |angular velocity| are 0 or within [kMinSpeed, kMaxSpeed]; System: the largest of each is 0
/// or at least kMinSpeed, none is above kMaxSpeed. Length per time and radian per time, in the user's units. Squares of
/// such speeds, and of their products with positions up to geom::kMaxCoordinate, neither underflow nor overflow.
/// @{
inline constexpr double kMinSpeed = 1e-50;
inline constexpr double kMaxSpeed = 1e50;
/// @}

}  // namespace ed
