/// distance(): analytic cases, degenerate cases, starts, declined answers.

#include "common/geom/expect.h"
#include "common/geom/manufactured.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::answers;
using geom_test::declined;
using geom_test::distance_tolerance;
using geom_test::ManufacturedPair;
using geom_test::normal_tolerance;
using geom_test::Random;
using geom_test::repetitions;

Pose turned_about_y(double angle, const Vector3d& position) {
  return Pose::from_quaternion(std::cos(angle / 2), 0, std::sin(angle / 2), 0, position);
}

double extent_of(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB) {
  return X_WA.position().norm() + X_WB.position().norm() + a.bounding_radius() + b.bounding_radius();
}

testing::AssertionResult answers_pair(const DistanceResult& r, const Ellipsoid& a, const Ellipsoid& b,
                                      const ManufacturedPair& pair) {
  testing::AssertionResult result =
      answers(r, pair.distance, distance_tolerance(pair.size), extent_of(a, pair.X_WA, b, pair.X_WB));
  if (!result) return result;
  const double error = (r.normal - pair.normal).norm();
  if (!(error <= normal_tolerance(a, b, pair.distance, pair.size))) {
    return testing::AssertionFailure() << "normal errs by " << error;
  }
  return result;
}

TEST(Distance, OfSpheresIsThatOfTheCentresLessTheRadii) {
  const Ellipsoid a({1, 1, 1});
  const Ellipsoid b({0.5, 0.5, 0.5});
  Random random(1);
  // From far apart to one within the other: the certified depth of spheres is the sum of their radii, all there is.
  for (const double centres : {1e6, 10.0, 2.0, 1.5 + 1e-12, 1.5, 1.5 - 1e-12, 1.2, 0.4, 1e-3, 1e-9}) {
    const Vector3d n = random.direction();
    const Pose X_WA = random.pose(1.0);
    const Pose X_WB = random.pose(X_WA.position() + centres * n);
    const DistanceResult r = distance(a, X_WA, b, X_WB);
    // Coordinates of at most 2 + centres are subtracted.
    ASSERT_TRUE(answers(r, centres - 1.5, 1e-15 * (4 + centres), 4 + centres)) << centres;
    ASSERT_LE((r.normal - n).norm(), 1e-15 * (4 + centres) / centres) << centres;
    ASSERT_LE((r.point_a - (X_WA.position() + n)).norm(), 2e-15 * (4 + centres) * (1 + 1 / centres)) << centres;
  }
}

TEST(Distance, OfConcentricSpheresIsMinusTheSumOfTheRadii) {
  const Ellipsoid a({1, 1, 1});
  const Ellipsoid b({0.5, 0.5, 0.5});
  const Pose X = Pose::translation({3, -1, 2});
  EXPECT_TRUE(answers(distance(a, X, b, X), -1.5, 1e-14, 5));
  EXPECT_TRUE(answers(distance(a, X, b, X, {.start = {1, 1, 1}}), -1.5, 1e-14, 5));
  EXPECT_LE(distance(a, X, b, X).error_bound, 1e-14);
  // To second order, and whichever way the sum of depth and radii rounds.
  const Ellipsoid thirds({1.0 / 3, 1.0 / 3, 1.0 / 3});
  for (const Ellipsoid& ball : {a, b, thirds, Ellipsoid({0.1, 0.1, 0.1})}) {
    EXPECT_LE(distance(ball, Pose(), thirds, Pose()).error_bound, 1e-14);
  }
}

TEST(Distance, OfCoaxialBodiesIsTheGapOfTheirPoles) {
  const Ellipsoid shapes[] = {Ellipsoid({1, 1, 3}), Ellipsoid({2, 2, 0.3}), Ellipsoid({1, 2, 3}),
                              Ellipsoid({0.8, 1.7, 0.5})};
  for (const Ellipsoid& a : shapes) {
    for (const Ellipsoid& b : shapes) {
      for (const double gap : {5.0, 1e-3, 1e-12, 0.0}) {
        const double centres = a.semi_axes().z() + b.semi_axes().z() + gap;
        const Pose X_WB = Pose::translation({0, 0, centres});
        const DistanceResult r = distance(a, Pose(), b, X_WB);
        // The centres' distance is rounded, and a touch may come out on either side.
        const double size = centres + a.bounding_radius() + b.bounding_radius();
        ASSERT_TRUE(answers(r, gap, 1e-15 * size, size));
        ASSERT_LE((r.normal - Vector3d::UnitZ()).norm(), 1e-14);
        ASSERT_LE((r.point_a - Vector3d(0, 0, a.semi_axes().z())).norm(), 1e-14 * centres);
        ASSERT_LE((r.point_b - Vector3d(0, 0, centres - b.semi_axes().z())).norm(), 1e-14 * centres);
      }
    }
  }
}

