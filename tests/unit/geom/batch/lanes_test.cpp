// Two bodies at once: the exponential and the logarithm, and support functions against those of one body.

#include "common/geom/random.h"

#include <geom/kernel/norm_bodies.h>

#include <gtest/gtest.h>

#include <cmath>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

constexpr long double kUlp = 2.3e-16L;

TEST(Lanes, LogarithmsAreRightToOneUlp) {
  Random random(1);
  for (int k = 0; k < 200000; ++k) {
    const double x = k % 2 == 0 ? random.log_uniform(1e-290, 1e290) : random.uniform(0.5, 2.5);
    const double y = random.log_uniform(1e-3, 1e3);
    const Lanes both_logs = log(Lanes{x, y});
    const auto wanted_x = std::log(static_cast<long double>(x));
    const auto wanted_y = std::log(static_cast<long double>(y));
    ASSERT_LE(std::abs(static_cast<long double>(both_logs[0]) - wanted_x), kUlp * std::abs(wanted_x)) << x;
    ASSERT_LE(std::abs(static_cast<long double>(both_logs[1]) - wanted_y), kUlp * std::abs(wanted_y)) << y;
  }
  EXPECT_EQ(log(both(1))[0], 0);
  EXPECT_NEAR(log(both(0))[0], -709, 1) << "finite, and less than that of any normal number but the least";
}

TEST(Lanes, ExponentialsAreRightToOneUlp) {
  Random random(2);
  for (int k = 0; k < 200000; ++k) {
    const double x = random.uniform(-700, 10);
    const double y = random.uniform(-1, 1);
    const Lanes both_powers = exp(Lanes{x, y});
    const auto wanted_x = std::exp(static_cast<long double>(x));
    const auto wanted_y = std::exp(static_cast<long double>(y));
    ASSERT_LE(std::abs(static_cast<long double>(both_powers[0]) - wanted_x), kUlp * wanted_x) << x;
    ASSERT_LE(std::abs(static_cast<long double>(both_powers[1]) - wanted_y), kUlp * wanted_y) << y;
  }
  EXPECT_EQ(exp(both(0))[1], 1);
  EXPECT_LT(exp(both(-1e6))[0], 1e-300);
}

/// Rows of n: random, and with components that vanish.
Vector3d some_direction(Random& random, int k) {
  Vector3d n = random.direction();
  if (k % 4 == 1) n[k % 3] = 0;
  if (k % 4 == 2) n[k % 3] *= random.log_uniform(1e-30, 1);
  if (k % 50 == 3) n = Vector3d::Unit(k % 3);
  return n.normalized();
}

TEST(NormBodies, HaveTheSupportsOfEachShape) {
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const Superellipsoid a({1, random.uniform(0.3, 3), random.uniform(0.3, 3)}, random.uniform(0.2, 1.6),
                           random.uniform(0.2, 1.6));
    const Ellipsoid b({1, random.uniform(0.3, 3), random.uniform(0.3, 3)});
    const Vector3d n = some_direction(random, k);
    const Matrix3d R_a = k % 50 == 3 ? Matrix3d::Identity() : random.pose(0).rotation();
    const Matrix3d R_b = random.pose(0).rotation();
    const NormBodies bodies(NormShape(a), R_a, NormShape(b), R_b);
    const NormBodies::Support at = bodies.support(n);
    const Support of_a = a.support(R_a.transpose() * n);
    const Support of_b = b.support(-R_b.transpose() * n);
    ASSERT_NEAR(at.height[0], of_a.height, 1e-15 * a.bounding_radius());
    ASSERT_NEAR(at.height[1], of_b.height, 1e-15 * b.bounding_radius());
    // Where a body is flat, rounding of R^T n moves its support point.
    const Matrix3d H_a = R_a * a.support_hessian(R_a.transpose() * n) * R_a.transpose();
    const Matrix3d H_b = R_b * b.support_hessian(-R_b.transpose() * n) * R_b.transpose();
    if (!(H_a.norm() < 1e3)) continue;
    ASSERT_LT((at.point.a() - R_a * of_a.point).norm(), 1e-15 * (2 + H_a.norm()));
    ASSERT_LT((at.point.b() - R_b * of_b.point).norm(), 1e-15 * (2 + H_b.norm()));
    const auto hessian = [](const Vector3d& t1, const Vector3d& t2) {
      return Matrix3d(t1 * t1.transpose() + t2 * t2.transpose());
    };
    // Relative to the largest entry; its change with n is that of powers of the least component.
    const double least = (R_a.transpose() * n).cwiseAbs().minCoeff();
    if (least > 1e-3) {
      ASSERT_LT((hessian(at.t1.a(), at.t2.a()) - H_a).norm(), 1e-12 * H_a.norm());
    }
    ASSERT_LT((hessian(at.t1.b(), at.t2.b()) - H_b).norm(), 1e-14 * H_b.norm() / b.inscribed_radius());
  }
}

TEST(NormBodies, HaveNormalsThatAreThoseOfTheirSupportPoints) {
  Random random(4);
  for (int k = 0; k < 5000; ++k) {
    const Superellipsoid shape({1, random.uniform(0.5, 2), random.uniform(0.5, 2)}, random.uniform(0.4, 1.4),
                               random.uniform(0.4, 1.4));
    const NormBodies bodies(NormShape(shape), random.pose(0).rotation(), NormShape(shape), random.pose(0).rotation());
    const Vector3d n = random.direction();
    const LaneVector points = bodies.support(n).point;
    const LaneVector normals = bodies.normals(points);
    ASSERT_LT((normals.a() - n).norm(), 1e-9);
    ASSERT_LT((normals.b() + n).norm(), 1e-9);
    const LaneVector on = bodies.on_surface(both(3) * points);
    ASSERT_LT((on.a() - points.a()).norm(), 2e-15 * shape.bounding_radius());
    ASSERT_LT((on.b() - points.b()).norm(), 2e-15 * shape.bounding_radius());
  }
}

}  // namespace
}  // namespace geom::kernel
