/// newton_distance(): the Jacobian, both systems, negative distances, statuses, seeds.

#include "common/geom/expect.h"
#include "common/geom/implicit.h"
#include "common/geom/manufactured.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::answers;
using geom_test::declined;
using geom_test::distance_tolerance;
using geom_test::extent_of;
using geom_test::ManufacturedPair;
using geom_test::PowerBody;
using geom_test::Random;
using geom_test::repetitions;
using testing::AllOf;
using testing::HasSubstr;

constexpr NewtonSystem kSystems[] = {NewtonSystem::eight, NewtonSystem::five};

/// The normal of the pair, turned by about `angle` radian.
Vector3d turned(const Vector3d& n, double angle, Random& random) {
  return n + angle * random.direction();
}

Ellipsoid random_ellipsoid(Random& random) {
  return random.coin() ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
}

template <class Equations>
void expect_length_shows_nan() {
  using Step = typename Equations::Vector;
  // alpha, the unknown before the last, is no length.
  for (int k = 0; k < Equations::kSize - 2; ++k) {
    Step step = Step::Ones();
    step[k] = kNaN;
    EXPECT_TRUE(std::isnan(Equations::length(step))) << k;
  }
  EXPECT_EQ(Equations::length(Step::Constant(-2)), 2);
}

TEST(Newton, TheLengthOfAStepThatIsNoNumberIsNone) {
  expect_length_shows_nan<kernel::EightEquations>();
  expect_length_shows_nan<kernel::FiveEquations>();
  kernel::FiveEquations::Vector step = kernel::FiveEquations::Vector::Ones();
  step[4] = kNaN;
  EXPECT_TRUE(std::isnan(kernel::FiveEquations::length(step)));
}

/// The Jacobian against central differences of F, at a state that is no solution.
template <class Equations, class Shape>
void expect_jacobian(const Shape& shape, Random& random) {
  const Pose X_WA = random.pose(0.0);
  const Pose X_WB = random.pose(0.0);
  const kernel::WorldSurface<Shape> a{shape, X_WA.rotation(), 1.5, 0.7};
  const kernel::WorldSurface<Shape> b{shape, X_WB.rotation(), 1.5, 1.3};
  const Vector3d r = 2 * random.direction();
  const kernel::NewtonState y{random.direction(), random.direction(), random.uniform(0.5, 2), random.uniform(-1, 1)};
  const auto at = [&](const kernel::NewtonState& state) { return newton_point<Equations>(a, b, r, state); };
  const auto here = at(y);
  const typename Equations::Matrix J = Equations::jacobian(here.f, here.g, here.y);
  const double h = 1e-6;
  for (int column = 0; column < Equations::kSize; ++column) {
    const typename Equations::Vector step = h * Equations::Vector::Unit(column);
    const typename Equations::Vector slope =
        (at(Equations::moved(y, step)).F - at(Equations::moved(y, -step)).F) / (2 * h);
    // Third derivatives times h^2, and rounding over h.
    const double scale = 1 + J.col(column).norm() + here.F.norm();
    EXPECT_LE((slope - J.col(column)).norm(), 1e-7 * scale) << "column " << column;
  }
}

TEST(Newton, JacobiansAreTheDerivativesOfTheEquations) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Ellipsoid ellipsoid({0.8, 1.1, 1.4});
    expect_jacobian<kernel::EightEquations>(ellipsoid, random);
    expect_jacobian<kernel::FiveEquations>(ellipsoid, random);
    const PowerBody body{{0.8, 1.1, 1.4}, {4, 6, 4}};
    expect_jacobian<kernel::EightEquations>(body, random);
    expect_jacobian<kernel::FiveEquations>(body, random);
  }
}

TEST(Newton, BothSystemsGiveTheDistanceFromANearbyNormal) {
  Random random(2);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Ellipsoid a = random_ellipsoid(random);
    const Ellipsoid b = random_ellipsoid(random);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-9, 10), random);
    const WitnessPair seed = normal_seed(a, pair.X_WA, b, pair.X_WB, turned(pair.normal, 1e-3, random));
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
      ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
      ASSERT_LE((r.normal - pair.normal).norm(), 1e-8) << "pair " << i;
    }
  }
}

