// Penetration depths against brute force: the largest g over many directions is never above the answer, and comes as
// close to it as the directions are dense. HARDBODY_FULL=1: 100,000 directions instead of 20,000, and ten times the
// pairs.

#include "common/full_form.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// Evenly spread unit vectors (Fibonacci's spiral).
std::vector<Vector3d> directions(int count) {
  std::vector<Vector3d> all;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count;
    const double angle = 2 * std::numbers::pi * (2 - std::numbers::phi) * k;
    const double r = std::sqrt(1 - z * z);
    all.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return all;
}

struct Tally {
  long pairs = 0;
  long declined = 0;
  long wrong = 0;
  long samples = 0;
  double bound = 0;
};

template <class A, class B>
void try_pair(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const std::vector<Vector3d>& all,
              Tally& tally) {
  const DistanceResult r = distance(a, X_WA, b, X_WB);
  const double size = a.bounding_radius() + b.bounding_radius();
  ++tally.pairs;
  tally.samples += r.iterations;
  if (r.status != DistanceStatus::overlapping) {
    ++tally.declined;
    return;
  }
  tally.bound = std::max(tally.bound, r.error_bound / size);
  double most = -std::numeric_limits<double>::infinity();
  for (const Vector3d& n : all) most = std::max(most, geom_test::lower_bound(a, X_WA, b, X_WB, n));
  const double here = geom_test::lower_bound(a, X_WA, b, X_WB, r.normal);
  // The bound says that no direction is better by more than it; of these pairs none is better at all.
  const bool right = most <= r.distance + 1e-12 * size && r.error_bound <= kWidestDepthGap * size &&
                     std::abs(here - r.distance) <= 1e-14 * size;
  if (!right) ++tally.wrong;
}

/// Two bodies whose centres are at most `reach` times their inscribed radii apart: they overlap.
template <class A, class B>
void overlap(const A& a, const B& b, Random& random, const std::vector<Vector3d>& all, Tally& tally) {
  const bool concentric = random.uniform() < 0.1;
  const Vector3d r =
      concentric ? Vector3d::Zero()
                 : Vector3d(random.uniform(0, 1) * (a.inscribed_radius() + b.inscribed_radius()) * random.direction());
  const Pose X_WA(random.pose(0).rotation(), Vector3d::Zero());
  const bool parallel = random.uniform() < 0.1;
  try_pair(a, X_WA, b, Pose(parallel ? X_WA.rotation() : random.pose(0).rotation(), r), all, tally);
}

void report(const char* name, const Tally& tally) {
  std::printf("%-30s %ld pairs, %ld declined, %ld wrong, %.0f evaluations each, widest bound %.1e of the size\n", name,
              tally.pairs, tally.declined, tally.wrong,
              static_cast<double>(tally.samples) / static_cast<double>(tally.pairs), tally.bound);
  EXPECT_EQ(tally.wrong, 0) << name;
  EXPECT_EQ(tally.declined, 0) << name;
}

TEST(Penetration, OfEllipsoidsIsTheLeastOverAllDirections) {
  const auto all = directions(full_form() ? 100000 : 20000);
  const int pairs = full_form() ? 2000 : 100;
  Random random(1);
  for (const double most : {1.2, 3.0, 10.0}) {
    Tally tally;
    for (int k = 0; k < pairs; ++k) {
      const auto body = [&] {
        return random.coin() ? random.spheroid(random.log_uniform(1 / most, most)) : random.biaxial(most);
      };
      overlap(body(), body(), random, all, tally);
    }
    char name[64];
    (void)std::snprintf(name, sizeof name, "ellipsoids, ratios to %g", most);
    report(name, tally);
  }
}

TEST(Penetration, OfSuperellipsoidsIsTheLeastOverAllDirections) {
  const auto all = directions(full_form() ? 100000 : 5000);
  const int pairs = full_form() ? 1000 : 40;
  Random random(2);
  for (const double e : {0.2, 0.5, 0.9, 1.3, 1.6}) {
    Tally tally;
    for (int k = 0; k < pairs; ++k) {
      const auto body = [&](double exponent) {
        return Superellipsoid({1, random.uniform(0.5, 2), random.uniform(0.5, 2)}, exponent, random.uniform(0.2, 1.6));
      };
      overlap(body(e), body(random.uniform(0.2, 1.6)), random, all, tally);
    }
    char name[64];
    (void)std::snprintf(name, sizeof name, "superellipsoids, e1 = %g", e);
    report(name, tally);
  }
}

