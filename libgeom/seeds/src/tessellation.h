#pragma once

/// Points of a body's surface, for libraries that handle only polytopes. Compiled into each adapter that needs it.

#include <geom/kernel/support_body.h>

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <vector>

namespace geom::kernel {

/// Returns directions spread evenly over the sphere, along a spiral that turns by the golden angle from one to the
/// next.
inline std::vector<Eigen::Vector3d> spiral_directions(int count) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double z = (2 * i + 1.0) / count - 1;
    const double rho = std::sqrt(1 - z * z);
    directions.emplace_back(rho * std::cos(golden_angle * i), rho * std::sin(golden_angle * i), z);
  }
  return directions;
}

/// Returns the vertices of a polytope inscribed in the body, in the body's frame: its support points along
/// `directions`.
///
/// Each direction is divided by the body's half-widths along its axes: for an ellipsoid the vertices are then the
/// images of an even distribution over a sphere. Plain directions would crowd at the tips and leave the sides bare.
inline std::vector<Eigen::Vector3d> inscribed_vertices(const SupportBody& body,
                                                       const std::vector<Eigen::Vector3d>& directions) {
  const double unit = body.inscribed_radius();
  Eigen::Vector3d half_widths;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(axis);
    half_widths[axis] = 0.5 * (body.support_B(e) - body.support_B(-e))[axis];
  }
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(directions.size());
  for (const Eigen::Vector3d& u : directions) vertices.push_back(body.support_B(unit * u.cwiseQuotient(half_widths)));
  return vertices;
}

}  // namespace geom::kernel
