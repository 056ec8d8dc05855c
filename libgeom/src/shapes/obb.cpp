#include <geom/obb.h>

#include <cmath>

namespace geom {
namespace {

/// Added to every |cosine| between edges: near-parallel edges, whose product is no axis but rounding, then never
/// separate boxes, and rounding never separates boxes that touch.
constexpr double kMargin = 1e-12;

}  // namespace

bool boxes_meet(const OrientedBox& a, const OrientedBox& b) {
  // All quantities are in the frame of A: C = cosines between the axes, t = B's centre.
  const Eigen::Matrix3d C = a.axes.transpose() * b.axes;
  const Eigen::Matrix3d absC = (C.cwiseAbs().array() + kMargin).matrix();
  const Eigen::Vector3d t = a.axes.transpose() * (b.centre - a.centre);
  const Eigen::Vector3d& p = a.half_extents;
  const Eigen::Vector3d& q = b.half_extents;
  // Face normals of A, then of B.
  if (((t.cwiseAbs() - p - absC * q).array() > 0).any()) return false;
  if ((((C.transpose() * t).cwiseAbs() - q - absC.transpose() * p).array() > 0).any()) return false;
  // Edge i of A times edge j of B.
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3;
    const int i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3;
      const int j2 = (j + 2) % 3;
      const double radius_a = p[i1] * absC(i2, j) + p[i2] * absC(i1, j);
      const double radius_b = q[j1] * absC(i, j2) + q[j2] * absC(i, j1);
      if (std::abs(t[i2] * C(i1, j) - t[i1] * C(i2, j)) > radius_a + radius_b) return false;
    }
  }
  return true;
}

}  // namespace geom