TEST(Newton, TheDualsSeedIsConfirmedInAFewEvaluations) {
  Random random(3);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Ellipsoid a = random_ellipsoid(random);
    const Ellipsoid b = random_ellipsoid(random);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const WitnessPair seed = dual_seed(a, pair.X_WA, b, pair.X_WB);
    ASSERT_EQ(seed.status, SeedStatus::usable);
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
      ASSERT_TRUE(answers(r, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
      ASSERT_LE(r.iterations, 4) << "pair " << i;
    }
  }
}

TEST(Newton, SlightOverlapsHaveTheNegativeDistance) {
  Random random(4);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Ellipsoid a = random_ellipsoid(random);
    const Ellipsoid b = random_ellipsoid(random);
    const double depth = random.uniform(0.001, 0.9) * (a.min_curvature_radius() + b.min_curvature_radius());
    const ManufacturedPair pair = geom_test::manufacture(a, b, -depth, random);
    const WitnessPair seed = normal_seed(a, pair.X_WA, b, pair.X_WB, turned(pair.normal, 1e-3, random));
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
      ASSERT_EQ(r.status, DistanceStatus::overlapping) << "pair " << i;
      ASSERT_TRUE(answers(r, -depth, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    }
  }
}

// Deeper than the sum of the smallest radii of curvature there can be several solutions with beta < 0.
TEST(Newton, DeeperOverlapsAreDeclined) {
  Random random(5);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Ellipsoid a = random.spheroid(random.log_uniform(2, 10));
    const Ellipsoid b = random.spheroid(random.log_uniform(0.1, 0.5));
    const double depth = random.uniform(1.01, 1.5) * (a.min_curvature_radius() + b.min_curvature_radius());
    const ManufacturedPair pair = geom_test::manufacture(a, b, -depth, random);
    const WitnessPair seed = normal_seed(a, pair.X_WA, b, pair.X_WB, pair.normal);
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
      if (r.status == DistanceStatus::overlapping) {
        // Another solution, and one that is certified: then it is the largest there is, and better than this one.
        ASSERT_GE(r.distance, -depth);
        ASSERT_LE(-r.distance, (a.min_curvature_radius() + b.min_curvature_radius()) * (1 + 1e-12));
      } else {
        ASSERT_TRUE(declined(r)) << "pair " << i;
      }
    }
  }
}

