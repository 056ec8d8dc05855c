/// The two kernels of the dual Newton method: one evaluation and one step, against each other and against theory.

#include "common/geom/manufactured.h"
#include "common/special_values.h"

#include <geom/geom.h>
#include <geom/kernel/dual_newton.h>
#include <geom/kernel/uniaxial.h>

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
using geom_test::normal_tolerance;
using geom_test::Random;
using geom_test::repetitions;

/// A manufactured pair of spheroids in the form that the uniaxial kernel takes.
struct PlacedSpheroids {
  Ellipsoid a;
  Ellipsoid b;
  ManufacturedPair placed;
  Spheroid s_a;
  Spheroid s_b;
  Vector3d r;
  Vector3d u_a;
  Vector3d u_b;

  PlacedSpheroids(double X0_a, double X0_b, double gap, Random& random)
      : a({1, 1, X0_a}),
        b({1, 1, X0_b}),
        placed(geom_test::manufacture(a, b, gap, random)),
        s_a(X0_a, 1),
        s_b(X0_b, 1),
        r(placed.X_WB.position() - placed.X_WA.position()),
        u_a(placed.X_WA.rotation().col(2)),
        u_b(placed.X_WB.rotation().col(2)) {}

  UniaxialEvaluation uniaxial(const Vector3d& n) const { return evaluate_uniaxial(s_a, s_b, r, u_a, u_b, n); }

  Evaluation general(const Vector3d& n) const {
    const GeneralPair pair(WorldSupport<Ellipsoid>{a, placed.X_WA.rotation()},
                           WorldSupport<Ellipsoid>{b, placed.X_WB.rotation()}, r,
                           kLeastEigenvalue * (s_a.rho + s_b.rho));
    return pair(n);
  }
};

PlacedSpheroids random_pair(Random& random, double ratio) {
  return PlacedSpheroids(random.log_uniform(1 / ratio, ratio), random.log_uniform(1 / ratio, ratio),
                         random.uniform(-0.5, 2), random);
}

TEST(InverseSquareRoot, OfOnePlusSIsRightToRounding) {
  for (int i = 0; i < 4600; ++i) {
    const double s = 1e-20 * std::pow(1.01, i);  // to 1
    // Three roundings of numbers near 1.
    ASSERT_NEAR(inverse_sqrt_1p(s) * std::sqrt(1 + s), 1, 1.5 * kEpsilon) << s;
    if (s < 0.5) {
      ASSERT_NEAR(inverse_sqrt_1p(-s) * std::sqrt(1 - s), 1, 1.5 * kEpsilon) << -s;
    }
  }
  EXPECT_EQ(inverse_sqrt_1p(0), 1);
}

TEST(StepOnSphere, IsUnitAndInTheDirectionOfNPlusStep) {
  Random random(1);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Vector3d n = random.direction();
    const Vector3d step = random.log_uniform(1e-12, kMaxNormalStep) * n.cross(random.direction());
    const Vector3d moved = step_on_sphere(n, step);
    ASSERT_NEAR(moved.norm(), 1, 4 * kEpsilon);
    ASSERT_LE((moved - (n + step).normalized()).norm(), 4 * kEpsilon);
  }
}

TEST(UniaxialKernel, GapIsTheLowerBoundOfThePublicSupportFunctions) {
  Random random(2);
  for (int i = 0; i < repetitions(2000); ++i) {
    const PlacedSpheroids pair = random_pair(random, 100);
    const Vector3d n = random.direction();
    const double wanted = lower_bound(pair.a, pair.placed.X_WA, pair.b, pair.placed.X_WB, n);
    ASSERT_NEAR(pair.uniaxial(n).g, wanted, 16 * kEpsilon * pair.placed.size) << "pair " << i;
  }
}

TEST(UniaxialKernel, AgreesWithTheGeneralKernelAtEveryNormal) {
  Random random(3);
  for (int i = 0; i < repetitions(5000); ++i) {
    const PlacedSpheroids pair = random_pair(random, 10);
    const Vector3d n =
        random.coin() ? random.direction() : (pair.placed.normal + 0.1 * random.direction()).normalized();
    const UniaxialEvaluation u = pair.uniaxial(n);
    const Evaluation e = pair.general(n);
    // Both solve a 2x2 system whose condition number is at most sum of largest / sum of smallest radii of curvature.
    const double tolerance = 1e-14 * pair.placed.size * 100 / (pair.s_a.rho + pair.s_b.rho);
    ASSERT_NEAR(u.g, e.g, 16 * kEpsilon * pair.placed.size) << "pair " << i;
    // Deeper each lifts its matrix in its own way.
    if (e.g <= -(pair.s_a.rho + pair.s_b.rho)) continue;
    ASSERT_LE((u.step - e.step).norm(), tolerance) << "pair " << i;
    ASSERT_NEAR(u.step2, e.step2, 2 * kMaxNormalStep * tolerance) << "pair " << i;
    ASSERT_NEAR(u.decrement, e.decrement, tolerance * std::max(pair.placed.size, e.decrement)) << "pair " << i;
  }
}

