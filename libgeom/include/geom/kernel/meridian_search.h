#pragma once

/// Bounds of the largest g of two bodies of revolution whose axes are parallel or nearly so (sphere_search.h defines
/// g).
///
/// Support heights only depend on the angle between n and the axis where axes are parallel. Of the normals with one
/// angle n.r is largest for that in the half-plane of the axis that B's centre is in: the search is one along a
/// half-circle, a meridian. On a common axis the best normals form a circle, which SphereSearch would have to cover
/// with tiny triangles.
///
/// Turning a body about its centre by an angle delta changes its support heights by its bounding radius times delta at
/// most, the slack. The gaps of nearly parallel axes are those of parallel ones within the slack, and their maximum is
/// that on the meridian within twice the slack.

#include <geom/kernel/sphere_search.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>

namespace geom::kernel {

/// Axis about which two bodies are of revolution, nearly.
struct CommonAxis {
  Eigen::Vector3d u;  ///< unit vector
  double slack;       ///< bound of the change of g when one body is turned until its axis is along u
};

/// Shape that tells its axis of revolution: a number of its frame's axes, or that it has none.
template <class Shape>
concept TellsAxis = requires(const Shape& shape) {
  { shape.symmetry_axis() } -> std::same_as<std::optional<int>>;
};

/// Returns the axis of two bodies of revolution whose axes are parallel or nearly so, else nullopt. Every axis of a
/// ball is one.
template <class ShapeA, class ShapeB>
std::optional<CommonAxis> common_axis(const ShapeA& a, const Eigen::Matrix3d& R_WA, const ShapeB& b,
                                      const Eigen::Matrix3d& R_WB) {
  if constexpr (TellsAxis<ShapeA> && TellsAxis<ShapeB>) {
    constexpr double kNearlyParallel = 1e-3;
    const std::optional<int> axis_a = a.symmetry_axis();
    const std::optional<int> axis_b = b.symmetry_axis();
    if (!axis_a || !axis_b) return std::nullopt;
    const Eigen::Vector3d u_a = R_WA.col(*axis_a);
    const Eigen::Vector3d u_b = R_WB.col(*axis_b);
    if (a.inscribed_radius() == a.bounding_radius()) return CommonAxis{u_b, 0};
    if (b.inscribed_radius() == b.bounding_radius()) return CommonAxis{u_a, 0};
    const double sine = u_a.cross(u_b).norm();
    if (sine > kNearlyParallel) return std::nullopt;
    const bool a_is_larger = a.bounding_radius() > b.bounding_radius();
    const double radius = a_is_larger ? b.bounding_radius() : a.bounding_radius();
    return CommonAxis{a_is_larger ? u_a : u_b, 1.001 * sine * radius};
  } else {
    return std::nullopt;
  }
}

/// Branch and bound over the normals of a meridian. `sample(n)` returns the Tangent at n.
///
/// A unit n between n_1 and n_2 is a combination of them with weights whose sum is from 1 to 1/c, c the cosine of half
/// their angle. Points and pairs of points bound g on an arc as they do in a triangle.
template <class Sample>
class MeridianSearch {
 public:
  /// Searches for a normal with g > best().g + tolerance until none is left or `budget` samples are spent. Afterwards
  /// max g <= upper() on the meridian. `r`: B's centre seen from A's; `rho`: radius of the ball that rolls in the
  /// difference.
  MeridianSearch(const Sample& sample, const Eigen::Vector3d& axis, const Eigen::Vector3d& r, double rho,
                 double tolerance, int budget)
      : sample_(sample), rho_(rho), best_(sample(axis)) {
    const Eigen::Vector3d e = direction_across(axis, r);
    std::array<Arc, kMostHalvings + 4> open;
    std::size_t count = 0;
    Tangent left = best_;
    for (const Eigen::Vector3d& n : {Eigen::Vector3d(axis + e), e, Eigen::Vector3d(e - axis), Eigen::Vector3d(-axis)}) {
      const Tangent right = take(n.normalized());
      open[count++] = {left, right};
      left = right;
    }
    for (upper_ = best_.g; count > 0;) {
      const Arc arc = open[--count];
      const double above = bound(arc);
      if (above <= best_.g + tolerance || samples_ >= budget || count + 2 > open.size()) {
        upper_ = std::max(upper_, above);
        continue;
      }
      const Tangent middle = take((arc.left.n + arc.right.n).normalized());
      open[count++] = {arc.left, middle};
      open[count++] = {middle, arc.right};
    }
    upper_ = std::max(upper_, best_.g);
  }

  const Tangent& best() const { return best_; }
  double upper() const { return upper_; }

 private:
  struct Arc {
    Tangent left, right;
  };
  using TwoHeights = Eigen::Vector2d;

  static constexpr std::size_t kMostHalvings = 60;

  /// Returns the direction of r across the axis; any one if rounding hides it.
  static Eigen::Vector3d direction_across(const Eigen::Vector3d& axis, const Eigen::Vector3d& r) {
    constexpr double kHidden = 1e-14;
    const Eigen::Vector3d across = r - r.dot(axis) * axis;
    const double length = across.stableNorm();
    if (!(length > kHidden * r.stableNorm())) return axis.unitOrthogonal();
    const Eigen::Vector3d e = across / length;
    return (e - e.dot(axis) * axis).normalized();
  }

  Tangent take(const Eigen::Vector3d& n) {
    ++samples_;
    Tangent t = sample_(n);
    if (t.g > best_.g) best_ = t;
    return t;
  }

  /// Returns the largest height of the point between two whose heights are equal; infinite if there is none.
  static double equal_between(const TwoHeights& a, const TwoHeights& b) {
    const TwoHeights rise = b - a;
    const double share = (a[0] - a[1]) / (rise[1] - rise[0]);
    return share > 0 && share < 1 ? (a + share * rise).maxCoeff() : std::numeric_limits<double>::infinity();
  }

  double bound(const Arc& arc) const {
    const double c = std::sqrt(std::max(0.0, 0.5 * (1 + arc.left.n.dot(arc.right.n))));
    std::array<TwoHeights, 3> of;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Tangent& t = k == 0 ? arc.left : k == 1 ? arc.right : best_;
      const Eigen::Vector3d q = t.p + rho_ * t.n;
      of[k] = {arc.left.n.dot(q), arc.right.n.dot(q)};
      least = std::min(least, of[k].maxCoeff());
      for (std::size_t l = 0; l < k; ++l) least = std::min(least, equal_between(of[l], of[k]));
    }
    return (least > 0 ? least / c : least) - rho_;
  }

  const Sample& sample_;
  double rho_;
  Tangent best_;
  double upper_ = 0;
  int samples_ = 1;
};

}  // namespace geom::kernel
