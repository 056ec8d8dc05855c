#pragma once

#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace geom {

/// Convex hull of points, with sharp edges. Copies share their data. Faces are exact: see merged_faces().
class GEOM_EXPORT ConvexPolyhedron {
 public:
  /// Constructs the convex hull of points of the body's frame. All decisions are exact (signs of determinants of the
  /// coordinates, of which those below 2^-200 of the largest count as 0): points inside, on faces, on edges, or given
  /// twice are no vertices. Throws std::invalid_argument if there are fewer than 4 points, a coordinate is not finite
  /// or beyond kMaxSemiAxis, all points lie in a plane, the origin is not inside, or the hull reaches further than
  /// kMaxAspectRatio, 1e4, times its inscribed radius.
  explicit ConvexPolyhedron(std::span<const Eigen::Vector3d> points);

  /// Returns the points in the frame of the principal axes of their hull, the origin in its centre of mass; `X_BP`, if
  /// given, becomes the pose of that frame in the points' own. With a `rounding` above 0 the frame is that of the hull
  /// with a ball of this radius swept over it. Throws as the constructor does, wherever the origin is.
  static ConvexPolyhedron in_principal_frame(std::span<const Eigen::Vector3d> points, Pose* X_BP = nullptr,
                                             double rounding = 0);

  int vertex_count() const { return static_cast<int>(hull_->vertices.rows()); }       ///< number of vertices
  Eigen::Vector3d vertex(int k) const { return hull_->vertices.row(k).transpose(); }  ///< vertex k, body frame
  const std::vector<std::vector<int>>& faces() const { return hull_->faces; }  ///< vertices of faces, anticlockwise
  int edge_count() const { return static_cast<int>(hull_->edges.size()); }     ///< number of edges

  std::optional<int> symmetry_axis() const { return std::nullopt; }  ///< axis of revolution: none
  /// Returns whether -x is a vertex for every vertex x, to rounding.
  bool centrally_symmetric() const { return centrally_symmetric_; }
  /// Returns the polyhedron of `factor` times the size. Throws as the constructor does.
  ConvexPolyhedron scaled(double factor) const;
  /// Returns "polyhedron of 8 vertices and 6 faces", for messages.
  std::string description() const;

  /// Returns whether a point is in the polyhedron or on its surface.
  bool contains(const Eigen::Vector3d& x) const;

  /// Returns h(n) = max n.v over the vertices and that vertex; n != 0, any length.
  Support support(const Eigen::Vector3d& n) const { return kernel::core_support(core(), n); }
  /// Returns zero, the Hessian wherever one vertex is the furthest.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }

  double bounding_radius() const { return bounding_radius_; }    ///< distance of the furthest vertex from the origin
  double inscribed_radius() const { return inscribed_radius_; }  ///< distance of the nearest face from the origin
  double min_curvature_radius() const { return 0; }              ///< 0: edges are sharp
  double volume() const { return volume_; }                      ///< volume
  const Eigen::Vector3d& centre_of_mass() const { return centre_; }  ///< centre of mass, body frame
  /// Returns the inertia tensor about the origin at uniform density.
  Eigen::Matrix3d inertia_tensor(double mass) const;
  /// Returns whether the body's frame is that of the principal axes, to 1e-9 of the size: the centre of mass in the
  /// origin, and no products of inertia.
  bool is_in_principal_frame() const;
  /// Returns the diagonal of the inertia tensor about the origin: the principal moments if the body's frame is that of
  /// the principal axes (in_principal_frame).
  Eigen::Vector3d inertia(double mass) const { return inertia_tensor(mass).diagonal(); }

  /// Returns the polyhedron as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::hull, .hull = hull_.get(), .bounding_radius = bounding_radius_};
  }

 private:
  explicit ConvexPolyhedron(kernel::Hull hull);

  std::shared_ptr<const kernel::Hull> hull_;
  double bounding_radius_ = 0;
  double inscribed_radius_ = 0;
  bool centrally_symmetric_ = false;
  double volume_ = 0;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second_moment_ = Eigen::Matrix3d::Zero();  // integral of x x^T over the body, over the volume
};

}  // namespace geom
