#pragma once

/// Checks that the tests of contact patches share.

#include <geom/contact_patch.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace geom_test {

/// Returns a pose turned about an axis.
inline geom::Pose turned(const Eigen::Vector3d& position, double angle, const Eigen::Vector3d& axis) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), position};
}

/// Returns the identities of the corners, sorted.
inline std::vector<std::uint64_t> identities(const geom::ContactPatch& patch) {
  std::vector<std::uint64_t> ids;
  for (const geom::PatchPoint& point : patch.points) ids.push_back(point.id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Checks what holds for every patch.
inline void check_form(const geom::ContactPatch& patch) {
  const std::size_t count = patch.points.size();
  switch (patch.kind) {
    case geom::PatchKind::empty:
      EXPECT_EQ(count, 0U);
      break;
    case geom::PatchKind::point:
      EXPECT_EQ(count, 1U);
      break;
    case geom::PatchKind::segment:
      EXPECT_EQ(count, 2U);
      break;
    case geom::PatchKind::polygon:
      EXPECT_GE(count, 3U);
      EXPECT_GT(patch.area, 0);
      break;
  }
  const std::vector<std::uint64_t> ids = identities(patch);
  EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
  for (const geom::PatchPoint& point : patch.points) {
    EXPECT_NEAR((point.point_a - point.point_b).dot(patch.normal), point.depth, 1e-12);
    EXPECT_LE((point.point_a - point.point_b).cross(patch.normal).norm(), 1e-12);
  }
}

}  // namespace geom_test
