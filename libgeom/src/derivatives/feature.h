#pragma once

/// Features of two bodies at their closest points, and what each of them is to first order.

#include <geom/derivatives.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>

namespace geom::kernel {

/// Feature of a body that its witness point is on, in the world's directions, relative to the body's centre.
struct Feature {
  enum class Kind {
    fixed,   ///< a vertex, or a point
    smooth,  ///< the surface of a shape with support functions
    edge,    ///< a segment; the point is free along it
    plane,   ///< a face; the point is free across its normal
    rim,     ///< a circle about the axis of a frustum
    side,    ///< the side of a frustum; the point is free along a straight line from rim to rim
  };
  Kind kind = Kind::fixed;
  int id = 0;                                        ///< number of the vertex, edge, face or disc
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< the vertex, or a point of edge or face
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< direction of the edge, normal of the face
  double share = 0;                                  ///< place on a side: 0 on the lower rim, 1 on the upper one

  bool same_as(const Feature& other) const { return kind == other.kind && id == other.id; }
};

/// Surface point of a feature where a normal belongs to it, and how it moves.
struct LocalContact {
  Eigen::Vector3d x;      ///< point of the surface, ball included, relative to the centre
  Eigen::Matrix3d H;      ///< derivative of x by the unit outward normal
  std::size_t count = 0;  ///< number of directions in which the point is free
  std::array<Eigen::Vector3d, 2> slide = {
      Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< unit vectors of these directions, across the normal
  std::array<double, 2> per_unit = {1, 1};  ///< derivative of the feature's parameter by the length of a slide
};

/// Returns the feature of a body that a point (relative to the centre, ball included) is in the interior of, for a unit
/// outward normal; nullopt if point and normal do not belong to one feature, to within `slack` (length).
std::optional<Feature> feature_at(const ContactBody& body, const Eigen::Vector3d& n, const Eigen::Vector3d& x,
                                  double slack);

/// Returns the directions in which points of the body that are furthest along n are free: 0, 1 or 2, those that are
/// within `slack` (length) of being so.
LocalContact free_directions(const ContactBody& body, const Eigen::Vector3d& n, double slack);

/// Returns what a feature is to first order at a unit outward normal.
LocalContact local_contact(const ContactBody& body, const Feature& feature, const Eigen::Vector3d& n);

/// Moves the point of a feature along its free directions by these lengths.
void slide(Feature& feature, const LocalContact& at, const std::array<double, 2>& by);

}  // namespace geom::kernel
