#include "cores/contact.h"

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

/// Two segments, or a segment and a point, or two points: from centre +- half axis each.
struct Segments {
  const Vector3d& u;
  double half_a;
  const Vector3d& v;
  double half_b;
  const Vector3d& r;

  /// Returns the gap between the tangent planes across n.
  double gap(const Vector3d& n) const { return n.dot(r) - (half_a * std::abs(n.dot(u)) + half_b * std::abs(n.dot(v))); }
  double size() const { return r.norm() + half_a + half_b; }
};

/// Parameters of the closest points along both axes.
struct Parameters {
  double s = 0, t = 0;
};

/// Returns the parameters of the closest points of parallel segments: the middle of the part where they are side by
/// side, else the ends.
Parameters side_by_side(const Segments& p) {
  const double along = p.u.dot(p.r);
  const double low = std::max(-p.half_a, along - p.half_b);
  const double high = std::min(p.half_a, along + p.half_b);
  const double s = std::clamp(0.5 * (low + high), -p.half_a, p.half_a);
  const double t = std::clamp(p.v.dot(s * p.u - p.r), -p.half_b, p.half_b);
  return {s, t};
}

/// Returns the closest points of the lines, brought back into the segments one after the other: the squared distance is
/// a convex function of both parameters. `c` = u x v.
Parameters closest_parameters(const Segments& p, const Vector3d& c) {
  const double c2 = c.squaredNorm();
  // Along nearly parallel lines the sum below would lose all digits to the products' rounding.
  constexpr double kNearlyParallel2 = 1e-6;
  if (!(c2 > 0)) return side_by_side(p);
  const Vector3d r_v = c2 < kNearlyParallel2 ? accurate_cross(p.r, p.v) : Vector3d(p.r.cross(p.v));
  double s = std::clamp(r_v.dot(c) / c2, -p.half_a, p.half_a);
  double t = p.v.dot(s * p.u - p.r);
  if (std::abs(t) > p.half_b) {
    t = std::copysign(p.half_b, t);
    s = std::clamp(p.u.dot(p.r + t * p.v), -p.half_a, p.half_a);
  }
  return {s, t};
}

/// Improves the normal of a contact where rounding has tilted it against the segments: the candidates are exact for the
/// ends and insides of both.
[[gnu::noinline]] void improve(const Segments& p, const Vector3d& c, CoreContact& contact) {
  const Vector3d y = contact.b - contact.a;
  const auto consider = [&](Vector3d n, bool of_plane) {
    const double length = n.norm();
    if (!(length > 0)) return;
    n /= length;
    if (of_plane && n.dot(p.r) < 0) n = -n;
    const double g = p.gap(n);
    if (g > contact.lower) {
      contact.lower = g;
      contact.n = n;
    }
  };
  const auto across = [](const Vector3d& x, const Vector3d& axis) {
    const Vector3d once = x - x.dot(axis) * axis;
    return Vector3d(once - once.dot(axis) * axis);
  };
  consider(across(y, p.u), false);
  consider(across(y, p.v), false);
  const double c2 = c.squaredNorm();
  if (c2 > 0) consider(across(c / std::sqrt(c2), p.u), true);
  if (p.half_a == 0 && p.half_b == 0) return;
  // Segments that cross, or are in one line: any normal across both is right.
  if (!(c2 > 0)) consider(any_across(p.half_a > 0 ? p.u : p.v), false);
  consider(any_across(p.u), false);
  consider(any_across(p.v), false);
}

}  // namespace

CoreContact segment_contact(const Vector3d& axis_a, double half_a, const Vector3d& axis_b, double half_b,
                            const Vector3d& r) {
  const Segments p{axis_a, half_a, axis_b, half_b, r};
  Vector3d c = Vector3d::Zero();
  Parameters at;
  if (half_a > 0 && half_b > 0) {
    c = axis_a.cross(axis_b);
    if (c.squaredNorm() < 1e-6) c = accurate_cross(axis_a, axis_b);
    at = closest_parameters(p, c);
  } else if (half_a > 0) {
    at.s = std::clamp(axis_a.dot(r), -half_a, half_a);
  } else if (half_b > 0) {
    at.t = std::clamp(-axis_b.dot(r), -half_b, half_b);
  }
  CoreContact contact;
  contact.a = at.s * axis_a;
  contact.b = r + at.t * axis_b;
  const Vector3d y = contact.b - contact.a;
  const double upper = y.norm();
  if (upper > 0) contact.n = y / upper;
  contact.lower = p.gap(contact.n);
  constexpr double kClosed = 4e-16;
  if (upper - contact.lower > kClosed * p.size()) improve(p, c, contact);
  return contact;
}

CoreContact box_point_contact(const Eigen::Matrix3d& axes, const Vector3d& half, const Vector3d& r) {
  const Vector3d p = axes.transpose() * r;
  const Vector3d inside = p.cwiseMax(-half).cwiseMin(half);
  const Vector3d y = p - inside;
  CoreContact contact;
  contact.b = r;
  Vector3d n = y;
  if (const double length = y.norm(); length > 0) {
    n /= length;
    contact.lower = length;
  } else {
    int k = 0;
    const double depth = (half - p.cwiseAbs()).minCoeff(&k);
    n = std::copysign(1.0, p[k]) * Vector3d::Unit(k);
    contact.lower = -depth;
  }
  contact.n = axes * n;
  contact.a = axes * Vector3d(p - contact.lower * n);
  return contact;
}

}  // namespace geom::kernel
