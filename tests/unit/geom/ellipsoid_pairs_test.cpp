/// The kernels of `distance` for two ellipsoids, of revolution and with three axes: one evaluation and one step,
/// against the general kernel and against theory.

#include "common/geom/manufactured.h"
#include "common/special_values.h"

#include <dual/ellipsoid_pair.h>
#include <dual/spheroid_pair.h>
#include <geom/geom.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::lower_bound;
using geom_test::ManufacturedPair;
using geom_test::Random;
using geom_test::repetitions;

/// Two ellipsoids in the form that the kernel under test takes.
struct OfRevolution {
  static Ellipsoid shape(double X0) { return Ellipsoid({1, 1, X0}); }
  static SpheroidPair pair(const Ellipsoid& a, const Ellipsoid& b, const ManufacturedPair& placed) {
    const auto spheroid = [](const Ellipsoid& e) { return Spheroid(e.semi_axes().z(), 1); };
    return {spheroid(a), spheroid(b), placed.X_WB.position() - placed.X_WA.position(), placed.X_WA.rotation().col(2),
            placed.X_WB.rotation().col(2)};
  }
};

struct OfThreeAxes {
  static Ellipsoid shape(double X0) { return Ellipsoid({std::sqrt(X0), 1, X0}); }
  static EllipsoidPair pair(const Ellipsoid& a, const Ellipsoid& b, const ManufacturedPair& placed) {
    return {a, placed.X_WA, b, placed.X_WB, placed.X_WB.position() - placed.X_WA.position()};
  }
};

template <class Kernel>
struct Case {
  Ellipsoid a, b;
  ManufacturedPair placed;
  double rho;  ///< the sum of both smallest radii of curvature
  decltype(Kernel::pair(a, b, placed)) pair;

  /// `gap` in units of rho.
  Case(double X0_a, double X0_b, double gap, Random& random)
      : a(Kernel::shape(X0_a)),
        b(Kernel::shape(X0_b)),
        placed(geom_test::manufacture(a, b, gap * (a.min_curvature_radius() + b.min_curvature_radius()), random)),
        rho(a.min_curvature_radius() + b.min_curvature_radius()),
        pair(Kernel::pair(a, b, placed)) {}

  Vector3d r() const { return placed.X_WB.position() - placed.X_WA.position(); }
  double g(const Vector3d& n) const { return lower_bound(a, placed.X_WA, b, placed.X_WB, n); }
  Evaluation newton(const Vector3d& n) const {
    const GeneralPair general(WorldSupport<Ellipsoid>{a, placed.X_WA.rotation()},
                              WorldSupport<Ellipsoid>{b, placed.X_WB.rotation()}, r(), kLeastEigenvalue * rho);
    return general(n);
  }
};

template <class Kernel>
class EllipsoidPairKernels : public testing::Test {};
using Kernels = testing::Types<OfRevolution, OfThreeAxes>;
TYPED_TEST_SUITE(EllipsoidPairKernels, Kernels);

TYPED_TEST(EllipsoidPairKernels, GapDecrementAndLengthAreNewtons) {
  Random random(31);
  for (int i = 0; i < repetitions(3000); ++i) {
    const Case<TypeParam> c(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.uniform(-0.9, 10), random);
    const Vector3d n = random.coin() ? random.direction() : (c.placed.normal + 0.1 * random.direction()).normalized();
    const ChebyshevEvaluation e = c.pair(n);
    const Evaluation newton = c.newton(n);
    ASSERT_NEAR(e.g, c.g(n), 16 * kEpsilon * c.placed.size) << "pair " << i;
    if (newton.g <= -c.rho) continue;  // each lifts its matrix in its own way
    // Both solve a 2x2 system whose condition number is at most sum of largest / sum of smallest radii of curvature.
    const double tolerance = 1e-14 * c.placed.size * 100 / c.rho;
    ASSERT_NEAR(e.step2, newton.step2, 2 * kMaxNormalStep * tolerance) << "pair " << i;
    ASSERT_NEAR(e.decrement, newton.decrement, tolerance * std::max(c.placed.size, newton.decrement)) << "pair " << i;
  }
}