TEST(Distance, OfTwoBodiesInAPlaneIsThatOfTheirEllipsesThere) {
  // A needle tilted by 30 degrees above a sphere of radius 1/2, its lowest point straight above the sphere's centre:
  // h(-z)^2 = a^2 cos^2 + b^2 sin^2 of the tilt is its depth below the centre.
  const Ellipsoid needle({1, 1, 3});
  const Ellipsoid sphere({0.5, 0.5, 0.5});
  const double tilt = std::numbers::pi / 6;
  const Pose X_turned = turned_about_y(tilt, Vector3d::Zero());
  const double depth = std::sqrt(9 * 0.75 + 0.25);
  const double aside =
      -(9 - 1) * 0.5 * std::sqrt(0.75) / depth;  // x of the lowest point: (c^2-a^2) sin cos / h, negated
  const double gap = 0.7;
  const Pose X_WA = Pose::translation({aside, 0, 0});
  const Pose X_WB(X_turned.rotation(), {0, 0, 0.5 + gap + depth});
  const DistanceResult r = distance(sphere, X_WA, needle, X_WB);
  EXPECT_TRUE(answers(r, gap, 1e-14, 10));
  EXPECT_LE((r.normal - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LE((r.point_b - Vector3d(aside, 0, 0.5 + gap)).norm(), 1e-12);
}

TEST(Distance, OfTouchingBodiesIsZeroWithinRounding) {
  Random random(2);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const ManufacturedPair pair = geom_test::manufacture(a, b, 0, random);
    ASSERT_TRUE(answers_pair(distance(a, pair.X_WA, b, pair.X_WB), a, b, pair)) << "pair " << i;
  }
}

TEST(Distance, OfConcentricParallelBodiesIsTheSumOfTheShortestAxes) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vector3d axes_a(random.log_uniform(0.1, 1), random.log_uniform(1, 3), random.log_uniform(1, 10));
    const Vector3d axes_b(random.log_uniform(0.1, 1), random.log_uniform(1, 3), random.log_uniform(1, 10));
    const Pose X_WA = random.pose(1.0);
    const DistanceResult r = distance(Ellipsoid(axes_a), X_WA, Ellipsoid(axes_b), X_WA);
    ASSERT_EQ(r.status, DistanceStatus::overlapping);
    ASSERT_NEAR(r.distance, -(axes_a + axes_b).minCoeff(), 1e-14 * (axes_a + axes_b).maxCoeff()) << i;
    ASSERT_LE(r.error_bound, kDepthGap * (X_WA.position().norm() + (axes_a + axes_b).sum()));
  }
}

/// Two needles crossed at a right angle, their centres nearly at one point: along y, the common normal, they overlap by
/// 1.9, and a way out along either of them is longer.
TEST(Distance, OfCrossedNeedlesIsAlongTheCommonNormal) {
  const Ellipsoid needle({1, 1, 5});
  const Pose X_WB = turned_about_y(std::numbers::pi / 2, {0, 0.1, 0});
  // From any start the same: the search is over all normals.
  for (const Vector3d& start : {Vector3d(0, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0), Vector3d(1, 0, 0)}) {
    const DistanceResult r = distance(needle, Pose(), needle, X_WB, {.start = start});
    ASSERT_EQ(r.status, DistanceStatus::overlapping);
    EXPECT_NEAR(r.distance, -1.9, 1e-14);
    EXPECT_NEAR(r.normal.y(), 1, 1e-12);
    EXPECT_LE(r.error_bound, 1e-6);
  }
}

/// The local penetration is the nearest stationary one: from the wrong side, the wrong one.
TEST(Distance, LocalPenetrationDependsOnTheStart) {
  const Ellipsoid needle({1, 1, 5});
  const Pose X_WB = turned_about_y(std::numbers::pi / 2, {0, 0.1, 0});
  const auto local = [&](const Vector3d& start) {
    return distance(needle, Pose(), needle, X_WB, {.start = start, .penetration = Penetration::local});
  };
  EXPECT_NEAR(local({0.1, 1, 0}).distance, -1.9, 1e-14);
  EXPECT_NEAR(local({0.1, -1, 0}).distance, -2.1, 1e-14);
  EXPECT_EQ(local({0.1, -1, 0}).status, DistanceStatus::overlapping);
  EXPECT_EQ(local({0.1, -1, 0}).error_bound, std::numeric_limits<double>::infinity());
}

