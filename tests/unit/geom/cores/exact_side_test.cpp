#include "shapes/exact_side.h"
#include "common/geom/random.h"
#include "common/quad.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;
using kernel::exact_side;

/// Coordinates of 24 bits have exact determinants in 113 bits.
Vector3d short_vector(Random& random) {
  const auto coordinate = [&] { return 0x1p-24 * std::floor(0x1p24 * random.uniform(-1, 1)); };
  return {coordinate(), coordinate(), coordinate()};
}

int sign_in_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const quad::Quad3 u = quad::Quad3(b) - quad::Quad3(a), v = quad::Quad3(c) - quad::Quad3(a);
  const quad::Quad determinant = u.cross(v).dot(quad::Quad3(p) - quad::Quad3(a));
  return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

TEST(ExactSide, OfPointsNearAPlaneIsThatOfExactArithmetic) {
  Random random(1);
  int zero = 0;
  for (int i = 0; i < repetitions(20000); ++i) {
    const Vector3d a = short_vector(random), b = short_vector(random), c = short_vector(random);
    // A point of the plane to rounding, and its neighbours: filters fail for them.
    Vector3d p = a + std::floor(4 * random.uniform()) * (b - a) + std::floor(4 * random.uniform()) * (c - a);
    if (random.coin()) p += 0x1p-24 * Vector3d(std::floor(3 * random.uniform()) - 1, 0, 0);
    if ((p.array().abs() > 8).any()) continue;
    const int side = exact_side(a / 8, b / 8, c / 8, p / 8);
    ASSERT_EQ(side, sign_in_quad(a, b, c, p)) << i;
    ASSERT_EQ(exact_side(b / 8, a / 8, c / 8, p / 8), -side) << i;
    ASSERT_EQ(exact_side(a / 8, b / 8, p / 8, c / 8), -side) << i;
    if (side == 0) ++zero;
  }
  EXPECT_GT(zero, 100);
}

/// Differences that are rounded to zero are not lost.
TEST(ExactSide, OfTinyDifferencesIsExact) {
  const Vector3d a(0.5, 0.5, 0.5), b(1, 0.5, 0.5), c(0.5, 1, 0.5);
  for (const double tiny : {0x1p-53, 0x1p-54, 0x1p-80, 0x1p-190}) {
    EXPECT_EQ(exact_side({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, tiny}), 1);
    EXPECT_EQ(exact_side({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, -tiny}), -1);
    // The plane of a, b and c is tilted by its third point; the point is in the plane of the first two.
    EXPECT_EQ(exact_side({0, 0, tiny}, {1, 0, tiny}, {0, 1, tiny}, {0.25, 0.25, 0}), -1);
    EXPECT_EQ(exact_side({1, 0, tiny}, {0, 1, tiny}, {-1, -1, tiny}, {0.25, 0.25, tiny}), 0);
  }
  EXPECT_EQ(exact_side(a, b, c, {0.7, 0.7, std::nextafter(0.5, 1.0)}), 1);
  EXPECT_EQ(exact_side(a, b, c, {0.7, 0.7, 0.5}), 0);
}

}  // namespace
}  // namespace geom