TYPED_TEST(EllipsoidPairKernels, StepsLieAcrossTheNormalAndAscend) {
  Random random(32);
  int careful = 0;
  for (int i = 0; i < repetitions(5000); ++i) {
    const Case<TypeParam> c(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.uniform(-0.9, 10), random);
    const Vector3d n = random.direction();
    const ChebyshevEvaluation e = c.pair(n);
    // The system's solution errs by some epsilons times its condition, at most 2000 / 0.2.
    ASSERT_LE(std::abs(e.step.dot(n)), 1e-11) << "pair " << i;
    ASSERT_LE(e.step2, kMaxNormalStep * kMaxNormalStep * (1 + 1e-15)) << "pair " << i;
    ASSERT_LE(e.step.squaredNorm(), kMaxNormalStep * kMaxNormalStep * (1 + 1e-15)) << "pair " << i;
    ASSERT_GE(e.decrement, 0) << "pair " << i;
    careful += e.tolerance2 == kNormalTolerance2;
    // As in StepsLieAcrossTheNormalAreCappedAndAscend of the other kernels; at least a tenth of the slope is left.
    if (e.decrement < 1e-2) continue;
    ASSERT_GT(c.g(step_on_sphere(n, 1e-6 * e.step)), e.g) << "pair " << i;
  }
  EXPECT_GT(careful, 0);
}

TYPED_TEST(EllipsoidPairKernels, AStepCubesTheErrorOfTheNormal) {
  Random random(33);
  double worst_ratio = 0;
  for (int i = 0; i < repetitions(1000); ++i) {
    const Case<TypeParam> c(random.log_uniform(0.2, 5), random.log_uniform(0.2, 5), random.uniform(-0.8, 1), random);
    const Vector3d across = c.placed.normal.cross(random.direction());
    const auto at = [&](double off) -> Vector3d { return (c.placed.normal + off * across).normalized(); };
    const auto left = [&](double off) {
      EXPECT_GE(c.pair(at(off)).decrement, 0) << "pair " << i;
      return (step_on_sphere(at(off), c.pair(at(off)).step) - c.placed.normal).norm();
    };
    ASSERT_EQ(c.pair(at(1e-5)).tolerance2, kChebyshevTolerance2) << "pair " << i;
    // The factor of off^3 is about the square of the relative change of curvature for a radian, X0 <= 5 at most; twice
    // that. Newton's step leaves some off^2.
    const double rounding = 1e-14 * c.placed.size / c.rho;
    ASSERT_LE(left(1e-3), 50 * 1e-9 + rounding) << "pair " << i;
    ASSERT_LE(left(1e-4), 50 * 1e-12 + rounding) << "pair " << i;
    // Where the larger error stands out from rounding, a tenth of the way leaves a thousandth of it.
    if (left(1e-3) > 1e3 * (rounding + 1e-13)) worst_ratio = std::max(worst_ratio, left(1e-4) / left(1e-3));
  }
  EXPECT_GT(worst_ratio, 0);
  EXPECT_LE(worst_ratio, 4e-3);
}

TYPED_TEST(EllipsoidPairKernels, ConcentricBodiesHaveALocalAnswer) {
  Random random(39);
  for (int i = 0; i < repetitions(500); ++i) {
    const Case<TypeParam> c(random.log_uniform(1.0 / 3, 3), random.log_uniform(1.0 / 3, 3), 1, random);
    const Pose X_WB(c.placed.X_WB.rotation(), c.placed.X_WA.position());
    const DistanceResult r = distance(c.a, c.placed.X_WA, c.b, X_WB, {.penetration = Penetration::local});
    ASSERT_EQ(r.status, DistanceStatus::overlapping) << "pair " << i;
    // The last step of a lifted matrix, 1e-6, leaves about as much.
    ASSERT_LE(r.residual, 2e-6 * (c.a.bounding_radius() + c.b.bounding_radius())) << "pair " << i;
  }
}

TYPED_TEST(EllipsoidPairKernels, LongBodiesInTouchKeepTheirBounds) {
  // Across a needle the curvature is 1e8 times that along it: rounding must not enter there undamped.
  Random random(40);
  for (const double X0 : {1e3, 9.9e3}) {
    for (const double gap : {-0.9, -1e-3, 1e-3, 1.0}) {
      for (int i = 0; i < repetitions(300); ++i) {
        const Case<TypeParam> c(random.coin() ? X0 : 1 / X0, X0, gap, random);
        const DistanceResult r = distance(c.a, c.placed.X_WA, c.b, c.placed.X_WB);
        ASSERT_NEAR(r.distance, c.placed.distance, geom_test::distance_tolerance(c.placed.size)) << X0 << ' ' << i;
        ASSERT_LE(r.error_bound, 1e-15 * c.placed.size) << "X0 " << X0 << ", gap " << gap << ", pair " << i;
      }
    }
  }
}

