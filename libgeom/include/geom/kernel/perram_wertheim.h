#pragma once

/// Perram-Wertheim contact function of two ellipsoids: a test for separation that cannot fail, and a normal that proves
/// it.

#include <geom/distance.h>

#include <Eigen/Core>

namespace geom::kernel {

struct ContactFunction {
  double F;                ///< > 1: apart, < 1: overlapping; the factor 1/sqrt(F) on r makes the bodies touch
  double lambda;           ///< position of the maximum
  Eigen::Vector3d normal;  ///< unit; if F > 1 then g(normal) = (sqrt(F) - 1)(hA + hB) > 0
};

/// Computes F = max over 0 < lambda < 1 of lambda (1 - lambda) r^T [(1 - lambda) QA + lambda QB]^-1 r, a concave
/// function, by Newton's method safeguarded with bisection (Perram and Wertheim, J. Comput. Phys. 58 (1985) 409).
///
/// Q are the matrices of the support functions h(n) = sqrt(n.Q n), positive definite; r != 0 is the vector between the
/// centres.
GEOM_EXPORT ContactFunction perram_wertheim(const Eigen::Matrix3d& Q_a, const Eigen::Matrix3d& Q_b,
                                            const Eigen::Vector3d& r);

/// Returns the distance of two ellipsoids from the normal of the contact function: the fallback of `distance`. It finds
/// every distance of separated bodies. The contact function proves little about overlaps, and those that end deeper
/// than the certified depth (see distance.h) are declined (not_converged).
GEOM_EXPORT DistanceResult perram_wertheim_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b,
                                                    const Pose& X_WB, int iterations_before);

}  // namespace geom::kernel
