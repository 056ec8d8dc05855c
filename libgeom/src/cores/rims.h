#pragma once

/// Frusta and polytopes in the world's directions, and the closest points of features that slide along rims.

#include "cores/contact.h"
#include "cores/placed_core.h"
#include "shapes/length_of.h"

#include <geom/kernel/core.h>
#include <geom/kernel/core_simplex.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>

namespace geom::kernel {

/// Core turned by R and moved by t: a polytope, whose vertices are fixed, or a frustum, whose vertices are those points
/// of its two rims that are furthest along a direction. A vertex is the middle of a disc, its number, and a direction.
class RoundCore {
 public:
  RoundCore(const CoreView& core, const Eigen::Matrix3d& R, const Eigen::Vector3d& t)
      : core_(core), R_(R), t_(t), polytope_(core, R, t) {}

  bool round() const { return core_.kind == CoreKind::frustum; }
  Eigen::Vector3d axis() const { return R_.col(2); }
  const Eigen::Vector3d& origin() const { return t_; }

  CoreVertex vertex(const Eigen::Vector3d& n) const {
    if (!round()) return polytope_.vertex(n);
    const double x = n.dot(R_.col(0));
    const double y = n.dot(R_.col(1));
    const double across = length_of(x, y);
    const auto& [low, high] = core_.disc;
    const double rise = (high.z - low.z) * n.dot(R_.col(2)) + (high.radius - low.radius) * across;
    const int id = std::signbit(rise) ? 0 : 1;
    if (!(across > 0)) return {middle(id), id};
    return {middle(id) + radius(id) / across * (x * R_.col(0) + y * R_.col(1)), id};
  }

  /// Returns the middle of disc `id` of a frustum.
  Eigen::Vector3d middle(int id) const { return t_ + core_.disc[static_cast<std::size_t>(id)].z * R_.col(2); }
  /// Returns the radius of disc `id`; 0 for polytopes.
  double radius(int id) const { return round() ? core_.disc[static_cast<std::size_t>(id)].radius : 0; }
  /// Returns a direction across the axis, made so again.
  Eigen::Vector3d across(const Eigen::Vector3d& e) const {
    const double x = e.dot(R_.col(0));
    const double y = e.dot(R_.col(1));
    const double length = length_of(x, y);
    return length > 0 ? Eigen::Vector3d((x * R_.col(0) + y * R_.col(1)) / length) : Eigen::Vector3d(R_.col(0));
  }
  /// Returns how far a point is beyond the surface, negative inside.
  double beyond(const Eigen::Vector3d& x) const;
  /// Returns a translated copy.
  RoundCore moved(const Eigen::Vector3d& by) const { return {core_, R_, t_ + by}; }

 private:
  const CoreView& core_;
  const Eigen::Matrix3d& R_;
  Eigen::Vector3d t_;
  PlacedCore polytope_;
};

/// Replaces the vertices of a simplex, as reduce_to_closest() leaves it, by those to which they slide along their rims
/// when the closest point of the hull of all these discs is approached, and n by the normal there. Returns false, and
/// changes nothing, if no such point is found: rims that count by several points, as under a face, do not slide.
///
/// Newton's method for the unknowns n, d, the angles of both rims and the weights:
///
///     sum of weight_k p_k = d n,   n.t = 0 for the tangent t of each rim,   n.(p_k - p_0) = 0.
///
/// The angles are unknowns beside n: where n is nearly along an axis they change much more than n does, and where the
/// bodies nearly touch n would be lost in the rounding of the points. `n`: a first guess; d may be negative, for bodies
/// that overlap. A vertex whose weight becomes negative is left out; by a weight that may be rounding, `rival` becomes
/// the normal with that vertex.
bool slide(const RoundCore& a, const RoundCore& b, double size, CoreSimplex& simplex, Eigen::Vector3d& n,
           Eigen::Vector3d& rival);

/// Moves points on rims and round sides to where the normal has them.
///
/// The bounds of a contact hardly change while a point slides along a rim whose tangent is across the normal: they
/// leave an error of the square root of rounding in it, but the normal, which is known to rounding, tells where it is.
/// The other body's point follows it if it is free to.
void settle_points(const RoundCore& a, const RoundCore& b, double size, CoreContact& contact);

}  // namespace geom::kernel
