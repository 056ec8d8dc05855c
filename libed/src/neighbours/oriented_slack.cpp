#include "neighbours/oriented_slack.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <variant>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// Returns a distance from its centre to which the body certainly reaches; 0 if it is not centrally symmetric.
double certain_reach(const BodyShape& shape) {
  const auto reach = [&](const auto& s) -> double {
    if constexpr (requires { s.centrally_symmetric(); }) {
      // The bounding sphere of a user's shape may be too large; each height is that of a point no nearer than it.
      return s.centrally_symmetric() ? half_extents(shape).maxCoeff() : 0;
    } else {
      return s.bounding_radius();
    }
  };
  return std::visit(reach, shape);
}

}  // namespace

double oriented_slack(const BodyShape& shape, double thickness) {
  const Vector3d extents = half_extents(shape).array() + thickness;
  const double reach = certain_reach(shape);
  Vector3d room = extents.array() - inscribed_radius(shape);
  for (int k = 0; k < 3; ++k) {
    const double others = extents.squaredNorm() - extents[k] * extents[k];
    const double h2 = reach * reach - others;
    if (h2 > 0) room[k] = std::min(room[k], extents[k] - std::sqrt(h2));
  }
  return room.norm();
}

double smallest_oriented_box(const std::vector<BodyShape>& shapes, double thickness) {
  double radius = 0;
  double slack = 0;
  for (const BodyShape& shape : shapes) {
    radius = std::max(radius, bounding_radius(shape));
    slack = std::max(slack, oriented_slack(shape, thickness));
  }
  return 2 * (2 * radius + 4 * slack);
}

}  // namespace ed::internal