/// Returns by how much g grows uphill of n, in steps of 0.3 to 1e-8 in 16 directions.
template <class A, class B>
double growth_uphill(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const Vector3d& start) {
  Vector3d n = start;
  const double before = geom_test::lower_bound(a, X_WA, b, X_WB, n);
  double highest = before;
  for (double angle = 0.3; angle > 1e-8; angle *= 0.5) {
    const Vector3d e = n.unitOrthogonal();
    const Vector3d f = n.cross(e);
    Vector3d best = n;
    for (int k = 0; k < 16; ++k) {
      const double turn = std::numbers::pi * k / 8;
      const Vector3d m = (n + angle * (std::cos(turn) * e + std::sin(turn) * f)).normalized();
      const double g = geom_test::lower_bound(a, X_WA, b, X_WB, m);
      if (!(g > highest)) continue;
      highest = g;
      best = m;
    }
    n = best;
  }
  return highest - before;
}

struct SymmetricTally {
  long pairs = 0;
  long declined = 0;
  long beaten = 0;
  double worst = 0;
};

template <class A, class B>
void try_symmetric(const A& a, const B& b, const Pose& X_WB, SymmetricTally& tally) {
  const DistanceResult r = distance(a, Pose(), b, X_WB);
  ++tally.pairs;
  tally.declined += r.status == DistanceStatus::not_converged;
  if (r.status != DistanceStatus::overlapping) return;
  const double size = a.bounding_radius() + b.bounding_radius();
  const double growth = growth_uphill(a, Pose(), b, X_WB, r.normal) / size;
  tally.worst = std::max(tally.worst, growth);
  tally.beaten += growth > 1e-12;
  EXPECT_LE(growth * size, r.error_bound + 1e-14 * size);
}

/// Stationary normals of symmetric pairs may be saddles of g: bodies side by side, above each other, tip to tip, one in
/// the other's middle, with parallel axes or turned by an eighth of a circle; and nearly spheres, of which every normal
/// is nearly stationary.
TEST(Penetration, OfSymmetricPairsIsNoSaddle) {
  const int shapes = full_form() ? 400 : 40;
  Random random(4);
  SymmetricTally tally;
  const auto body = [&](int k) {
    const auto exponent = [&] {
      return random.coin() ? random.uniform(0.2, 1.6) : 1.0 + random.log_uniform(1e-6, 1e-2);
    };
    const double longest = k % 2 == 0 ? 1.2 : 100;
    Vector3d axes(1, 1, random.log_uniform(1 / longest, longest));
    if (random.coin()) axes.y() = random.log_uniform(1 / longest, longest);
    return Superellipsoid(axes, exponent(), exponent());
  };
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitZ()).toRotationMatrix();
  for (int k = 0; k < shapes; ++k) {
    const Superellipsoid a = body(k);
    const Superellipsoid b = body(k / 2);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double share : {0.0, 0.5, 0.999, 1 - 1e-7}) {
        const Vector3d r = share * (a.semi_axes()[axis] + b.semi_axes()[axis]) * Vector3d::Unit(axis);
        for (const Eigen::Matrix3d& R : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turned}) {
          try_symmetric(a, b, Pose(R, r), tally);
          try_symmetric(Ellipsoid(a.semi_axes()), Ellipsoid(b.semi_axes()), Pose(R, r), tally);
        }
      }
    }
  }
  std::printf("%ld symmetric pairs, %ld declined; beaten by more than 1e-12 of the size: %ld, by %.1e at most\n",
              tally.pairs, tally.declined, tally.beaten, tally.worst);
  EXPECT_EQ(tally.beaten, 0);
  EXPECT_LE(tally.worst, kDepthGap);
}

/// Pairs whose sharp edges or vertices meet, or of which a body is nearly a ball.
TEST(Penetration, OfPairsThatOnceEndedOnASaddle) {
  struct Case {
    Superellipsoid a, b;
    Vector3d r;
  };
  const Case cases[] = {
      {{{1, 1, 1}, 1, 1}, {{1, 1, 1}, 1.0001, 1.0001}, {0, 0, 0}},
      {{{1, 1, 1}, 1.3, 0.6666}, {{2, 2, 1}, 1.1, 1.5}, {0, 0, 1.7}},
      {{{2, 1, 1}, 1, 1.5}, {{2, 1, 1}, 1, 1.5}, {4 - 4e-4, 0, 0}},
  };
  for (const Case& c : cases) {
    const Pose X_WB = Pose::translation(c.r);
    const DistanceResult r = distance(c.a, Pose(), c.b, X_WB);
    ASSERT_EQ(r.status, DistanceStatus::overlapping);
    EXPECT_LE(growth_uphill(c.a, Pose(), c.b, X_WB, r.normal), 1e-12);
  }
  // Unit ball and one that is rounder than it by nothing: the way out is along (1, 1, 1) / sqrt 3.
  const Vector3d diagonal = Vector3d(1, -1, 1).normalized();
  const DistanceResult balls = distance(cases[0].a, Pose(), cases[0].b, Pose());
  EXPECT_GE(balls.distance, geom_test::lower_bound(cases[0].a, Pose(), cases[0].b, Pose(), diagonal) - 1e-14);
}

