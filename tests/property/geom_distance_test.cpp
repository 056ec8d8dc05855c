/// Properties of distance() over random pairs: manufactured answers, bounds, invariances.

#include "common/geom/expect.h"
#include "common/geom/manufactured.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>
#include <geom/kernel/perram_wertheim.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::answers;
using geom_test::declined;
using geom_test::distance_tolerance;
using geom_test::extent_of;
using geom_test::lower_bound;
using geom_test::manufacture;
using geom_test::ManufacturedPair;
using geom_test::normal_tolerance;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::WrappedEllipsoid;

enum class Kind { uniaxial, biaxial, mixed };

struct ShapePair {
  Ellipsoid a;
  Ellipsoid b;
  double certified_depth;
};

/// Aspect ratios log-uniform in [1/ratio, ratio] (uniaxial), each semi-axis log-uniform in [1, ratio] (biaxial).
Ellipsoid random_shape(Kind kind, double ratio, Random& random) {
  const bool uniaxial = kind == Kind::uniaxial || (kind == Kind::mixed && random.coin());
  return uniaxial ? random.spheroid(random.log_uniform(1 / ratio, ratio)) : random.biaxial(ratio);
}

ShapePair random_shapes(Kind kind, double ratio, Random& random) {
  const Ellipsoid a = random_shape(kind, ratio, random);
  const Ellipsoid b = random_shape(kind, ratio, random);
  return {a, b, a.min_curvature_radius() + b.min_curvature_radius()};
}

DistanceResult ask(const ShapePair& shapes, const ManufacturedPair& pair) {
  return distance(shapes.a, pair.X_WA, shapes.b, pair.X_WB);
}

/// Returns the distance of the world point from the surface of the body, to first order.
double off_surface(const Ellipsoid& shape, const Pose& X, const Vector3d& p_W) {
  const Vector3d p = X.to_body(p_W);
  return std::abs(shape.value(p)) / shape.gradient(p).norm();
}

// ---------------------------------------------------------------------------------------------------------------------
// Manufactured answers

struct Population {
  const char* name;
  Kind kind;
  double ratio;
  std::uint64_t seed;
};

std::ostream& operator<<(std::ostream& out, const Population& population) {
  return out << population.name;
}

class ManufacturedDistance : public testing::TestWithParam<Population> {
 protected:
  static inline const int kPairs = repetitions(20'000);
};

TEST_P(ManufacturedDistance, OfSeparatedBodiesIsFound) {
  const Population& population = GetParam();
  Random random(population.seed);
  for (int i = 0; i < kPairs; ++i) {
    const ShapePair shapes = random_shapes(population.kind, population.ratio, random);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, random.log_uniform(1e-10, 10), random);
    const DistanceResult r = ask(shapes, pair);
    const double tolerance = distance_tolerance(pair.size);
    ASSERT_TRUE(answers(r, pair.distance, tolerance, extent_of(pair))) << "pair " << i;
    // Gaps of 1e-10 between needles 2000 long are less than rounding.
    if (pair.distance > tolerance) {
      ASSERT_EQ(r.status, DistanceStatus::separated) << "pair " << i;
    }
    ASSERT_LE((r.normal - pair.normal).norm(), normal_tolerance(shapes.a, shapes.b, pair.distance, pair.size))
        << "pair " << i;
    // The contract's bound for the witness points, plus some twenty roundings: of the world
    // coordinates in three dimensions, there and back, and of f.
    const double rounding = 4e-15 * extent_of(pair);
    const double mismatch2 = r.residual * r.residual;
    ASSERT_LE(off_surface(shapes.a, pair.X_WA, r.point_a), mismatch2 / (2 * shapes.a.min_curvature_radius()) + rounding)
        << "pair " << i;
    ASSERT_LE(off_surface(shapes.b, pair.X_WB, r.point_b), mismatch2 / (2 * shapes.b.min_curvature_radius()) + rounding)
        << "pair " << i;
  }
}

TEST_P(ManufacturedDistance, OfOverlapsUpToTheCertifiedDepthIsFound) {
  const Population& population = GetParam();
  Random random(population.seed + 1);
  for (int i = 0; i < kPairs; ++i) {
    const ShapePair shapes = random_shapes(population.kind, population.ratio, random);
    // Half of them shallow, half anywhere up to 0.99 of the certified depth; the rest has its own test below.
    const double share = random.coin() ? random.log_uniform(1e-8, 1) : random.uniform(0, 1);
    if (share > 0.99) continue;
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, -share * shapes.certified_depth, random);
    const DistanceResult r = ask(shapes, pair);
    const double tolerance = distance_tolerance(pair.size);
    ASSERT_TRUE(answers(r, pair.distance, tolerance, extent_of(pair))) << "pair " << i << " share " << share;
    if (pair.distance < -tolerance) {
      ASSERT_EQ(r.status, DistanceStatus::overlapping) << "pair " << i;
    }
    ASSERT_LE((r.normal - pair.normal).norm(), normal_tolerance(shapes.a, shapes.b, pair.distance, pair.size))
        << "pair " << i << " share " << share;
  }
}

