/// The Perram-Wertheim contact function and the fallback of distance() that rests on it.

#include "common/geom/expect.h"
#include "common/geom/manufactured.h"

#include <geom/kernel/perram_wertheim.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::answers;
using geom_test::declined;
using geom_test::distance_tolerance;
using geom_test::lower_bound;
using geom_test::ManufacturedPair;
using geom_test::normal_tolerance;
using geom_test::Random;
using geom_test::repetitions;

Matrix3d support_matrix(const Ellipsoid& shape, const Pose& X) {
  return X.rotation() * shape.semi_axes().cwiseAbs2().asDiagonal() * X.rotation().transpose();
}

ContactFunction contact_function(const Ellipsoid& a, const Ellipsoid& b, const ManufacturedPair& pair) {
  return perram_wertheim(support_matrix(a, pair.X_WA), support_matrix(b, pair.X_WB),
                         pair.X_WB.position() - pair.X_WA.position());
}

/// Any of the shapes that libgeom is for: half of them of revolution.
Ellipsoid any_ellipsoid(Random& random, double ratio) {
  if (random.coin()) return random.spheroid(random.log_uniform(1 / ratio, ratio));
  return random.biaxial(ratio);
}

TEST(ContactFunction, OfSpheresIsTheSquareOfTheScaledDistance) {
  for (const double centres : {0.1, 1.0, 3.0, 10.0}) {
    const ContactFunction c =
        perram_wertheim(1.0 * Matrix3d::Identity(), 4.0 * Matrix3d::Identity(), Vector3d(0, centres, 0));
    EXPECT_NEAR(c.F, centres * centres / 9, 1e-14 * centres * centres);
    EXPECT_NEAR(c.lambda, 1.0 / 3, 1e-12);  // a / (a + b); found by Newton's method, right to its last step
    EXPECT_LE((c.normal - Vector3d::UnitY()).norm(), 1e-15);
  }
}

TEST(ContactFunction, IsTheMaximumOverLambda) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Ellipsoid a = any_ellipsoid(random, 10);
    const Ellipsoid b = any_ellipsoid(random, 10);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.uniform(-0.5, 2), random);
    const Matrix3d Q_a = support_matrix(a, pair.X_WA);
    const Matrix3d Q_b = support_matrix(b, pair.X_WB);
    const Vector3d r = pair.X_WB.position() - pair.X_WA.position();
    const ContactFunction c = perram_wertheim(Q_a, Q_b, r);
    for (int k = 1; k < 50; ++k) {
      const double lambda = k / 50.0;
      const Vector3d w = ((1 - lambda) * Q_a + lambda * Q_b).inverse() * r;
      // The inverse loses the condition number, at most 100, times some epsilons.
      ASSERT_LE(lambda * (1 - lambda) * r.dot(w), c.F * (1 + 1e-12)) << "pair " << i;
    }
  }
}

TEST(ContactFunction, ScalesWithTheSquareOfTheSeparationAndIsSymmetric) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Ellipsoid a = any_ellipsoid(random, 10);
    const Ellipsoid b = any_ellipsoid(random, 10);
    const ManufacturedPair pair = geom_test::manufacture(a, b, 1, random);
    const Matrix3d Q_a = support_matrix(a, pair.X_WA);
    const Matrix3d Q_b = support_matrix(b, pair.X_WB);
    const Vector3d r = pair.X_WB.position() - pair.X_WA.position();
    const ContactFunction c = perram_wertheim(Q_a, Q_b, r);
    const ContactFunction scaled = perram_wertheim(Q_a, Q_b, 3 * r);
    const ContactFunction swapped = perram_wertheim(Q_b, Q_a, -r);
    // F is stationary in lambda, which is right to about 1e-8 in the flattest cases; the inverse loses 100 epsilons.
    ASSERT_NEAR(scaled.F / 9, c.F, 1e-12 * c.F) << "pair " << i;
    ASSERT_NEAR(swapped.F, c.F, 1e-12 * c.F) << "pair " << i;
    ASSERT_NEAR(swapped.lambda, 1 - c.lambda, 1e-7) << "pair " << i;
    ASSERT_LE((swapped.normal + c.normal).norm(), 1e-6) << "pair " << i;
  }
}