TEST(UniaxialKernel, LeversAreTheDerivativesOfTheSupportHeights) {
  // dh/dt = lever (n.du/dt): by finite differences, turning the axis. Their error is 1e-10 * h''' with h''' up to 10^3.
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const PlacedSpheroids pair = random_pair(random, 5);
    const Vector3d n = random.direction();
    const UniaxialEvaluation e = pair.uniaxial(n);
    const Vector3d turn_a = pair.u_a.cross(random.direction());
    const Vector3d turn_b = pair.u_b.cross(random.direction());
    const double step = 1e-5;
    const auto gap = [&](double ta, double tb) {
      return evaluate_uniaxial(pair.s_a, pair.s_b, pair.r, (pair.u_a + ta * turn_a).normalized(),
                               (pair.u_b + tb * turn_b).normalized(), n)
          .g;
    };
    const double by_a = (gap(step, 0) - gap(-step, 0)) / (2 * step);
    const double by_b = (gap(0, step) - gap(0, -step)) / (2 * step);
    ASSERT_NEAR(by_a, -e.lever[0] * n.dot(turn_a), 1e-7) << "pair " << i;
    ASSERT_NEAR(by_b, -e.lever[1] * n.dot(turn_b), 1e-7) << "pair " << i;
  }
}

TEST(Kernels, StepsLieAcrossTheNormalAreCappedAndAscend) {
  Random random(5);
  for (int i = 0; i < repetitions(5000); ++i) {
    const PlacedSpheroids pair = random_pair(random, 10);
    const Vector3d n = random.direction();
    for (const Evaluation& e : {Evaluation(pair.uniaxial(n)), pair.general(n)}) {
      // The system's solution errs by some epsilons times its condition, at most 2000 / 0.2.
      ASSERT_LE(std::abs(e.step.dot(n)), 1e-11) << "pair " << i;
      ASSERT_LE(e.step2, kMaxNormalStep * kMaxNormalStep * (1 + 1e-15)) << "pair " << i;
      ASSERT_NEAR(e.step2, e.step.squaredNorm(), 1e-14) << "pair " << i;
      ASSERT_GE(e.decrement, 0) << "pair " << i;
      // A short way along the step g rises by its slope, decrement times the share. A share of the step of 1e-6 leaves
      // curvature (at most 100 a body) a relative weight of 1e-4 where the decrement is not tiny.
      if (e.decrement < 1e-2) continue;
      const double share = 1e-6;
      const double uphill = pair.uniaxial(step_on_sphere(n, share * e.step)).g;
      ASSERT_GT(uphill, e.g) << "pair " << i;
    }
  }
}

TEST(Kernels, ANewtonStepSquaresTheErrorOfTheNormal) {
  Random random(6);
  for (int i = 0; i < repetitions(1000); ++i) {
    const double X0_a = random.log_uniform(0.2, 5);
    const double X0_b = random.log_uniform(0.2, 5);
    const double rho = Spheroid(X0_a, 1).rho + Spheroid(X0_b, 1).rho;
    // Also between half of the certified depth and all of it, where a lifted matrix would make it linear.
    const PlacedSpheroids pair(X0_a, X0_b, random.uniform(-0.8, 1) * rho, random);
    const double off = 1e-5;
    const Vector3d n = (pair.placed.normal + off * pair.placed.normal.cross(random.direction())).normalized();
    for (const Evaluation& e : {Evaluation(pair.uniaxial(n)), pair.general(n)}) {
      const Vector3d next = step_on_sphere(n, e.step);
      // The factor of off^2 is the relative change of curvature for a radian, about X0 <= 5, over the share of the
      // curvature that the overlap leaves, at least 1/5; 4 times that.
      ASSERT_LE((next - pair.placed.normal).norm(), 100 * off * off) << "pair " << i;
    }
  }
}

TEST(Kernels, TheNormalStaysUnitOverManySteps) {
  // A disc and a needle: their curvatures have opposite signs, which makes Newton's step amplify a component of the
  // gradient along n. If |n| - 1 enters there, it grows by a constant factor, up to 5, at every step.
  Random random(7);
  constexpr int kSteps = 60;
  for (int i = 0; i < 500; ++i) {
    const PlacedSpheroids pair(random.log_uniform(0.1, 1), random.log_uniform(1, 10), random.log_uniform(1e-6, 1),
                               random);
    Vector3d n = pair.placed.normal;
    for (int step = 0; step < kSteps; ++step) {
      const UniaxialEvaluation e = pair.uniaxial(n);
      n = step_on_sphere(n, e.step);
    }
    // A few roundings a step, amplified by that factor but not by its powers: 4 * 5 epsilons.
    ASSERT_NEAR(n.norm(), 1, kSteps * 20 * kEpsilon) << "pair " << i;
    ASSERT_LE((n - pair.placed.normal).norm(), normal_tolerance(pair.a, pair.b, pair.placed.distance, pair.placed.size))
        << "pair " << i;
  }
}

TEST(ColdStart, IsTheSolutionOfTheSumOfBothSupportMatrices) {
  Random random(8);
  for (int i = 0; i < repetitions(1000); ++i) {
    const PlacedSpheroids pair = random_pair(random, 10);
    const auto support_matrix = [](const Spheroid& s, const Vector3d& u) -> Matrix3d {
      return s.b2 * Matrix3d::Identity() + s.c * u * u.transpose();
    };
    const Matrix3d Q = support_matrix(pair.s_a, pair.u_a) + support_matrix(pair.s_b, pair.u_b);
    const Vector3d wanted = (Q.inverse() * pair.r).normalized();
    // Condition of Q: at most 100; Woodbury's formula loses as much again.
    ASSERT_LE((cold_normal(pair.s_a, pair.s_b, pair.r, pair.u_a, pair.u_b) - wanted).norm(), 1e-11) << "pair " << i;
  }
}

TEST(ColdStart, OfCoincidingCentresIsSomeUnitVector) {
  const Spheroid s(3, 1);
  const Vector3d n = cold_normal(s, s, Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY());
  EXPECT_DOUBLE_EQ(n.norm(), 1);
}

}  // namespace
}  // namespace geom::kernel