TEST_P(ManufacturedDistance, OfOverlapsAtTheCertifiedDepthIsFoundOrDeclined) {
  // There the maximum becomes flat: the curvature left is 1 % or less, none at all for concentric spheres.
  const Population& population = GetParam();
  Random random(population.seed + 2);
  int answered = 0;
  for (int i = 0; i < kPairs; ++i) {
    const ShapePair shapes = random_shapes(population.kind, population.ratio, random);
    const double share = 1 - random.log_uniform(1e-6, 1e-2);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, -share * shapes.certified_depth, random);
    const DistanceResult r = ask(shapes, pair);
    if (r.status == DistanceStatus::not_converged) {
      ASSERT_TRUE(declined(r)) << "pair " << i << " share " << share;
      continue;
    }
    ++answered;
    ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent_of(pair)))
        << "pair " << i << " share " << share;
  }
  // Nearly spherical bodies whose centres are closer than they deviate from spheres: 87 % are answered. Elsewhere: 99.9
  // %.
  EXPECT_GE(answered, kPairs * 8 / 10);
}

INSTANTIATE_TEST_SUITE_P(Populations, ManufacturedDistance,
                         testing::Values(Population{"Uniaxial", Kind::uniaxial, 10, 101},
                                         Population{"Biaxial", Kind::biaxial, 10, 102},
                                         Population{"Mixed", Kind::mixed, 10, 103},
                                         Population{"NearlySpherical", Kind::mixed, 1.01, 104},
                                         Population{"UniaxialExtreme", Kind::uniaxial, 1000, 105},
                                         Population{"BiaxialExtreme", Kind::biaxial, 1000, 106}),
                         [](const auto& instance) { return instance.param.name; });