TEST(Distance, ACertifiedOverlapIsTheShortestTranslationThatPartsTheBodies) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.2, 5)) : random.biaxial(5);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.2, 5)) : random.biaxial(5);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const ManufacturedPair pair = geom_test::manufacture(a, b, -rho * random.uniform(0.01, 0.9), random);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_TRUE(answers_pair(r, a, b, pair)) << "pair " << i;
    const auto moved = [&](const Vector3d& by) {
      return distance(a, pair.X_WA, b, Pose(pair.X_WB.rotation(), pair.X_WB.position() + by));
    };
    ASSERT_NEAR(moved(-r.distance * r.normal).distance, 0, 2 * distance_tolerance(pair.size)) << "pair " << i;
    // No other translation of nearly that length parts them.
    for (int k = 0; k < 20; ++k) {
      const DistanceResult still = moved(0.999 * r.distance * random.direction());
      ASSERT_NE(still.status, DistanceStatus::separated) << "pair " << i;
    }
  }
}

TEST(Distance, AWarmStartGivesTheColdAnswer) {
  Random random(5);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-9, 10), random);
    // 0.01 rad or so, and of any length.
    const Vector3d start = random.log_uniform(1e-100, 1e100) * (pair.normal + 0.01 * random.direction());
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB, {.start = start});
    ASSERT_TRUE(answers_pair(r, a, b, pair)) << "pair " << i;
  }
}

TEST(Distance, AnExactWarmStartNeedsOneEvaluation) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const ManufacturedPair pair = geom_test::manufacture(a, a, random.log_uniform(1e-6, 10), random);
    const DistanceResult r = distance(a, pair.X_WA, a, pair.X_WB, {.start = pair.normal, .max_iterations = 1});
    ASSERT_TRUE(answers_pair(r, a, a, pair)) << "pair " << i;
    ASSERT_EQ(r.iterations, 1) << "pair " << i;
  }
}

TEST(Distance, AnyStartGivesTheSameAnswer) {
  Random random(7);
  const Vector3d garbage[] = {{kNaN, 0, 0},      {0, kInfinity, 0}, {kNaN, kNaN, kNaN},  {0, 0, 0},
                              {1e300, 0, 1e300}, {0, 1e-200, 0},    {2e-162, 1e-162, 0}, {0, 0, -1},
                              {1e-145, 0, 0},    {5e-324, 0, 0}};
  for (int i = 0; i < 500; ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-6, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    for (const Vector3d& start : garbage) {
      const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB, {.start = start});
      ASSERT_TRUE(answers_pair(r, a, b, pair)) << "pair " << i << " from " << start.transpose();
    }
    for (const Vector3d& start : {Vector3d(-pair.normal), Vector3d(pair.normal.unitOrthogonal()), random.direction()}) {
      const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB, {.start = start});
      ASSERT_TRUE(answers_pair(r, a, b, pair)) << "pair " << i << " from " << start.transpose();
    }
  }
}

TEST(Distance, SwappedBodiesGiveTheMirroredAnswer) {
  Random random(8);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-6, 10), random);
    const DistanceResult ab = distance(a, pair.X_WA, b, pair.X_WB);
    const DistanceResult ba = distance(b, pair.X_WB, a, pair.X_WA);
    ASSERT_TRUE(answers_pair(ab, a, b, pair)) << "pair " << i;
    ASSERT_EQ(ab.status, ba.status) << "pair " << i;
    ASSERT_NEAR(ab.distance, ba.distance, distance_tolerance(pair.size)) << "pair " << i;
    const double turned = 2 * normal_tolerance(a, b, pair.distance, pair.size);
    ASSERT_LE((ab.normal + ba.normal).norm(), turned) << "pair " << i;
    // A support point moves by the radius of curvature, at most amax^2 / amin <= 100, times the turn of the normal.
    ASSERT_LE((ab.point_a - ba.point_b).norm(), 100 * turned) << "pair " << i;
    ASSERT_LE((ab.point_b - ba.point_a).norm(), 100 * turned) << "pair " << i;
  }
}

