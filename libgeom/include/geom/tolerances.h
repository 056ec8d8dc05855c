#pragma once

/// @file
/// Tolerances of libgeom that matter to users, with the inequality each enters and its unit. Constants of a single
/// algorithm are defined next to it.

namespace geom {

/// Pose: an orientation is refused unless |R^T R - 1| (largest entry) or | |q| - 1 | <= kPoseTolerance. Dimensionless.
inline constexpr double kPoseTolerance = 1e-6;

/// Pose::nearest_rotation: a matrix is refused unless |R^T R - 1| (largest entry) <= kNearestRotationTolerance.
/// Dimensionless. Products of 10,000 rotations in single precision stay within a tenth of it.
inline constexpr double kNearestRotationTolerance = 1e-2;

/// Pose: a position is refused unless |coordinate| <= kMaxCoordinate; queries decline points beyond. Length, in the
/// user's unit. Squares of such lengths do not overflow, nor do squares of their ratios to kMinSemiAxis.
inline constexpr double kMaxCoordinate = 1e100;

/// Ellipsoid, Superellipsoid: kMinSemiAxis <= semi-axis <= kMaxSemiAxis. Length, in the user's unit. Sixth powers, the
/// determinants of matrices of squares, neither underflow nor overflow.
/// @{
inline constexpr double kMinSemiAxis = 1e-50;
inline constexpr double kMaxSemiAxis = 1e50;
/// @}

/// DistanceOptions::start is used if its squared length is above this: a nearly subnormal vector has lost the digits
/// that make start / |start| a unit vector. Square of the start's unit.
inline constexpr double kLeastStart2 = 1e-290;

/// Ellipsoid, Superellipsoid: amax / amin <= kMaxAspectRatio, the range in which the kernels are tested. Dimensionless.
inline constexpr double kMaxAspectRatio = 1e4;

/// Superellipsoid: kMinExponent <= e1, e2 <= kMaxExponent, the range in which the kernels are tested. Dimensionless.
/// @{
inline constexpr double kMinExponent = 0.2;
inline constexpr double kMaxExponent = 1.6;
/// @}

/// distance: converged when |delta|^2 <= kNormalTolerance2, delta the Newton step of the unit normal. Dimensionless.
/// The step is still applied, and convergence is quadratic: the normal is then accurate to 1e-12 or to rounding.
inline constexpr double kNormalTolerance2 = 1e-12;

/// distance of ellipsoids: converged when |delta|^2 <= kChebyshevTolerance2 and the step is Chebyshev's, which
/// converges with the third power of |delta|, and the Newton step in it changes neither support height by more than the
/// fraction kChebyshevSmallChange. Dimensionless. The remaining error, about |delta| times the square of that change,
/// was at most 9e-12 at aspect ratios up to 10, and at larger ones mostly less than that of Newton's steps.
/// @{
inline constexpr double kChebyshevTolerance2 = 2.5e-9;
inline constexpr double kChebyshevSmallChange = 5e-4;
/// @}

/// distance of ellipsoids: Chebyshev's correction is added in full to a Newton step that changes neither support height
/// by more than this fraction, else reduced in proportion. Dimensionless. Of values from 0.2 to 1 this one needs the
/// fewest evaluations.
inline constexpr double kChebyshevChange = 1.0 / 3;

/// distance of ellipsoids: Chebyshev's correction is left out if it changes y.delta, twice the increase of g that
/// Newton's model predicts, by more than this fraction. Dimensionless.
inline constexpr double kChebyshevTrust = 0.9;

/// distance: another Newton step is taken while |y|^2 > kResidualTolerance * size * (g + rhoA + rhoB). Dimensionless:
/// twice the relative error of the distance that remains.
inline constexpr double kResidualTolerance = 2e-15;

/// distance: a step is shortened when g falls by more than kRoundingFactor * (|n.r| + hA + hB). Dimensionless.
inline constexpr double kRoundingFactor = 16 * 2.3e-16;

/// Longest Newton step of the unit normal (radian, nearly); longer ones are scaled to it.
inline constexpr double kMaxNormalStep = 0.6;

/// Normalisation of a vector that is nearly a unit vector: 1 / |v| is computed from its series if |v|^2 - 1 is below
/// this. Dimensionless.
inline constexpr double kInverseSqrtSeries = 2e-3;

/// Newton's matrix: its smallest eigenvalue is kept >= kLeastEigenvalue * (rhoA + rhoB), which prevents a division by
/// zero where the matrix is definite by theory (g > -(rhoA + rhoB)). Dimensionless.
inline constexpr double kLeastEigenvalue = 1e-6;

/// Bodies with flat faces: `separated` when a lower and an upper bound of the distance differ by less than kBoundGap
/// times the sum of both bounding radii. Dimensionless.
inline constexpr double kBoundGap = 1e-12;

/// Bodies with flat faces, if the slow last resort is needed: bound of the same difference; a larger gap is declined.
/// Dimensionless.
inline constexpr double kWidestGap = 1e-9;

/// Penetration::global: no translation is shorter than the one returned by more than kDepthGap times the sum of both
/// bounding radii, proved by branch and bound. Overlaps for which kMostDepthSamples evaluations do not prove
/// kWidestDepthGap are declined. (The same number is spent again if the answer has to be found more accurately.)
/// Dimensionless; not relative to the thickness: for parallel needles 1000 times as long as thick, kWidestDepthGap
/// equals the thickness.
/// @{
inline constexpr double kDepthGap = 1e-9;
inline constexpr double kWidestDepthGap = 1e-3;
inline constexpr int kMostDepthSamples = 100000;
/// Bodies of revolution with nearly parallel axes: after kFewDepthSamples a bound of kRingDepthGap is enough, because
/// many samples more would not halve it where the best normals nearly form a circle.
inline constexpr double kRingDepthGap = 1e-7;
inline constexpr int kFewDepthSamples = 4000;
/// @}

/// distance_lower_bound: lowered by kLowerBoundRounding * (|r| + RA + RB), r the difference of the positions, R the
/// bounding radii. This exceeds the rounding error of the bound: turning n into the body's frame changes a height by
/// the rounding error of n times |s|, which may be R where the height is much less. Support heights are assumed to be
/// accurate to a few ulps of R.
inline constexpr double kLowerBoundRounding = 8 * 2.3e-16;

/// ray_cast: a ray has met the body if the distance is at most kRayGap times (the bounding radius plus the distance of
/// the origin from the body's centre). A far origin is first moved to two radii before the body. Dimensionless.
inline constexpr double kRayGap = 1e-14;

/// ray_cast: a ray misses the body if it does not approach the tangent plane of the closest point by more than
/// rounding: -normal.direction <= kRayApproach, both of unit length.
inline constexpr double kRayApproach = 1e-16;

/// ray_cast: maximum number of closest points.
inline constexpr int kMaxRaySteps = 200;

/// distance, fallback of ellipsoids: Armijo's rule, g grows by at least kArmijo * t * (what the Newton model promises)
/// over a step of length t. Dimensionless.
inline constexpr double kArmijo = 1e-4;

/// distance, fallback of ellipsoids: maximum number of Newton steps; none is halved to less than kLeastArmijoStep of
/// its length.
/// @{
inline constexpr int kMaxArmijoSteps = 200;
inline constexpr double kLeastArmijoStep = 1e-12;
/// @}

/// Newton's matrix of shapes without a `min_curvature_radius`: its smallest eigenvalue is kept >= kLeastCurvature times
/// the sum of both inscribed radii, see kLeastEigenvalue. Dimensionless.
inline constexpr double kLeastCurvature = 2e-3;

/// distance: factor by which a step that lowers g is shortened. Dimensionless.
inline constexpr double kBacktrack = 0.35;

/// distance: maximum number of evaluations of g before the fallback.
inline constexpr int kMaxIterations = 60;

/// newton_distance: maximum number of evaluations of the equations in each of two attempts.
inline constexpr int kMaxNewtonIterations = 100;

/// newton_distance, second attempt: maximum number of times that a step which does not lower |F| is halved.
inline constexpr int kMaxNewtonHalvings = 8;

/// newton_distance: longer steps are scaled so that the largest coordinate of a step of the points (and of beta |f_x|)
/// is <= kMaxNewtonLength. Relative to |p_AB| + |xA - p_WA| + |xB - p_WB| of the seed, as are the next three.
inline constexpr double kMaxNewtonLength = 0.1;

/// newton_distance: converged when a step <= kNewtonStep. It is still applied, and convergence is quadratic.
inline constexpr double kNewtonStep = 1e-10;

/// newton_distance: also converged when a step <= kNewtonStall is more than half as long as the one before: both are
/// rounding.
inline constexpr double kNewtonStall = 1e-6;

/// newton_distance: the answer is accepted if each point is within kNewtonResidual of its surface, and the two bounds
/// of the distance, from the tangent planes and from the points, differ by no more than that.
inline constexpr double kNewtonResidual = 1e-13;

/// newton_distance: ... and the normals are antiparallel, |nA + nB| <= kNewtonAngle, whose square enters the error.
inline constexpr double kNewtonAngle = 1e-8;

/// distance_derivatives: no derivatives unless `stiffness` > kLeastStiffness times the sum of both bounding radii.
/// Dimensionless.
inline constexpr double kLeastStiffness = 1e-9;

/// distance_derivatives: normal and points belong to a feature (vertex, edge, face, rim, side) if they are within its
/// range by more than kFeatureMargin times the sum of both bounding radii. Dimensionless.
inline constexpr double kFeatureMargin = 1e-9;

/// check_seed: f >= -kMaxSeedDepth |f_x| |x|, x from the body's centre: a seed's point may lie inside its body by this
/// fraction of its distance from the centre. Dimensionless.
inline constexpr double kMaxSeedDepth = 0.1;

}  // namespace geom
