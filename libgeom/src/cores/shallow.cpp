#include "cores/shallow.h"

#include "cores/descent.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace geom::kernel {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Search for directions from the furthest point along n into the set, such that the one to the origin, -n, is between
/// them. A direction is a point of the plane at the distance 1 below the furthest point; the origin is below (0, 0).
class ShallowOverlap {
 public:
  ShallowOverlap(const RoundCore& a, const RoundCore& b, double size, const CoreContact& contact)
      : a_(a),
        b_(b),
        n_(contact.n),
        u_(any_across(contact.n)),
        v_(contact.n.cross(u_)),
        tip_(-contact.lower * contact.n),
        bottom_(furthest(-contact.n)),
        least_height_(kShare * height(bottom_)) {
    missing_ = mismatch_of(contact) + 8 * kCoreRounding * size;
  }

  /// Returns the certain depth; 0 if the origin is not found to be inside.
  double depth() {
    if (!(least_height_ > 0)) return 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi / 3 * static_cast<double>(k);
      corner_[k] = seen(furthest(std::cos(angle) * u_ + std::sin(angle) * v_ - 0.5 * n_));
    }
    if ((corner_[1] - corner_[0]).dot(turned(corner_[2] - corner_[0])) < 0) std::swap(corner_[1], corner_[2]);
    for (int step = 0; step < kMostSteps; ++step) {
      const auto [k, inside] = nearest_side();
      if (inside > 0 || !replace(k, inside)) break;
    }
    const double inside = nearest_side().inside;
    const double below_tip = n_.dot(tip_);
    const double certain = std::min(below_tip * inside / std::sqrt(1 + inside * inside), lowest_ - below_tip);
    return std::max(0.0, certain - missing_);
  }

 private:
  static constexpr int kMostSteps = 12;
  static constexpr double kShare = 1e-3;  // of the height of the set: points less far below the tip are lowered by it

  struct Side {
    std::size_t opposite;  // corner
    double inside;         // distance of the origin from it, positive inside
  };

  static Vector2d turned(const Vector2d& x) { return {x.y(), -x.x()}; }
  Vector3d furthest(const Vector3d& w) const { return -difference_vertex(a_, b_, w).p; }
  double height(const Vector3d& x) const { return n_.dot(tip_ - x); }

  /// Returns the direction to a point of the set, moved towards the lowest one where it is nearly as high as the tip.
  Vector2d seen(const Vector3d& x) {
    const double share = height(x) < least_height_ ? kShare : 0;
    const Vector3d from = (1 - share) * x + share * bottom_ - tip_;
    const double below = -n_.dot(from);
    lowest_ = std::min(lowest_, below);
    return Vector2d(u_.dot(from), v_.dot(from)) / below;
  }

  /// Returns the unit vector out of the side opposite a corner; the corners are anticlockwise.
  Vector2d outward(std::size_t k) const { return turned(corner_[(k + 2) % 3] - corner_[(k + 1) % 3]).normalized(); }
  Side nearest_side() const {
    Side nearest{0, std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < 3; ++k) {
      const double inside = outward(k).dot(corner_[(k + 1) % 3]);
      if (!(inside >= nearest.inside)) nearest = {k, inside};
    }
    return nearest;
  }

  /// Replaces the corner opposite a side by a point beyond it; returns false if there is none.
  bool replace(std::size_t k, double inside) {
    const Vector2d e = outward(k);
    const Vector2d next = seen(furthest(e.x() * u_ + e.y() * v_ + inside * n_));
    if (!(e.dot(next) > inside)) return false;
    corner_[k] = next;
    std::swap(corner_[(k + 1) % 3], corner_[(k + 2) % 3]);
    return true;
  }

  const RoundCore& a_;
  const RoundCore& b_;
  Vector3d n_, u_, v_;
  Vector3d tip_, bottom_;
  double least_height_;
  double lowest_ = std::numeric_limits<double>::infinity();  // height below the tip that all corners' points reach
  double missing_ = 0;
  std::array<Vector2d, 3> corner_;
};

}  // namespace

double certain_depth(const RoundCore& a, const RoundCore& b, double size, const CoreContact& contact) {
  return ShallowOverlap(a, b, size, contact).depth();
}

}  // namespace geom::kernel
