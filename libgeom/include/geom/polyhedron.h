#pragma once

/// @file
/// Boxes and convex polyhedra; Platonic and Archimedean solids by name; faces of polyhedra that are merged where they
/// are in a plane to rounding.

#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace geom {

/// Box {x : |x_k| <= half_extents_k} in the body's frame, with sharp edges.
class GEOM_EXPORT Box {
 public:
  /// Constructs a box from half its edges along body x, y, z. Throws std::invalid_argument unless each is within
  /// [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, and the largest is at most kMaxAspectRatio, 1e4, times the smallest.
  explicit Box(const Eigen::Vector3d& half_extents);

  const Eigen::Vector3d& half_extents() const { return half_extents_; }  ///< half the edges along body x, y, z

  std::optional<int> symmetry_axis() const { return std::nullopt; }  ///< axis of revolution: none
  /// Returns the box of `factor` times the size. Throws as the constructor does.
  Box scaled(double factor) const { return Box(factor * half_extents_); }
  /// Returns "box of half extents 1 x 2 x 3", for messages.
  std::string description() const;

  /// Returns whether a point is in the box or on its surface.
  bool contains(const Eigen::Vector3d& x) const { return (x.cwiseAbs().array() <= half_extents_.array()).all(); }

  /// Returns h(n) = sum of half_extents_k |n_k| and a vertex; n as of SupportShape.
  Support support(const Eigen::Vector3d& n) const { return kernel::core_support(core(), n); }
  /// Returns zero, the Hessian wherever no n_k is 0.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }

  double bounding_radius() const { return bounding_radius_; }           ///< half the diagonal
  double inscribed_radius() const { return half_extents_.minCoeff(); }  ///< the smallest half extent
  double min_curvature_radius() const { return 0; }                     ///< 0: edges are sharp
  double volume() const { return 8 * half_extents_.prod(); }            ///< product of the edges
  /// Returns the principal moments of inertia about body x, y, z at uniform density: m (b^2 + c^2) / 3, ...
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the box as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::box, .half = half_extents_, .bounding_radius = bounding_radius_};
  }

 private:
  Eigen::Vector3d half_extents_;
  double bounding_radius_;
};

/// Convex hull of points, with sharp edges. Copies share their data. Faces are exact: see merged_faces().
class GEOM_EXPORT ConvexPolyhedron {
 public:
  /// Constructs the convex hull of points of the body's frame. All decisions are exact (signs of determinants of the
  /// coordinates, of which those below 2^-200 of the largest count as 0): points inside, on faces, on edges, or given
  /// twice are no vertices. Points that are in a plane or line to rounding only, as turned ones are, give faces as thin
  /// as that, with accurate normals. Throws std::invalid_argument if there are fewer than 4 points, a coordinate is not
  /// finite or beyond kMaxSemiAxis, all points lie in a plane, the origin is not inside, or the hull reaches further
  /// than kMaxAspectRatio, 1e4, times its inscribed radius.
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

  /// Returns h(n) = max n.v over the vertices and that vertex; n as of SupportShape.
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

/// Returns the names of all Platonic and Archimedean solids: "tetrahedron", "cube", "octahedron", "dodecahedron",
/// "icosahedron", "truncated tetrahedron", ...
GEOM_EXPORT std::span<const std::string_view> solid_names();

/// Returns the vertices of a Platonic or Archimedean solid, its centre in the origin and its circumradius 1, to
/// rounding. `_` and `-` in the name count as a space. The snub solids, which differ from their mirror images, are of
/// one hand. Throws std::invalid_argument, listing the names, for a name that is none of them.
GEOM_EXPORT std::vector<Eigen::Vector3d> solid_vertices(std::string_view name);

/// merged_faces: faces are merged where all their vertices are within kMergedFaces times the bounding radius of the
/// plane of the largest of them. Dimensionless. Coordinates that have been turned or scaled are some 1e-16 off.
inline constexpr double kMergedFaces = 1e-12;

/// Returns the faces of a polyhedron, those in a plane to rounding merged: vertices of each, anticlockwise seen from
/// outside. Vertices that are then within a face or an edge are in no list. ConvexPolyhedron::faces() are exact:
/// corners that rounding has moved out of a plane make several faces, 24 of a regular dodecahedron's 12.
GEOM_EXPORT std::vector<std::vector<int>> merged_faces(const ConvexPolyhedron& polyhedron);

}  // namespace geom