TYPED_TEST(EllipsoidPairKernels, FewEvaluationsGiveTheSameAnswers) {
  Random random(41);
  for (int i = 0; i < repetitions(500); ++i) {
    const Case<TypeParam> c(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.uniform(-0.9, 10), random);
    for (const int most : {1, 2, 3}) {
      const DistanceResult r = distance(c.a, c.placed.X_WA, c.b, c.placed.X_WB, {.max_iterations = most});
      ASSERT_NEAR(r.distance, c.placed.distance, geom_test::distance_tolerance(c.placed.size)) << "pair " << i;
      ASSERT_GE(r.iterations, 1) << "pair " << i;
    }
  }
}

TYPED_TEST(EllipsoidPairKernels, TheNormalStaysUnitOverManySteps) {
  // As the test of that name of the other kernels.
  Random random(34);
  constexpr int kSteps = 60;
  for (int i = 0; i < 500; ++i) {
    const Case<TypeParam> c(random.log_uniform(0.1, 1), random.log_uniform(1, 10), random.log_uniform(1e-6, 1), random);
    Vector3d n = c.placed.normal;
    for (int step = 0; step < kSteps; ++step) n = step_on_sphere(n, c.pair(n).step);
    ASSERT_NEAR(n.norm(), 1, kSteps * 20 * kEpsilon) << "pair " << i;
    ASSERT_LE((n - c.placed.normal).norm(), geom_test::normal_tolerance(c.a, c.b, c.placed.distance, c.placed.size))
        << "pair " << i;
  }
}

TYPED_TEST(EllipsoidPairKernels, SupportsAreThePublicOnes) {
  Random random(35);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Case<TypeParam> c(random.log_uniform(1e-3, 1e3), random.log_uniform(1e-3, 1e3), 1, random);
    const Vector3d n = random.direction();
    const SupportPair s = c.pair.support_pair(n);
    const Matrix3d& R_A = c.placed.X_WA.rotation();
    const Matrix3d& R_B = c.placed.X_WB.rotation();
    const Support a = c.a.support(R_A.transpose() * n);
    const Support b = c.b.support(R_B.transpose() * -n);
    // The rounding of n tilts a flat body's support point by its aspect ratio.
    const double of_a = 16 * kEpsilon * c.a.bounding_radius() / c.a.inscribed_radius() * c.a.bounding_radius();
    const double of_b = 16 * kEpsilon * c.b.bounding_radius() / c.b.inscribed_radius() * c.b.bounding_radius();
    ASSERT_NEAR(s.h_a, a.height, 16 * kEpsilon * c.a.bounding_radius()) << "pair " << i;
    ASSERT_NEAR(s.h_b, b.height, 16 * kEpsilon * c.b.bounding_radius()) << "pair " << i;
    ASSERT_LE((s.s_a - R_A * a.point).norm(), of_a) << "pair " << i;
    ASSERT_LE((s.s_b - R_B * b.point).norm(), of_b) << "pair " << i;
  }
}

TYPED_TEST(EllipsoidPairKernels, StartSolvesTheSystemOfTheLineOfCentres) {
  Random random(36);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Case<TypeParam> c(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.uniform(0, 10), random);
    const Vector3d line = c.r().normalized();
    const auto matrix = [&](const Ellipsoid& shape, const Pose& X) -> Matrix3d {
      const Matrix3d Q =
          X.rotation() * shape.semi_axes().array().square().matrix().asDiagonal() * X.rotation().transpose();
      return Q / std::sqrt(line.dot(Q * line));
    };
    const Matrix3d M =
        matrix(c.a, c.placed.X_WA) + matrix(c.b, c.placed.X_WB) + std::max(0.0, c.g(line)) * Matrix3d::Identity();
    const Vector3d wanted = (M.inverse() * c.r()).normalized();
    // Condition of M: at most 1000; the closed forms lose as much again.
    ASSERT_LE((c.pair.start_normal() - wanted).norm(), 1e-10) << "pair " << i;
  }
}

TYPED_TEST(EllipsoidPairKernels, StartForCoincidingCentresIsAUnitVector) {
  Random random(37);
  Case<TypeParam> c(3, 0.5, 1, random);
  c.placed.X_WB = Pose(c.placed.X_WB.rotation(), c.placed.X_WA.position());
  EXPECT_DOUBLE_EQ(TypeParam::pair(c.a, c.b, c.placed).start_normal().norm(), 1);
}

}  // namespace
}  // namespace geom::kernel
