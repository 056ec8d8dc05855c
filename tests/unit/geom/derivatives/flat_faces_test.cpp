/// Derivatives of bodies that meet with points of no curvature: second derivatives do not exist where both are flat.

#include <geom/derivatives.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

namespace {

using geom::DerivativeStatus;
using geom::DistanceDerivatives;
using geom::Pose;
using geom::Superellipsoid;

void expect_once(const DistanceDerivatives& found) {
  EXPECT_EQ(found.status, DerivativeStatus::once);
  EXPECT_TRUE(found.gradient.allFinite());
  EXPECT_TRUE(found.hessian.array().isNaN().all());
}

TEST(DerivativesOfFlatFaces, ExistOnceWhereSuperellipsoidsRestUpright) {
  for (const double e : {0.2, 0.5, 0.8, 0.99}) {
    SCOPED_TRACE(e);
    const Superellipsoid body({1, 1, 1}, e, e);
    const Pose above = Pose::translation({0.1, 0.2, 1.5});
    expect_once(geom::distance_derivatives(geom::HalfSpace(), Pose(), body, above));
    expect_once(geom::distance_derivatives(geom::Box({3, 3, 0.1}), Pose(), body, above));
    expect_once(geom::distance_derivatives(body, Pose(), body, Pose::translation({0, 0, 2.5})));
  }
}

TEST(DerivativesOfFlatFaces, ExistTwiceBesideASphereAndWhereTheyAreTilted) {
  const Superellipsoid body({1, 1, 1}, 0.5, 0.5);
  const DistanceDerivatives beside =
      geom::distance_derivatives(body, Pose(), geom::Sphere(0.5), Pose::translation({0, 0, 2}));
  EXPECT_EQ(beside.status, DerivativeStatus::twice);
  EXPECT_LT(beside.hessian.block(6, 6, 3, 3).norm(), 1e-6) << "the face is flat";
  const Pose tilted(Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, 2, 0).normalized()).toRotationMatrix(), {0, 0, 1.5});
  EXPECT_EQ(geom::distance_derivatives(geom::HalfSpace(), Pose(), body, tilted).status, DerivativeStatus::twice);
}

}  // namespace
