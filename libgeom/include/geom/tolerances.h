#pragma once

/// @file
/// The tolerances of libgeom that a user meets, with the inequality each enters and its unit. Constants of one
/// algorithm alone stand beside it.

namespace geom {

/// Pose: |R^T R - 1| (largest entry) or | |q| - 1 | <= kPoseTolerance, else the orientation is refused. Dimensionless.
inline constexpr double kPoseTolerance = 1e-6;

/// Pose::nearest_rotation: |R^T R - 1| (largest entry) <= kNearestRotationTolerance, else the matrix is refused.
/// Dimensionless. Products of 10,000 rotations in single precision stay within a tenth of it.
inline constexpr double kNearestRotationTolerance = 1e-2;

/// Pose: |coordinate of the position| <= kMaxCoordinate, else it is refused; queries decline points beyond. Length, in
/// the user's unit: squares do not overflow, nor do those of lengths relative to kMinSemiAxis.
inline constexpr double kMaxCoordinate = 1e100;

/// Ellipsoid, Superellipsoid: kMinSemiAxis <= semi-axis <= kMaxSemiAxis. Length, in the user's unit; sixth powers, the
/// determinants of matrices of squares, neither underflow nor overflow.
/// @{
inline constexpr double kMinSemiAxis = 1e-50;
inline constexpr double kMaxSemiAxis = 1e50;
/// @}

/// DistanceOptions::start is taken if its square is above this: one that is nearly subnormal has lost the digits that
/// make start / |start| a unit vector. Square of the start's unit.
inline constexpr double kLeastStart2 = 1e-290;

/// Ellipsoid, Superellipsoid: amax / amin <= kMaxAspectRatio. Dimensionless. The range in which the kernels are tested.
inline constexpr double kMaxAspectRatio = 1e4;

/// Superellipsoid: kMinExponent <= e1, e2 <= kMaxExponent. Dimensionless. The range in which the kernels are tested.
/// @{
inline constexpr double kMinExponent = 0.2;
inline constexpr double kMaxExponent = 1.6;
/// @}

/// distance: converged when |delta|^2 <= kNormalTolerance2, delta the Newton step of the unit normal. Dimensionless.
/// The step is still applied, and convergence is quadratic: the normal is then right to 1e-12 or to rounding.
inline constexpr double kNormalTolerance2 = 1e-12;

/// distance of ellipsoids: the same where the step is Chebyshev's, which converges with the third power of |delta|, and
/// the Newton step in it changes neither support height by more than the share kChebyshevSmallChange. Dimensionless:
/// the error that is left, about |delta| times the square of that change, was at most 9e-12 at aspect ratios to 10, and
/// at larger ones mostly less than that of Newton's steps.
/// @{
inline constexpr double kChebyshevTolerance2 = 2.5e-9;
inline constexpr double kChebyshevSmallChange = 5e-4;
/// @}

/// distance of ellipsoids: all of Chebyshev's correction is added to a Newton step that changes neither support height
/// by more than this share, else less in proportion. Dimensionless; of 0.2 to 1 it needs the fewest evaluations.
inline constexpr double kChebyshevChange = 1.0 / 3;

/// distance of ellipsoids: none is added where it changes y.delta, twice the increase of g that Newton's model
/// promises, by more than this share. Dimensionless.
inline constexpr double kChebyshevTrust = 0.9;

/// distance: another Newton step is taken while |y|^2 > kResidualTolerance * size * (g + rhoA + rhoB). Dimensionless:
/// twice the relative error of the distance that it leaves.
inline constexpr double kResidualTolerance = 2e-15;

/// distance: a step is shortened when g falls by more than kRoundingFactor * (|n.r| + hA + hB). Dimensionless.
inline constexpr double kRoundingFactor = 16 * 2.3e-16;

/// Longest Newton step of the unit normal (radian, nearly); longer ones are scaled to it.
inline constexpr double kMaxNormalStep = 0.6;

/// Normalising a vector that is nearly a unit one: |v|^2 - 1 below which 1 / |v| is taken from its series.
/// Dimensionless.
inline constexpr double kInverseSqrtSeries = 2e-3;

/// Newton's matrix: smallest eigenvalue kept >= kLeastEigenvalue * (rhoA + rhoB), against a division by zero where it
/// is definite by theory (g > -(rhoA + rhoB)). Dimensionless.
inline constexpr double kLeastEigenvalue = 1e-6;

/// Bodies with flat faces: `separated` when a lower and an upper bound of the distance differ by less than kBoundGap
/// times the sum of both bounding radii. Dimensionless.
inline constexpr double kBoundGap = 1e-12;

/// The same where the slow last resort was needed; a larger gap is declined.
inline constexpr double kWidestGap = 1e-9;

/// Penetration::global: no translation is shorter than the one returned by more than kDepthGap times the sum of both
/// bounding radii, proved by branch and bound; overlaps for which kMostDepthSamples evaluations do not prove
/// kWidestDepthGap are declined. (As many more are spent where the answer has to be found more exactly.) Dimensionless;
/// not relative to the thickness: of parallel needles 1000 times as long as thick kWidestDepthGap is as much as that.
/// @{
inline constexpr double kDepthGap = 1e-9;
inline constexpr double kWidestDepthGap = 1e-3;
inline constexpr int kMostDepthSamples = 100000;
/// @}

/// distance_lower_bound: lowered by kLowerBoundRounding * (|r| + RA + RB), r the difference of the positions, R the
/// bounding radii: above what rounding adds to it. Turning n into the body's frame moves a height by that of n times
/// |s|, which may be R where the height is much less. Support heights are taken to be right to a few ulps of R.
inline constexpr double kLowerBoundRounding = 8 * 2.3e-16;

/// ray_cast: a ray has met the body where the distance is no larger than kRayGap times the bounding radius plus that of
/// the origin from the body's centre; an origin that is far is moved to two radii before the body. Dimensionless.
inline constexpr double kRayGap = 1e-14;

/// ray_cast: a ray misses the body where it does not come closer to the tangent plane of the closest point, by more
/// than rounding: -normal.direction <= kRayApproach, both of unit length.
inline constexpr double kRayApproach = 1e-16;

/// ray_cast: at most this many closest points.
inline constexpr int kMaxRaySteps = 200;

/// distance, fallback of ellipsoids: Armijo's rule, g grows by at least kArmijo * t * (what the Newton model promises)
/// over a step of length t. Dimensionless.
inline constexpr double kArmijo = 1e-4;

/// The same: at most this many Newton steps, none halved to less than kLeastArmijoStep of its length.
/// @{
inline constexpr int kMaxArmijoSteps = 200;
inline constexpr double kLeastArmijoStep = 1e-12;
/// @}

/// Newton's matrix of shapes without a `min_curvature_radius`: as kLeastEigenvalue, with this share of the sum of both
/// inscribed radii in its place. Dimensionless.
inline constexpr double kLeastCurvature = 2e-3;

/// By what a step that lowers g is shortened. Dimensionless.
inline constexpr double kBacktrack = 0.35;

/// distance: at most this many evaluations of g before the fallback.
inline constexpr int kMaxIterations = 60;

/// newton_distance: at most this many evaluations of the equations in each of two attempts.
inline constexpr int kMaxNewtonIterations = 100;

/// newton_distance, second attempt: a step that does not lower |F| is halved at most that often.
inline constexpr int kMaxNewtonHalvings = 8;

/// newton_distance: largest coordinate of a step of the points (and of beta |f_x|) <= kMaxNewtonLength, longer steps
/// are scaled to it. Relative to |p_AB| + |xA - p_WA| + |xB - p_WB| of the seed, as are the next three.
inline constexpr double kMaxNewtonLength = 0.1;

/// newton_distance: converged when a step <= kNewtonStep. It is still applied, and convergence is quadratic.
inline constexpr double kNewtonStep = 1e-10;

/// newton_distance: so also if a step <= kNewtonStall is more than half as long as the one before: both are rounding.
inline constexpr double kNewtonStall = 1e-6;

/// newton_distance: the answer is accepted if either point is within kNewtonResidual of its surface and the two bounds
/// of the distance, that of the tangent planes and that of the points, differ by no more than that.
inline constexpr double kNewtonResidual = 1e-13;

/// newton_distance: ... and the normals are antiparallel, |nA + nB| <= kNewtonAngle. Its square counts.
inline constexpr double kNewtonAngle = 1e-8;

/// check_seed: f >= -kMaxSeedDepth |f_x| |x|, x from the body's centre: a seed's point may lie inside its body by that
/// share of its distance from the centre. Dimensionless.
inline constexpr double kMaxSeedDepth = 0.1;

}  // namespace geom