TEST(ContactFunction, ItsNormalProvesTheSeparation) {
  Random random(3);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Ellipsoid a = any_ellipsoid(random, 30);
    const Ellipsoid b = any_ellipsoid(random, 30);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-3, 10), random);
    const ContactFunction c = contact_function(a, b, pair);
    ASSERT_GT(c.F, 1) << "pair " << i;
    const double heights = a.support(pair.X_WA.rotation().transpose() * c.normal).height +
                           b.support(pair.X_WB.rotation().transpose() * -c.normal).height;
    const double g = lower_bound(a, pair.X_WA, b, pair.X_WB, c.normal);
    // g is not stationary in the normal, which errs with lambda and with the inverse: condition 900 here.
    ASSERT_NEAR(g, (std::sqrt(c.F) - 1) * heights, 1e-9 * pair.size) << "pair " << i;
    ASSERT_GT(g, 0) << "pair " << i;
    ASSERT_LE(g, pair.distance + distance_tolerance(pair.size)) << "pair " << i;
  }
}

TEST(ContactFunction, IsBelowOneForBodiesThatOverlap) {
  Random random(4);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Ellipsoid a = any_ellipsoid(random, 10);
    const Ellipsoid b = any_ellipsoid(random, 10);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const ManufacturedPair pair = geom_test::manufacture(a, b, -rho * random.uniform(0.01, 1), random);
    const ContactFunction c = contact_function(a, b, pair);
    ASSERT_LT(c.F, 1) << "pair " << i;
    ASSERT_GT(c.F, 0) << "pair " << i;
  }
}

TEST(PerramWertheimFallback, GivesTheDistanceOfEverySeparatedPair) {
  Random random(5);
  for (int i = 0; i < repetitions(20'000); ++i) {
    const Ellipsoid a = any_ellipsoid(random, 100);
    const Ellipsoid b = any_ellipsoid(random, 100);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-9, 10), random);
    const DistanceResult fallback = perram_wertheim_distance(a, pair.X_WA, b, pair.X_WB, 0);
    const double extent = pair.X_WA.position().norm() + 2 * pair.size;
    ASSERT_TRUE(answers(fallback, pair.distance, distance_tolerance(pair.size), extent)) << "pair " << i;
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_NEAR(fallback.distance, r.distance, distance_tolerance(pair.size)) << "pair " << i;
    ASSERT_LE((fallback.normal - r.normal).norm(), 2 * normal_tolerance(a, b, pair.distance, pair.size))
        << "pair " << i;
  }
}

TEST(PerramWertheimFallback, AnswersCertifiedOverlapsRightOrDeclinesThem) {
  Random random(6);
  const int kPairs = repetitions(5000);
  int answered = 0;
  for (int i = 0; i < kPairs; ++i) {
    const Ellipsoid a = any_ellipsoid(random, 10);
    const Ellipsoid b = any_ellipsoid(random, 10);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const ManufacturedPair pair = geom_test::manufacture(a, b, -rho * random.uniform(0.01, 0.9), random);
    const DistanceResult r = perram_wertheim_distance(a, pair.X_WA, b, pair.X_WB, 0);
    if (r.status == DistanceStatus::not_converged) {
      ASSERT_TRUE(declined(r)) << "pair " << i;
      continue;
    }
    const double extent = pair.X_WA.position().norm() + 2 * pair.size;
    ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent)) << "pair " << i;
    ++answered;
  }
  EXPECT_EQ(answered, kPairs);  // no guarantee, but what was measured
}

TEST(PerramWertheimFallback, DeclinesWhatIsTooDeepToBeCertified) {
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Ellipsoid a = random.spheroid(random.log_uniform(2, 10));
    const Ellipsoid b = random.spheroid(random.log_uniform(0.1, 0.5));
    const Pose X_WA = random.pose(1.0);
    // Centres closer than the inscribed spheres reach: deeper than both of them, the radii of curvature are less.
    const double closer = 0.1 * (a.inscribed_radius() + b.inscribed_radius());
    const Pose X_WB = random.pose(X_WA.position() + closer * random.direction());
    ASSERT_TRUE(declined(perram_wertheim_distance(a, X_WA, b, X_WB, 7))) << "pair " << i;
    ASSERT_TRUE(declined(perram_wertheim_distance(a, X_WA, b, X_WA, 7))) << "concentric pair " << i;
  }
}

TEST(PerramWertheimFallback, CountsTheIterationsSpentBeforeIt) {
  const Ellipsoid a({1, 2, 3});
  const Pose X_WB = Pose::translation({7, 1, 2});
  const int alone = perram_wertheim_distance(a, Pose(), a, X_WB, 0).iterations;
  EXPECT_GT(alone, 0);
  EXPECT_EQ(perram_wertheim_distance(a, Pose(), a, X_WB, 60).iterations, alone + 60);
  EXPECT_GE(perram_wertheim_distance(a, Pose(), a, Pose(), 60).iterations, 60);
}

}  // namespace
}  // namespace geom::kernel