TEST(Distance, IsBracketedByItsNormalAndItsWitnessPointsForRandomPlacements) {
  // Weak duality needs no known answer: g(n) <= d <= |x_B - x_A| for any points of the bodies.
  Random random(1);
  int apart = 0;
  for (int i = 0; i < repetitions(20'000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double radii = shapes.a.bounding_radius() + shapes.b.bounding_radius();
    const Pose X_WA = random.pose(radii);
    const Pose X_WB = random.pose(radii);
    const DistanceResult r = distance(shapes.a, X_WA, shapes.b, X_WB);
    if (r.status != DistanceStatus::separated) continue;
    ++apart;
    const double tolerance = distance_tolerance((X_WB.position() - X_WA.position()).norm() + radii);
    // Points pulled towards the centre until f <= 0.
    const auto inside = [](const Ellipsoid& shape, const Pose& X, const Vector3d& p_W) {
      const Vector3d p = X.to_body(p_W);
      return X.to_world(p / std::sqrt(1 + std::max(0.0, shape.value(p))));
    };
    const double upper = (inside(shapes.b, X_WB, r.point_b) - inside(shapes.a, X_WA, r.point_a)).norm();
    const double lower = lower_bound(shapes.a, X_WA, shapes.b, X_WB, r.normal);
    ASSERT_LE(lower, r.distance + tolerance) << "pair " << i;
    ASSERT_GE(lower, r.distance - tolerance) << "pair " << i;
    // The residual, which is not 0, enters by its square.
    ASSERT_LE(upper, r.distance + tolerance + r.residual * r.residual / shapes.certified_depth) << "pair " << i;
  }
  EXPECT_GT(apart, repetitions(5000));
}

TEST(Distance, EveryPairIsAnswered) {
  // For random placements the Perram-Wertheim contact function decides, by another method, who is apart.
  Random random(2);
  int deep = 0;
  for (int i = 0; i < repetitions(20'000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double radii = shapes.a.bounding_radius() + shapes.b.bounding_radius();
    const Pose X_WA = random.pose(0.6 * radii);
    const Pose X_WB = random.pose(0.6 * radii);
    const DistanceResult r = distance(shapes.a, X_WA, shapes.b, X_WB);
    const auto support_matrix = [](const Ellipsoid& shape, const Pose& X) -> Matrix3d {
      return X.rotation() * shape.semi_axes().cwiseAbs2().asDiagonal() * X.rotation().transpose();
    };
    const double F = kernel::perram_wertheim(support_matrix(shapes.a, X_WA), support_matrix(shapes.b, X_WB),
                                             X_WB.position() - X_WA.position())
                         .F;
    // F errs by the condition of the matrix, 100, times some epsilons.
    if (r.status == DistanceStatus::separated) {
      ASSERT_GT(F, 1 - 1e-12) << "pair " << i;
    } else {
      ASSERT_EQ(r.status, DistanceStatus::overlapping) << "pair " << i;
      ASSERT_LT(F, 1 + 1e-12) << "pair " << i;
      if (-r.distance > shapes.a.min_curvature_radius() + shapes.b.min_curvature_radius()) ++deep;
    }
  }
  EXPECT_GT(deep, repetitions(1000));  // or the test says little
}

// ---------------------------------------------------------------------------------------------------------------------
// Bounds

TEST(Distance, NoNormalGivesALargerLowerBound) {
  Random random(3);
  for (int i = 0; i < repetitions(2000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double gap =
        random.coin() ? random.log_uniform(1e-10, 10) : -shapes.certified_depth * random.uniform(0, 0.95);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    const DistanceResult r = ask(shapes, pair);
    ASSERT_FALSE(std::isnan(r.distance)) << "pair " << i;
    for (int k = 0; k < 50; ++k) {
      // Half of them close by, where g is nearly as large.
      const Vector3d n =
          k % 2 ? random.direction() : (r.normal + random.log_uniform(1e-6, 1) * random.direction()).normalized();
      ASSERT_LE(lower_bound(shapes.a, pair.X_WA, shapes.b, pair.X_WB, n), r.distance + distance_tolerance(pair.size))
          << "pair " << i;
    }
  }
}

TEST(Distance, ChangesByNoMoreThanABodyMoves) {
  Random random(4);
  for (int i = 0; i < repetitions(5000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, random.log_uniform(1e-3, 10), random);
    const double step = random.log_uniform(1e-9, 1) * pair.distance;
    const Pose X_moved(pair.X_WB.rotation(), pair.X_WB.position() + step * random.direction());
    const DistanceResult before = ask(shapes, pair);
    const DistanceResult after = distance(shapes.a, pair.X_WA, shapes.b, X_moved, {.start = before.normal});
    ASSERT_LE(std::abs(after.distance - before.distance), step + distance_tolerance(pair.size)) << "pair " << i;
  }
}

TEST(Distance, MovingTogetherAlongTheNormalMakesTheBodiesTouch) {
  Random random(5);
  for (int i = 0; i < repetitions(5000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double gap =
        random.coin() ? random.log_uniform(1e-10, 10) : -shapes.certified_depth * random.uniform(0, 0.95);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    const DistanceResult r = ask(shapes, pair);
    const Pose X_touching(pair.X_WB.rotation(), pair.X_WB.position() - r.distance * r.normal);
    const DistanceResult touching = distance(shapes.a, pair.X_WA, shapes.b, X_touching);
    ASSERT_NEAR(touching.distance, 0, 2 * distance_tolerance(pair.size)) << "pair " << i;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Invariances

TEST(Distance, IsInvariantUnderRigidMotions) {
  Random random(6);
  for (int i = 0; i < repetitions(5000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double gap =
        random.coin() ? random.log_uniform(1e-10, 10) : -shapes.certified_depth * random.uniform(0, 0.95);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    const Pose motion = random.pose(10.0);
    const auto moved = [&](const Pose& X) {
      return Pose(motion.rotation() * X.rotation(), motion.to_world(X.position()));
    };
    const DistanceResult r = ask(shapes, pair);
    const DistanceResult r_moved = distance(shapes.a, moved(pair.X_WA), shapes.b, moved(pair.X_WB));
    // The moved coordinates are rounded once more, in a world larger by the motion.
    const double tolerance = distance_tolerance(pair.size + 20);
    ASSERT_TRUE(answers(r_moved, r.distance, 2 * tolerance, extent_of(pair) + 40)) << "pair " << i;
    ASSERT_LE((motion.rotation() * r.normal - r_moved.normal).norm(),
              2 * normal_tolerance(shapes.a, shapes.b, gap, pair.size + 20))
        << "pair " << i;
  }
}

ShapePair scaled(const ShapePair& shapes, double scale) {
  return {Ellipsoid(scale * shapes.a.semi_axes()), Ellipsoid(scale * shapes.b.semi_axes()),
          scale * shapes.certified_depth};
}

ManufacturedPair scaled(const ManufacturedPair& pair, double scale) {
  return {Pose(pair.X_WA.rotation(), scale * pair.X_WA.position()),
          Pose(pair.X_WB.rotation(), scale * pair.X_WB.position()), pair.normal, scale * pair.distance,
          scale * pair.size};
}

TEST(Distance, ScalesWithTheUnitOfLengthBitForBitByPowersOfTwo) {
  // Every tolerance is relative to the pair, and such a factor rounds nothing.
  Random random(7);
  for (int i = 0; i < repetitions(2000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const double gap = random.coin() ? random.log_uniform(1e-10, 10) : -shapes.certified_depth * random.uniform(0, 1);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    const double scale = std::ldexp(1, static_cast<int>(random.uniform(-20, 21)));  // 1e-6 to 1e6
    const DistanceResult r = ask(shapes, pair);
    const DistanceResult r_scaled = ask(scaled(shapes, scale), scaled(pair, scale));
    ASSERT_EQ(r_scaled.status, r.status) << "pair " << i;
    ASSERT_EQ(r_scaled.iterations, r.iterations) << "pair " << i;
    ASSERT_EQ(r_scaled.distance, scale * r.distance) << "pair " << i;
    ASSERT_EQ(r_scaled.normal, r.normal) << "pair " << i;
    ASSERT_EQ(r_scaled.point_a, scale * r.point_a) << "pair " << i;
    ASSERT_EQ(r_scaled.residual, scale * r.residual) << "pair " << i;
  }
}

TEST(Distance, IsRightInAnyUnitOfLength) {
  Random random(8);
  for (int i = 0; i < repetitions(5000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, 10, random);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, random.log_uniform(1e-10, 10), random);
    // Mostly what somebody may use; a tenth of them near the limits of a semi-axis.
    const double scale = i % 10 ? random.log_uniform(1e-6, 1e6) : random.log_uniform(1e-48, 1e48);
    const ShapePair shapes_scaled = scaled(shapes, scale);
    const ManufacturedPair pair_scaled = scaled(pair, scale);
    const DistanceResult r = ask(shapes_scaled, pair_scaled);
    ASSERT_TRUE(answers(r, pair_scaled.distance, distance_tolerance(pair_scaled.size), extent_of(pair_scaled)))
        << "pair " << i << " scaled by " << scale;
    ASSERT_LE((r.normal - pair.normal).norm(), normal_tolerance(shapes.a, shapes.b, pair.distance, pair.size))
        << "pair " << i << " scaled by " << scale;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Kernels and starts against each other

TEST(Distance, OfSpheroidsIsTheSameByTheUniaxialAndByTheTemplateKernel) {
  Random random(9);
  for (int i = 0; i < repetitions(20'000); ++i) {
    const ShapePair shapes = random_shapes(Kind::uniaxial, 10, random);
    const double gap =
        random.coin() ? random.log_uniform(1e-10, 10) : -shapes.certified_depth * random.uniform(0, 0.95);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    const DistanceResult uniaxial = ask(shapes, pair);
    const DistanceResult general =
        distance(WrappedEllipsoid{shapes.a}, pair.X_WA, WrappedEllipsoid{shapes.b}, pair.X_WB);
    ASSERT_TRUE(answers(general, uniaxial.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_LE((general.normal - uniaxial.normal).norm(), 2 * normal_tolerance(shapes.a, shapes.b, gap, pair.size))
        << "pair " << i;
  }
}

TEST(Distance, OfNearlyEqualSemiAxesIsTheSameByTheUniaxialAndByTheGeneralKernel) {
  // One unit in the last place decides which kernel is taken.
  Random random(10);
  for (int i = 0; i < repetitions(5000); ++i) {
    const ShapePair shapes = random_shapes(Kind::uniaxial, 10, random);
    Vector3d semi_axes = shapes.a.semi_axes();
    semi_axes[(*shapes.a.symmetry_axis() + 1) % 3] *= 1 + 3e-16;
    const Ellipsoid nearly(semi_axes);
    ASSERT_FALSE(nearly.symmetry_axis().has_value()) << "pair " << i;
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, random.log_uniform(1e-10, 10), random);
    const DistanceResult r = distance(nearly, pair.X_WA, shapes.b, pair.X_WB);
    ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
  }
}

TEST(Distance, FromAnyStartIsTheColdAnswer) {
  Random random(11);
  for (int i = 0; i < repetitions(20'000); ++i) {
    const ShapePair shapes = random_shapes(Kind::mixed, i % 5 ? 10 : 100, random);
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -shapes.certified_depth * random.uniform(0, 0.95);
    const ManufacturedPair pair = manufacture(shapes.a, shapes.b, gap, random);
    // From a hundredth of a radian off to anywhere: stale normals find spurious maxima of flat discs.
    const Vector3d start = pair.normal + random.log_uniform(1e-3, 100) * random.direction();
    const DistanceResult r = distance(shapes.a, pair.X_WA, shapes.b, pair.X_WB, {.start = start});
    ASSERT_TRUE(answers(r, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_LE((r.normal - pair.normal).norm(), normal_tolerance(shapes.a, shapes.b, gap, pair.size)) << "pair " << i;
  }
}

}  // namespace
}  // namespace geom