// The equations hold too where the far sides of the bodies face away from each other, and at mixtures of near and far.
TEST(Newton, SolutionsThatAreNotTheDistanceAreNotReturned) {
  Random random(6);
  int answered = 0;
  for (int i = 0; i < repetitions(3000); ++i) {
    const Ellipsoid a = random_ellipsoid(random);
    const Ellipsoid b = random_ellipsoid(random);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const WitnessPair seed = normal_seed(a, pair.X_WA, b, pair.X_WB, random.direction());
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
      if (r.status == DistanceStatus::separated || r.status == DistanceStatus::overlapping) {
        ASSERT_TRUE(answers(r, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
        ++answered;
      } else {
        ASSERT_TRUE(declined(r)) << "pair " << i;
      }
    }
  }
  EXPECT_GT(answered, 0);
}

TEST(Newton, TheUnitOfLengthDoesNotMatter) {
  for (const double unit : {1e-49, 1e-6, 1.0, 1e6, 1e49}) {
    const Ellipsoid a(unit * Vector3d(1, 1, 3));
    const Ellipsoid b(unit * Vector3d(1, 2, 0.5));
    const Pose X_WA = Pose::from_quaternion(0.6, 0, 0.8, 0);
    const Pose X_WB = Pose::from_quaternion(0.8, 0.6, 0, 0, unit * Vector3d(4, 2, 3));
    const DistanceResult dual = distance(a, X_WA, b, X_WB);
    for (const NewtonSystem system : kSystems) {
      const DistanceResult r = newton_distance(a, X_WA, b, X_WB, system, centre_seed(a, X_WA, b, X_WB));
      ASSERT_EQ(r.status, DistanceStatus::separated) << unit;
      EXPECT_NEAR(r.distance / unit, dual.distance / unit, 1e-14);
    }
  }
}

// Points are counted from the bodies' own centres: only the witness points lose digits far from the origin.
TEST(Newton, PairsFarFromTheOriginKeepTheirDigits) {
  const Ellipsoid a({1, 1, 3});
  const Ellipsoid b({1, 2, 0.5});
  const Vector3d far(0x1p30, -0x1p29, 0x1p30);
  const Pose X_WA = Pose::from_quaternion(0.6, 0, 0.8, 0, far);
  const Pose X_WB = Pose::from_quaternion(0.8, 0.6, 0, 0, far + Vector3d(4, 2, 3));
  const double wanted = distance(a, X_WA, b, X_WB).distance;
  for (const NewtonSystem system : kSystems) {
    EXPECT_NEAR(newton_distance(a, X_WA, b, X_WB, system, centre_seed(a, X_WA, b, X_WB)).distance, wanted, 1e-14);
  }
}

/// An answer from a seed with points far from the bodies is as exact as another one, or there is none.
TEST(Newton, FarSeedsAreJudgedOnTheScaleOfTheBodies) {
  Random random(12);
  const Ellipsoid small({0.03, 0.03, 0.03});
  const Ellipsoid large({100, 100, 100});
  const Pose X_WA = Pose::translation({12.5, -0.125, 4});
  const Pose X_WB = Pose::translation({412.5, -284.5, 404});
  const double size = (X_WB.position() - X_WA.position()).norm() + 100.03;
  const double wanted = size - 2 * 100.03;
  int answered = 0;
  for (int k = 0; k < repetitions(4000); ++k) {
    const Vector3d u = random.log_uniform(1, 1e15) * random.direction();
    const Vector3d v = random.log_uniform(1, 1e15) * random.direction();
    for (const NewtonSystem system : kSystems) {
      const auto seed = checked_seed(small, X_WA, large, X_WB, {u, v, SeedStatus::usable});
      const DistanceResult r = newton_distance(small, X_WA, large, X_WB, system, seed);
      if (r.status != DistanceStatus::separated) continue;
      ++answered;
      ASSERT_NEAR(r.distance, wanted, 1e-12 * size) << u.norm() << " " << v.norm();
      ASSERT_LE(r.error_bound, 1e-12 * size) << u.norm() << " " << v.norm();
    }
  }
  EXPECT_GT(answered, 100);
}

TEST(Newton, StatusesAreHonest) {
  const Ellipsoid a({1, 1, 3});
  const Pose X_WA;
  const Pose X_WB = Pose::translation({4, 1, 1});
  const WitnessPair seed = centre_seed(a, X_WA, a, X_WB);
  for (const NewtonSystem system : kSystems) {
    EXPECT_TRUE(declined(newton_distance(a, X_WA, a, X_WB, system, WitnessPair{})));
    WitnessPair overlapping;
    overlapping.status = SeedStatus::overlapping;
    EXPECT_EQ(newton_distance(a, X_WA, a, X_WB, system, overlapping).iterations, 0);
    for (const int limit : {-1, 0, 1, 2}) {
      EXPECT_TRUE(declined(newton_distance(a, X_WA, a, X_WB, system, seed, {.max_iterations = limit}))) << limit;
    }
    // Equal bodies in one place: every direction of an axis is a solution, none of them shallow.
    const WitnessPair poles{{1, 0, 0}, {-1, 0, 0}, SeedStatus::usable};
    EXPECT_TRUE(declined(newton_distance(a, X_WA, a, X_WA, system, poles)));
  }
}

// What the event loop calls takes anything and never throws.
TEST(Newton, TheUncheckedEntryAnswersBadSeedsWithAStatus) {
  const Ellipsoid a({1, 1, 3});
  const Pose X_WA;
  const Pose X_WB = Pose::translation({4, 1, 0});
  const Vector3d bad_points[] = {Vector3d::Zero(), Vector3d(kNaN, 0, 0), Vector3d(0, 1e300, 0),
                                 Vector3d(0, 0, std::numeric_limits<double>::infinity()), Vector3d(1e-300, 0, 0)};
  for (const Vector3d& bad : bad_points) {
    for (const NewtonSystem system : kSystems) {
      const WitnessPair seed{bad, {3, 1, 0}, SeedStatus::usable};
      DistanceResult r;
      ASSERT_NO_THROW(r = kernel::newton_distance_unchecked(a, X_WA, a, X_WB, system, seed));
      EXPECT_TRUE(declined(r) || std::abs(r.distance - distance(a, X_WA, a, X_WB).distance) < 1e-13);
    }
  }
  const WitnessPair at_the_centres{{0, 0, 0}, {4, 1, 0}, SeedStatus::usable};
  EXPECT_EQ(kernel::newton_distance_unchecked(a, X_WA, a, X_WB, NewtonSystem::eight, at_the_centres).status,
            DistanceStatus::singular);
}

std::string refusal(const Vector3d& point_a, const Vector3d& point_b) {
  const Ellipsoid a({1, 1, 3});
  try {
    (void)newton_distance(a, Pose(), a, Pose::translation({4, 0, 0}), NewtonSystem::eight,
                          {point_a, point_b, SeedStatus::usable});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Newton, BadSeedsAreRefusedByName) {
  EXPECT_EQ(refusal({1, 0, 0}, {3, 0, 0}), "accepted");
  EXPECT_EQ(refusal({0.95, 0, 0}, {3.5, 1, 1}), "accepted") << "5 % inside";
  EXPECT_EQ(refusal({1.5, 0, 0}, {2, 0, 0}), "accepted") << "outside";
  EXPECT_THAT(refusal({kNaN, 0, 0}, {3, 0, 0}), AllOf(HasSubstr("point_a"), HasSubstr("nan"), HasSubstr("not finite"),
                                                      HasSubstr("accepted: three finite numbers")));
  EXPECT_THAT(refusal({1, 0, 0}, {3, 0, std::numeric_limits<double>::infinity()}),
              AllOf(HasSubstr("point_b"), HasSubstr("inf")));
  EXPECT_THAT(refusal({0.5, 0, 0}, {3, 0, 0}),
              AllOf(HasSubstr("point_a"), HasSubstr("0.5"), HasSubstr("inside its body"), HasSubstr("accepted")));
  EXPECT_THAT(refusal({1, 0, 0}, {4, 0, 0}), AllOf(HasSubstr("point_b"), HasSubstr("inside its body")));
}

TEST(Newton, CentreSeedsLieOnTheSurfacesAndOnTheLineOfCentres) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Ellipsoid a = random_ellipsoid(random);
    const PowerBody b{{1, 2, 0.5}, {random.uniform(1.5, 8), 2, random.uniform(1.5, 8)}};
    const Pose X_WA = random.pose(10.0);
    const Pose X_WB = random.pose(10.0);
    const WitnessPair seed = centre_seed(a, X_WA, b, X_WB);
    ASSERT_EQ(seed.status, SeedStatus::usable);
    const Vector3d u = (X_WB.position() - X_WA.position()).normalized();
    EXPECT_NEAR(a.value(X_WA.to_body(seed.point_a)), 0, 1e-7);
    EXPECT_NEAR(b.value(X_WB.to_body(seed.point_b)), 0, 1e-7);
    EXPECT_LE((seed.point_a - X_WA.position()).cross(u).norm(), 1e-13);
    EXPECT_LE((seed.point_b - X_WB.position()).cross(u).norm(), 1e-13);
    EXPECT_GT((seed.point_a - X_WA.position()).dot(u), 0);
    EXPECT_LT((seed.point_b - X_WB.position()).dot(u), 0);
  }
  const Ellipsoid ball({1, 1, 1});
  EXPECT_EQ(centre_seed(ball, Pose(), ball, Pose()).status, SeedStatus::declined);
}

TEST(Newton, SeedsThatHaveNoPointsSaySo) {
  const Ellipsoid a({1, 1, 3});
  const Pose X_WB = Pose::translation({4, 0, 0});
  for (const Vector3d& n :
       {Vector3d(0, 0, 0), Vector3d(kNaN, 0, 0), Vector3d(0, std::numeric_limits<double>::infinity(), 0)}) {
    const WitnessPair seed = normal_seed(a, Pose(), a, X_WB, n);
    EXPECT_EQ(seed.status, SeedStatus::declined);
    EXPECT_TRUE(geom_test::all_nan(seed.point_a) && geom_test::all_nan(seed.point_b));
  }
  EXPECT_EQ(normal_seed(a, Pose(), a, X_WB, {1e-200, 0, 0}).point_a, Vector3d(1, 0, 0));
  EXPECT_EQ(dual_seed(a, Pose(), a, Pose::translation({1e100, 0, 0})).status, SeedStatus::usable);
  EXPECT_STREQ(to_string(SeedStatus::usable), "usable");
  EXPECT_STREQ(to_string(SeedStatus::overlapping), "overlapping");
  EXPECT_STREQ(to_string(SeedStatus::declined), "declined");
}

}  // namespace
}  // namespace geom
