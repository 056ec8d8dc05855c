#pragma once

/// Every tolerance of libgeom, with the inequality it enters and its unit.

namespace geom {

/// Pose: |R^T R - 1| (largest entry) or | |q| - 1 | <= kPoseTolerance, else the orientation is refused. Dimensionless.
inline constexpr double kPoseTolerance = 1e-6;

/// Ellipsoid: kMinSemiAxis <= semi-axis <= kMaxSemiAxis. Length, in the user's unit; sixth powers, the determinants of
/// matrices of squares, neither underflow nor overflow.
inline constexpr double kMinSemiAxis = 1e-50;
inline constexpr double kMaxSemiAxis = 1e50;

/// Ellipsoid: amax / amin <= kMaxAspectRatio. Dimensionless. The range in which the kernels are tested.
inline constexpr double kMaxAspectRatio = 1e4;

/// distance: converged when |delta|^2 <= kNormalTolerance2, delta the Newton step of the unit normal. Dimensionless.
/// The step is still applied, and convergence is quadratic: the normal is then right to 1e-12 or to rounding.
inline constexpr double kNormalTolerance2 = 1e-12;

/// distance: a step is shortened when g falls by more than kRoundingFactor * (|n.r| + hA + hB). Dimensionless.
inline constexpr double kRoundingFactor = 16 * 2.3e-16;

/// Longest Newton step of the unit normal (radian, nearly); longer ones are scaled to it.
inline constexpr double kMaxNormalStep = 0.6;

/// Newton's matrix, where it is definite by theory (g > -(rhoA + rhoB)): smallest eigenvalue kept >=
/// kLeastEigenvalue * (rhoA + rhoB), against a division by zero only. Dimensionless.
inline constexpr double kLeastEigenvalue = 1e-6;

/// By what a step that lowers g is shortened. Dimensionless.
inline constexpr double kBacktrack = 0.35;

/// distance: at most this many evaluations of g before the fallback.
inline constexpr int kMaxIterations = 60;

}  // namespace geom
