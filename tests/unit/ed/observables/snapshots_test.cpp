// The nematic order of axes, and correlations of two snapshots, where they are known.

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace {

using Eigen::Vector3d;

/// Rounding of a hundred terms of order 1.
constexpr double kExact = 1e-11;

TEST(NematicOrder, IsOneForAlignedAndAntiparallelAxes) {
  std::vector<Vector3d> axes(100, Vector3d(1, 2, 2) / 3);
  EXPECT_NEAR(ed::nematic_order(axes), 1, kExact);
  for (std::size_t k = 0; k < axes.size(); k += 2) axes[k] *= -1;
  EXPECT_NEAR(ed::nematic_order(axes), 1, kExact);
}

TEST(NematicOrder, OfKnownDistributions) {
  // Along x, y and z alike: isotropic to second order.
  EXPECT_NEAR(ed::nematic_order({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}), 0, kExact);
  // In a plane: Q = diag(1/4, 1/4, -1/2).
  EXPECT_NEAR(ed::nematic_order({Vector3d::UnitX(), Vector3d::UnitY()}), 0.25, kExact);
  // On a cone of angle theta about z: P2(cos theta).
  std::vector<Vector3d> cone;
  const double theta = 0.3;
  for (int k = 0; k < 12; ++k) {
    const double phi = 2 * std::acos(-1.0) * k / 12;
    cone.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  }
  EXPECT_NEAR(ed::nematic_order(cone), 1.5 * std::pow(std::cos(theta), 2) - 0.5, kExact);
}

TEST(NematicOrder, OfIsotropicAxesIsSmall) {
  ed::Random random(11);
  std::vector<Vector3d> axes;
  for (int k = 0; k < 20000; ++k) axes.push_back(random.direction());
  const double S = ed::nematic_order(axes);
  // Elements of Q have standard deviation about 1 / sqrt(5 N) on the diagonal: 0.003; the largest eigenvalue of such a
  // matrix is positive and within a few times that.
  EXPECT_GT(S, 0);
  EXPECT_LT(S, 0.02);
}

TEST(SnapshotCorrelations, OfKnownDisplacements) {
  ed::Snapshot origin;
  origin.position = {Vector3d::Zero(), Vector3d(1, 1, 1)};
  origin.axis = {Vector3d::UnitZ(), Vector3d::UnitX()};
  origin.phi_lab.assign(2, Vector3d::Zero());
  origin.phi_body.assign(2, Eigen::Vector3d::Zero());
  ed::Snapshot now = origin;
  now.position[0] += Vector3d(3, 0, 4);
  now.axis[1] = Vector3d::UnitY();
  EXPECT_NEAR(ed::msd_between(origin, now), 12.5, kExact);
  // P2(1) = 1 and P2(0) = -1/2.
  EXPECT_NEAR(ed::c2_between(origin, now), 0.25, kExact);
  now.axis[0] *= -1;
  EXPECT_NEAR(ed::c2_between(origin, now), 0.25, kExact);
}

}  // namespace