TEST(Distance, AnswersAreTheSameBitForBitWhenAskedAgain) {
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const Ellipsoid a = random.biaxial(10);
    const Ellipsoid b = random.spheroid(random.log_uniform(0.1, 10));
    const ManufacturedPair pair = geom_test::manufacture(a, b, 0.3, random);
    const DistanceResult first = distance(a, pair.X_WA, b, pair.X_WB);
    const DistanceResult second = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_EQ(first.distance, second.distance);
    ASSERT_EQ(first.normal, second.normal);
    ASSERT_EQ(first.point_a, second.point_a);
    ASSERT_EQ(first.iterations, second.iterations);
  }
}

TEST(Distance, OneIterationIsNeverAWrongAnswer) {
  Random random(10);
  int answered = 0;
  for (int i = 0; i < repetitions(5000); ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    for (const Vector3d& start : {Vector3d(0, 0, 0), random.direction()}) {
      const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB, {.start = start, .max_iterations = 1});
      if (r.status == DistanceStatus::not_converged) {
        ASSERT_TRUE(declined(r)) << "pair " << i;
        ASSERT_LT(gap, 0) << "pair " << i << " is apart, where the fallback cannot fail";
      } else {
        ASSERT_TRUE(answers_pair(r, a, b, pair)) << "pair " << i;
        ++answered;
      }
    }
  }
  EXPECT_GT(answered, repetitions(5000));  // all that are apart, half of 10000, and the shallow ones of the rest
}

TEST(Distance, LimitsOnIterationsBelowOneCountAsOne) {
  const Ellipsoid a({1, 2, 3});
  const Pose X_WB = Pose::translation({5, 4, 3});
  const DistanceResult wanted = distance(a, Pose(), a, X_WB);
  for (const int limit : {1, 0, -1, std::numeric_limits<int>::min()}) {
    const DistanceResult r = distance(a, Pose(), a, X_WB, {.max_iterations = limit});
    ASSERT_TRUE(answers(r, wanted.distance, 1e-13 * 13, 13)) << limit;
  }
}

TEST(Distance, HugeCoordinatesAreAnswered) {
  const Ellipsoid shapes[] = {Ellipsoid({1, 1, 3}), Ellipsoid({1, 2, 3})};
  for (const Ellipsoid& a : shapes) {
    for (const double far : {1e8, 1e30, 1e60, kMaxCoordinate}) {
      const Pose X_WA = Pose::translation({-far, 0, 0});
      const Pose X_WB = Pose::translation({far, 0, 0});
      const DistanceResult r = distance(a, X_WA, a, X_WB);
      ASSERT_TRUE(answers(r, 2 * far - 2, 1e-13 * far, far)) << far;
    }
  }
}

/// A disc a thousand times flatter than the pair is wide: its radius of curvature is a thousand times the pair's size.
TEST(Distance, ThinDiscsBesideSmallBodiesAreExact) {
  geom_test::Random random(91);
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const double thickness = random.log_uniform(3e-4, 1e-2);
    const Ellipsoid disc({1, 1, thickness});
    const double size = random.log_uniform(1e-6, 0.1);
    const Ellipsoid small({size, size, size * random.log_uniform(0.1, 10)});
    const double gap = random.log_uniform(1e-3, 1);
    const auto pair = geom_test::manufacture(small, disc, gap, random);
    const DistanceResult r = distance(small, pair.X_WA, disc, pair.X_WB);
    ASSERT_EQ(r.status, DistanceStatus::separated);
    worst = std::max(worst, std::abs(r.distance - gap) / pair.size);
  }
  EXPECT_LE(worst, 1e-13);
  // Found by comparing with Newton's method on the paper's equations.
  const Ellipsoid a({1e-9, 1e-9, 27e-9});
  const Ellipsoid b({8.097062272213431e-07, 8.097062272213431e-07, 6.302222260393241e-10});
  const Pose X_WB = Pose::from_quaternion(-0.0507428889856333, -0.35249911080877466, -0.9160836000867449,
                                          0.18428340605850424, {0, 0, -2.1386748627220715e-07});
  EXPECT_NEAR(distance(a, Pose(), b, X_WB).distance, 1.725823320003823e-07, 1e-13 * 1e-6);
}

TEST(Distance, StatusesHaveNames) {
  EXPECT_EQ(std::string(to_string(DistanceStatus::separated)), "separated");
  EXPECT_EQ(std::string(to_string(DistanceStatus::overlapping)), "overlapping");
  EXPECT_EQ(std::string(to_string(DistanceStatus::not_converged)), "not_converged");
  EXPECT_EQ(std::string(to_string(DistanceStatus::singular)), "singular");
}

TEST(Distance, AResultNotYetFilledInIsDeclined) {
  EXPECT_TRUE(declined(DistanceResult()));
}

}  // namespace
}  // namespace geom
