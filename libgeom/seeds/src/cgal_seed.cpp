#include "tessellation.h"

#include <geom/cgal.h>
#include <geom/kernel/any_body.h>

#include <CGAL/Gmpzf.h>
#include <CGAL/Polytope_distance_d.h>
#include <CGAL/Polytope_distance_d_traits_3.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace geom {
namespace kernel {
namespace {

/// Doubles as input, exact integers with exponents inside: with plain doubles the simplex method returns garbage.
using Kernel = CGAL::Simple_cartesian<double>;
using Traits = CGAL::Polytope_distance_d_traits_3<Kernel, CGAL::Gmpzf, double>;
using PolytopeDistance = CGAL::Polytope_distance_d<Traits>;

constexpr int kVertices = 200;

/// Returns the vertices of a polytope inscribed in the body, about `origin`, lengths over `unit`.
std::vector<Kernel::Point_3> polytope(const SupportBody& body, const Eigen::Vector3d& origin, double unit) {
  static const std::vector<Eigen::Vector3d> directions = spiral_directions(kVertices);
  std::vector<Kernel::Point_3> points;
  points.reserve(directions.size());
  for (const Eigen::Vector3d& s : inscribed_vertices(body, directions)) {
    const Eigen::Vector3d x = (body.pose().to_world(s) - origin) / unit;
    points.emplace_back(x.x(), x.y(), x.z());
  }
  return points;
}

/// Converts a point in homogeneous coordinates, as CGAL returns it.
template <class Iterator>
Eigen::Vector3d to_vector(Iterator coordinate) {
  Eigen::Vector3d x;
  for (int axis = 0; axis < 3; ++axis) x[axis] = CGAL::to_double(*coordinate++);
  return x / CGAL::to_double(*coordinate);
}

}  // namespace

WitnessPair cgal_seed(const SupportBody& a, const SupportBody& b) {
  WitnessPair seed;
  const Eigen::Vector3d& origin = a.pose().position();
  const double unit = std::max(a.inscribed_radius(), b.inscribed_radius());
  const std::vector<Kernel::Point_3> points_a = polytope(a, origin, unit);
  const std::vector<Kernel::Point_3> points_b = polytope(b, origin, unit);
  const PolytopeDistance closest(points_a.begin(), points_a.end(), points_b.begin(), points_b.end());
  if (!closest.is_finite() || CGAL::is_zero(closest.squared_distance_numerator())) {
    seed.status = SeedStatus::overlapping;
    return seed;
  }
  seed.point_a = origin + unit * to_vector(closest.realizing_point_p_coordinates_begin());
  seed.point_b = origin + unit * to_vector(closest.realizing_point_q_coordinates_begin());
  seed.status = SeedStatus::usable;
  return seed;
}

}  // namespace kernel

WitnessPair cgal_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return cgal_seed(s, X_WA, t, X_WB); });
}

}  // namespace geom
