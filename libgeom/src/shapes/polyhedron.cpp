#include "shapes/format.h"
#include "shapes/hull.h"

#include <geom/kernel/refuse.h>
#include <geom/polyhedron.h>
#include <geom/tolerances.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

namespace geom {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Returns whether the vertices, which reach to 1 from the origin, come in opposite pairs, to rounding.
bool is_centrally_symmetric(const Eigen::Matrix<double, Eigen::Dynamic, 3>& vertices) {
  constexpr double kOpposite2 = 1e-28;
  for (Eigen::Index k = 0; k < vertices.rows(); ++k) {
    if (!((vertices.rowwise() + vertices.row(k)).rowwise().squaredNorm().minCoeff() <= kOpposite2)) return false;
  }
  return true;
}

}  // namespace

ConvexPolyhedron::ConvexPolyhedron(std::span<const Vector3d> points) : ConvexPolyhedron(kernel::convex_hull(points)) {}

ConvexPolyhedron::ConvexPolyhedron(kernel::Hull hull) {
  bounding_radius_ = hull.vertices.rowwise().norm().maxCoeff();
  inscribed_radius_ = *std::min_element(hull.offsets.begin(), hull.offsets.end());
  if (!(inscribed_radius_ > 0)) {
    kernel::refuse(
        "ConvexPolyhedron: the origin is not inside the hull of the points; accepted: points around it "
        "(in_principal_frame moves them)");
  }
  if (!(bounding_radius_ <= kMaxAspectRatio * inscribed_radius_) || !(inscribed_radius_ >= kMinSemiAxis)) {
    kernel::refuse("ConvexPolyhedron: the hull reaches from " + kernel::shown(inscribed_radius_) + " to " +
                   kernel::shown(bounding_radius_) + " from the origin; accepted: a ratio of at most " +
                   kernel::shown(kMaxAspectRatio) + ", from " + kernel::shown(kMinSemiAxis));
  }
  // Products of five lengths stay in range if the unit is the bounding radius.
  kernel::Hull unit = hull;
  unit.vertices /= bounding_radius_;
  const kernel::HullMoments m = kernel::moments(unit);
  volume_ = m.volume * bounding_radius_ * bounding_radius_ * bounding_radius_;
  centre_ = m.centre * bounding_radius_;
  second_moment_ = m.second_moment * bounding_radius_ * bounding_radius_;
  centrally_symmetric_ = is_centrally_symmetric(unit.vertices);
  hull_ = std::make_shared<const kernel::Hull>(std::move(hull));
}

ConvexPolyhedron ConvexPolyhedron::in_principal_frame(std::span<const Vector3d> points, Pose* X_BP, double rounding) {
  kernel::checked_rounding(rounding);
  const kernel::Hull hull = kernel::convex_hull(points);
  // Moments are taken about a point inside, of lengths of about 1.
  const Vector3d middle = hull.vertices.colwise().mean().transpose();
  kernel::Hull near = hull;
  near.vertices.rowwise() -= middle.transpose();
  const double unit = near.vertices.rowwise().norm().maxCoeff() + rounding;
  near.vertices /= unit;
  kernel::set_planes(near, &hull);
  const kernel::SweptMass m =
      kernel::swept_mass({.kind = kernel::CoreKind::hull, .hull = &near, .radius = rounding / unit});
  const Matrix3d covariance = m.second_moment / m.volume - m.centre() * m.centre().transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  Matrix3d axes = solver.eigenvectors();
  if (covariance.isDiagonal(1e-14)) axes = Matrix3d::Identity();  // symmetric bodies keep their own axes
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Vector3d centre = middle + unit * m.centre();
  std::vector<Vector3d> moved;
  moved.reserve(static_cast<std::size_t>(hull.vertices.rows()));
  for (Eigen::Index k = 0; k < hull.vertices.rows(); ++k) {
    moved.emplace_back(axes.transpose() * (hull.vertices.row(k).transpose() - centre));
  }
  if (X_BP != nullptr) *X_BP = Pose(axes, centre);
  return ConvexPolyhedron(moved);
}

ConvexPolyhedron ConvexPolyhedron::scaled(double factor) const {
  std::vector<Vector3d> points;
  points.reserve(static_cast<std::size_t>(vertex_count()));
  for (int k = 0; k < vertex_count(); ++k) points.emplace_back(factor * vertex(k));
  return ConvexPolyhedron(points);
}

std::string ConvexPolyhedron::description() const {
  return "polyhedron of " + std::to_string(vertex_count()) + " vertices and " +
         std::to_string(merged_faces(*this).size()) + " faces";
}

bool ConvexPolyhedron::contains(const Vector3d& x) const {
  for (std::size_t f = 0; f < hull_->normals.size(); ++f) {
    if (!(hull_->normals[f].dot(x) <= hull_->offsets[f])) return false;
  }
  return true;
}

bool ConvexPolyhedron::is_in_principal_frame() const {
  return kernel::SweptMass{1, centre_, second_moment_}.is_principal(bounding_radius_);
}

Matrix3d ConvexPolyhedron::inertia_tensor(double mass) const {
  return mass * (second_moment_.trace() * Matrix3d::Identity() - second_moment_);
}

}  // namespace geom
