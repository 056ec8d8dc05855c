#include "common/full_form.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;

void expect_principal(const MassProperties& mass, double volume, const Vector3d& moments, double tolerance) {
  EXPECT_LE(mass.relative_error, 1e-9);
  EXPECT_NEAR(mass.volume, volume, tolerance * volume);
  EXPECT_LE(mass.first_moment.norm(), 1e-14 * volume * moments.norm());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(mass.inertia(k, k), moments[k], tolerance * moments[k]);
  EXPECT_LE(std::abs(mass.inertia(0, 1)) + std::abs(mass.inertia(0, 2)) + std::abs(mass.inertia(1, 2)),
            1e-13 * moments.norm());
}

TEST(MassProperties, OfEllipsoidsAndSuperellipsoidsAreThoseInClosedForm) {
  const Ellipsoid ellipsoid({1, 2, 0.3});
  expect_principal(mass_properties(ellipsoid, 2), ellipsoid.volume(), ellipsoid.inertia(ellipsoid.volume()), 1e-12);
  for (const auto& [e1, e2] : {std::pair{0.5, 0.7}, {1.5, 1.2}}) {
    const Superellipsoid s({1, 0.8, 1.5}, e1, e2);
    SCOPED_TRACE(testing::Message() << "e1 = " << e1 << ", e2 = " << e2);
    expect_principal(mass_properties(s, s.bounding_radius()), s.volume(), s.inertia(s.volume()), 1e-11);
  }
}

/// tests/reference/superquadric_mass_separable.csv: a,b,c,n,m,p,V,Ixx,Iyy,Izz, exact.
TEST(MassProperties, OfSuperquadricsOfThreePowersAreTheReference) {
  std::ifstream file(HARDBODY_REFERENCE_DIR "/superquadric_mass_separable.csv");
  ASSERT_TRUE(file) << "no reference file";
  int row = 0;
  int compared = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 'a') continue;
    // Every tenth row, as each takes a second: all of them with HARDBODY_FULL=1.
    if (row++ % 10 != 0 && !full_form()) continue;
    ++compared;
    double v[10];
    char comma;
    std::istringstream numbers(line);
    for (double& x : v) numbers >> x >> comma;
    const geom_test::Superquadric s({v[0], v[1], v[2]}, {v[3], v[4], v[5]});
    SCOPED_TRACE(line);
    expect_principal(mass_properties(s, s.bounding_radius()), v[6], {v[7], v[8], v[9]}, 1e-11);
  }
  EXPECT_EQ(compared, full_form() ? 48 : 5);
}

}  // namespace
}  // namespace geom
