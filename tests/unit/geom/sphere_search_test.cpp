// Branch and bound over all normals: its bounds by points between points, and where all is ridges.

#include "common/geom/random.h"

#include <geom/kernel/sphere_search.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

Vector3d random_heights(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

TEST(SphereSearch, TheBestPointBetweenTwoIsFound) {
  Random random(1);
  int inside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector3d a = random_heights(random);
    const Vector3d b = random_heights(random);
    constexpr int kSteps = 1000;
    double scanned = std::numeric_limits<double>::infinity();
    for (int j = 0; j <= kSteps; ++j) scanned = std::min(scanned, (a + j * (b - a) / kSteps).maxCoeff());
    const double ends = std::min(a.maxCoeff(), b.maxCoeff());
    const double found = std::min(ends, least_between(a, b));
    ASSERT_LE(found, scanned + 1e-15);
    ASSERT_GE(found, scanned - 2.0 / kSteps);  // heights change by 2 at most
    inside += found < ends;
  }
  EXPECT_GT(inside, 500);
}

TEST(SphereSearch, ThePointOfEqualHeightsIsFoundWithinATriangleOnly) {
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const Vector3d a = random_heights(random);
    const Vector3d b = random_heights(random);
    const double height = random.uniform(-1, 1);
    Vector3d shares(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
    shares /= shares.sum();
    const auto third = [&](const Vector3d& s) {
      return Vector3d((Vector3d::Constant(height) - s[0] * a - s[1] * b) / s[2]);
    };
    ASSERT_NEAR(equal_within(a, b, third(shares)), height, 1e-10);
    const Vector3d beyond(shares[0] + 1, shares[1], shares[2] - 1);
    ASSERT_EQ(equal_within(a, b, third(beyond)), std::numeric_limits<double>::infinity());
  }
}

/// The origin in a box: g bends at ridges alone, and is highest at the normal of the nearest face.
TEST(SphereSearch, TheDepthInABoxIsProvedInFewSamples) {
  const Vector3d half(1, 1.3, 1.7);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Vector3d centre = R * Vector3d(0.2, -0.5, 0.4);
  int samples = 0;
  const auto at = [&](const Vector3d& n) {
    ++samples;
    const Vector3d p = centre - R * Vector3d(half.array() * (R.transpose() * n).array().sign());
    return Tangent{n, p, n.dot(p)};
  };
  SphereSearch<decltype(at), decltype(at)> search(at, at, 0, at(Vector3d::UnitX()), 1e-15);
  constexpr double kTolerance = 1e-6;
  constexpr double kDepth = 0.8;
  search.run_to(kTolerance, 100000);
  EXPECT_NEAR(search.best().g, -kDepth, kTolerance);
  EXPECT_GE(search.upper(), -kDepth - 1e-15);
  EXPECT_LE(search.upper(), search.best().g + kTolerance);
  EXPECT_LT(samples, 450);  // 369; by single points 611
}

}  // namespace
}  // namespace geom::kernel
