// The ellipsoids that hold superellipsoids: the inequality that contact searches rest on.

#include "common/full_form.h"
#include "common/geom/random.h"

#include <geom/kernel/norm_bodies.h>
#include <geom/tolerances.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

double random_exponent(Random& random) {
  return random.coin() ? random.uniform(kMinExponent, kMaxExponent)
                       : (random.coin() ? 1.0 : (random.coin() ? kMinExponent : kMaxExponent));
}

/// Any direction, or one next to a face's normal, an edge's, or exactly along an axis.
Vector3d body_direction(Random& random) {
  Vector3d n = random.direction();
  const int kind = static_cast<int>(4 * random.uniform());
  const int k = static_cast<int>(3 * random.uniform());
  if (kind == 1) n[k] *= random.log_uniform(1e-20, 1);
  if (kind == 2) n = Vector3d::Unit(k) + random.log_uniform(1e-18, 1e-2) * random.direction();
  if (kind == 3 && random.coin()) n = Vector3d::Unit(k);
  return n.normalized();
}

/// Returns the unit in which rounding is counted: bodies are of size 1 to 10.
double scale(const Superellipsoid& body) {
  return std::max(1.0, body.semi_axes().maxCoeff() / 2);
}

/// `slack`: how far h(m + dm) may rise above the bound, in units of `scale`: rounding.
void expect_bound(double allowance, double slack, int draws) {
  Random random(5);
  double tightest = 1e300;
  for (int i = 0; i < draws; ++i) {
    const Superellipsoid a({1, random.log_uniform(0.1, 10), random.log_uniform(0.1, 10)}, random_exponent(random),
                           random_exponent(random));
    const Superellipsoid b({1, random.log_uniform(0.1, 10), random.log_uniform(0.1, 10)}, random_exponent(random),
                           random_exponent(random));
    const Matrix3d R_a = random.pose(0).rotation();
    const Matrix3d R_b = i % 2 == 0 ? Matrix3d::Identity() : random.pose(0).rotation();
    const Vector3d n = R_a * body_direction(random);
    const NormBodies bodies(NormShape(a), R_a, NormShape(b), R_b);
    const auto support = bodies.support(n);
    const auto majorant = bodies.majorant(support, allowance);
    ASSERT_GE(majorant.offset[0], -1e-15);
    ASSERT_LE(majorant.offset[0], 2 * allowance + 1e-15 * scale(a));
    ASSERT_LE(majorant.offset[1], 2 * allowance + 1e-15 * scale(b));
    for (int k = 0; k < 20; ++k) {
      const Vector3d change = random.log_uniform(1e-9, 3) * random.direction();
      const LaneVector dn = LaneVector::of(change, -change);
      const LaneVector dm = bodies.to_body(dn);
      const Lanes bound = support.height + majorant.offset + majorant.gradient.dot(dn) +
                          (majorant.D2.x * dm.x * dm.x + majorant.D2.y * dm.y * dm.y + majorant.D2.z * dm.z * dm.z) /
                              (2 * majorant.height);
      const double h_a = a.support(R_a.transpose() * (n + change)).height;
      const double h_b = b.support(-R_b.transpose() * (n + change)).height;
      ASSERT_LE(h_a, bound[0] + slack * scale(a)) << a.e1() << " " << a.e2() << " " << change.norm();
      ASSERT_LE(h_b, bound[1] + slack * scale(b)) << b.e1() << " " << b.e2() << " " << change.norm();
      const double bend = h_a - support.height[0] - majorant.gradient.a().dot(change);
      const double allowed = bound[0] - support.height[0] - majorant.gradient.a().dot(change);
      if (allowance == 0 && bend > 1e-6) tightest = std::min(tightest, allowed / bend);
    }
  }
  if (allowance == 0) {
    EXPECT_LT(tightest, 1.01) << "the bound is attained";
  }
}

const int kDraws = full_form() ? 2000000 : 20000;

TEST(Majorant, BoundsTheSupportFunctionForEveryChangeOfDirection) {
  expect_bound(0, 4e-15, kDraws);
}

TEST(Majorant, BoundsItWithFlatFacesRaised) {
  for (const double allowance : {1e-12, 1e-6, 1e-3, 1e-1}) expect_bound(allowance, 4e-15, kDraws / 4);
}

}  // namespace
}  // namespace geom::kernel