/// Two maxima 3e-11 of the size apart, less than the search tells apart by itself.
TEST(Penetration, IsThatOfTheHigherOfTwoMaximaNearlyAsHigh) {
  const Superellipsoid shape({1, 1.1947380988778979, 1.943863501793508}, 1.3, 0.7);
  const Pose X_WA = Pose::from_quaternion(0.75636241671830473, 0.56841484044565505, -0.035243695167228167,
                                          -0.3218358986939549, Vector3d::Zero());
  const Pose X_WB =
      Pose::from_quaternion(0.089792008734208589, 0.83775357117765537, 0.5160326611342525, -0.15432641312900033,
                            {-1.2086495724833675, -2.4702103496621111, 1.0315437315276796});
  const DistanceResult r = distance(shape, X_WA, shape, X_WB);
  EXPECT_NEAR(r.distance, -0.0068317093659207, 1e-14);
}

struct LocalTally {
  long pairs = 0;
  long deep = 0;      ///< deeper than what is certified: the shortest way out needs the search over all normals
  long searched = 0;  ///< the local answer needed it too
  long longer = 0;    ///< answers longer than the shortest way out
  long wrong = 0;
};

/// Compares the local answer of two bodies that overlap with the shortest way out.
template <class A, class B>
void try_local(const A& a, const B& b, Random& random, LocalTally& tally) {
  const double depth = random.log_uniform(1e-3, 1) * (a.inscribed_radius() + b.inscribed_radius());
  const auto pair = geom_test::manufacture(a, b, -depth, random);
  const DistanceResult shortest = distance(a, pair.X_WA, b, pair.X_WB);
  const DistanceResult local = distance(a, pair.X_WA, b, pair.X_WB, {.penetration = Penetration::local});
  ++tally.pairs;
  const double slack = 1e-12 * pair.size;
  const bool deep = shortest.iterations > 2 * kMaxIterations;
  tally.deep += deep;
  tally.searched += deep && local.iterations >= shortest.iterations;
  tally.longer += local.distance < shortest.distance - slack;
  // Pushed out past an edge or a face that is turned the other way, the bodies may be apart.
  const double g = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, local.normal);
  const bool right = local.status == shortest.status && std::abs(g - local.distance) <= slack &&
                     local.distance <= shortest.distance + shortest.error_bound + slack;
  if (!right) ++tally.wrong;
}

/// A local answer is one of the ways out, and hardly ever needs the search: some point is found that both bodies hold.
TEST(Penetration, LocalIsAWayOutThatNeedsNoSearch) {
  const int pairs = full_form() ? 4000 : 100;
  for (const double ratio : {1.0, 3.0, 10.0}) {
    for (const double smallest : {1.0, 0.05}) {
      Random random(3);
      LocalTally tally;
      const auto axes = [&](double size) { return Vector3d(size * random.biaxial(1.001 * ratio).semi_axes()); };
      for (int k = 0; k < pairs; ++k) {
        const Vector3d a = axes(1);
        const Vector3d b = axes(random.log_uniform(smallest, 1));
        const auto exponent = [&] { return random.uniform(0.2, 1.6); };
        const Superellipsoid barr(a, exponent(), exponent());
        try_local(Ellipsoid(a), Ellipsoid(b), random, tally);
        try_local(barr, Superellipsoid(b, exponent(), exponent()), random, tally);
        try_local(barr, Ellipsoid(b), random, tally);
      }
      std::printf("ratios to %-3g sizes to %-5g %ld pairs, %ld deep, of these %ld searched; %ld longer, %ld wrong\n",
                  ratio, smallest, tally.pairs, tally.deep, tally.searched, tally.longer, tally.wrong);
      EXPECT_EQ(tally.wrong, 0);
      EXPECT_LE(static_cast<double>(tally.searched), 0.01 * static_cast<double>(tally.deep));
    }
  }
}

}  // namespace
}  // namespace geom
