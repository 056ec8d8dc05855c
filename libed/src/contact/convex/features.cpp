#include "contact/convex/features.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace ed::internal {

using Eigen::Vector3d;

namespace {

/// Bounds of lines' closest points that are this near, in units of the size, agree.
constexpr double kLinesAgree = 1e-15;

/// Lines with a smaller squared sine are left to the search: the products below lose digits.
constexpr double kLeastSine2 = 1e-2;

struct LineParameters {
  double s = 0, t = 0;
};

LineParameters closest_on_lines(double l, double m, double c, double r_u, double r_w) {
  LineParameters at;
  if (l > 0) at.s = std::clamp(m > 0 ? (r_u - c * r_w) / (1 - c * c) : r_u, -l, l);
  if (m > 0) {
    at.t = c * at.s - r_w;
    if (std::abs(at.t) > m) {
      at.t = std::copysign(m, at.t);
      at.s = std::clamp(r_u + c * at.t, -l, l);
    }
  }
  return at;
}

}  // namespace

ClosestFeatures line_features(const PlacedPair& pair) {
  ClosestFeatures answer;
  answer.evaluations = 1;
  const Vector3d u = pair.R_a.col(2);
  const Vector3d w = pair.R_b.col(2);
  const double l = pair.a.core->half.z();
  const double m = pair.b.core->half.z();
  const double c = u.dot(w);
  if (l > 0 && m > 0 && !(1 - c * c > kLeastSine2)) return answer;
  const auto [s, t] = closest_on_lines(l, m, c, u.dot(pair.r), w.dot(pair.r));
  const Vector3d x = (pair.r + t * w) - s * u;
  const double upper = x.norm();
  if (!(upper > kLinesAgree * pair.size)) return answer;
  answer.n = x / upper;
  answer.upper = upper;
  answer.lower = answer.n.dot(pair.r) - (l * std::abs(answer.n.dot(u)) + m * std::abs(answer.n.dot(w)));
  if (!(upper - answer.lower <= kLinesAgree * pair.size)) return answer;
  answer.end = ClosestFeatures::End::closed;
  ConvexFeatures& f = answer.features;
  // Vertices of the face: an end that a segment is clamped to stays, else both ends of it count.
  const bool inside_a = std::abs(s) < l;
  const bool inside_b = std::abs(t) < m;
  const Vector3d a = (inside_a ? -l : s) * u;
  const Vector3d b = (inside_b ? -m : t) * w;
  const auto add = [&f](const Vector3d& p, const Vector3d& q, double weight) {
    const auto k = static_cast<std::size_t>(f.count++);
    f.a[k] = p;
    f.b[k] = q;
    f.weight[k] = weight;
  };
  const double share_a = inside_a ? 0.5 * (s + l) / l : 0;
  const double share_b = inside_b ? 0.5 * (t + m) / m : 0;
  add(a, b, 1 - share_a - share_b);
  if (inside_a) add(l * u, b, share_a);
  if (inside_b) add(a, m * w, share_b);
  return answer;
}

Vector3d turning_of_normal(const ConvexFeatures& features, const Vector3d& n, double distance, const Vector3d& v,
                           const Vector3d& omega_a, const Vector3d& omega_b) {
  const auto velocity = [&](const Vector3d& a, const Vector3d& b) {
    return Vector3d(v + omega_b.cross(b) - omega_a.cross(a));
  };
  const auto edge = [&](std::size_t k) {
    return Vector3d((features.b[k] - features.b[0]) - (features.a[k] - features.a[0]));
  };
  const auto edge_velocity = [&](std::size_t k) {
    return Vector3d(omega_b.cross(features.b[k] - features.b[0]) - omega_a.cross(features.a[k] - features.a[0]));
  };
  Vector3d rate = Vector3d::Zero();
  if (features.count == 3) {
    const Vector3d e = edge(1);
    const Vector3d f = edge(2);
    const Vector3d c = e.cross(f);
    const double c2 = c.squaredNorm();
    if (!(c2 > 1e-24 * e.squaredNorm() * f.squaredNorm())) return Vector3d::Zero();
    rate = (-n.dot(edge_velocity(1)) / c2) * f.cross(c) + (-n.dot(edge_velocity(2)) / c2) * c.cross(e);
  } else if (features.count > 0) {
    const Vector3d x = velocity(features.point_a(), features.point_b());
    if (!(distance > 0)) return Vector3d::Zero();
    if (features.count == 1) {
      rate = x / distance;
    } else {
      const Vector3d e = edge(1);
      const Vector3d b = n.cross(e);
      const double e2 = e.squaredNorm();
      rate = (-n.dot(edge_velocity(1)) / e2) * e + (x.dot(b) / (distance * e2)) * b;
    }
  }
  return n.cross(rate);
}

}  // namespace ed::internal
