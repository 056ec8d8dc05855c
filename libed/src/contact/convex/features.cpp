#include "contact/convex/features.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace ed::internal {

using Eigen::Matrix3d;
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

namespace {

/// Returns the Hessian of the support function of a body's rims at the outward normal m, in the world's axes.
Matrix3d hessian_of_rims(const ConvexBody& body, const Matrix3d& R, const Vector3d& m) {
  if (!body.rims()) return Matrix3d::Zero();
  return R * geom::kernel::rim_hessian(*body.core, R.transpose() * m) * R.transpose();
}

/// Returns whether the points of two vertices of one body are the same, or on the same rim not far from each other.
bool rolls_to(const ConvexBody& body, const Matrix3d& R, const Vector3d& p, const Vector3d& q) {
  constexpr double kNear = 0.5;  // chord, in units of the radius
  if (p == q) return true;
  if (!body.rims()) return false;
  const auto& [low, high] = body.core->disc;
  const double middle = 0.5 * (low.z + high.z);
  const double z_p = R.col(2).dot(p);
  const double z_q = R.col(2).dot(q);
  if ((z_p > middle) != (z_q > middle)) return false;
  return (p - q).norm() <= kNear * (z_p > middle ? high.radius : low.radius);
}

/// Directions in which two bodies are flat where they touch a plane across n, and how the normal's parts along them
/// change.
class FlatDirections {
 public:
  explicit FlatDirections(const Vector3d& n) : n_(n) {}

  /// Adds an edge that changes at the rate e', unless it is along those that are there.
  void add(const Vector3d& edge, const Vector3d& rate) {
    constexpr double kSame = 1e-3;
    const double length = edge.norm();
    if (count_ == 2 || !(length > 0)) return;
    const Vector3d e = edge / length;
    if (count_ == 1 && !(e.cross(edge_[0]).norm() > kSame)) return;
    edge_[count_] = e;
    change_[count_++] = -n_.dot(rate) / length;
  }

  /// Adds what a body's core, turned by R at omega, has: edges and faces across the outward normal m.
  void add(const ConvexBody& body, const Matrix3d& R, const Vector3d& m, const Vector3d& omega) {
    constexpr double kAcross = 1e-9;
    if (!body.core) return;
    const auto add_if_across = [&](const Vector3d& e) {
      if (std::abs(m.dot(e)) <= kAcross * e.norm()) add(e, omega.cross(e));
    };
    switch (body.core->kind) {
      case geom::kernel::CoreKind::point:
        break;
      case geom::kernel::CoreKind::segment:
        add_if_across(R.col(2));
        break;
      case geom::kernel::CoreKind::box:
        for (int k = 0; k < 3; ++k) add_if_across(R.col(k));
        break;
      case geom::kernel::CoreKind::hull: {
        const auto& vertices = body.core->hull->vertices;
        const Vector3d seen = R.transpose() * m;
        const Vector3d top = vertices.row(geom::kernel::support_vertex(*body.core->hull, seen)).transpose();
        for (Eigen::Index k = 0; k < vertices.rows(); ++k) {
          const Vector3d edge = vertices.row(k).transpose() - top;
          if (std::abs(edge.dot(seen)) <= kAcross * body.core_reach) add_if_across(R * edge);
        }
        break;
      }
      case geom::kernel::CoreKind::frustum: {
        const Vector3d axis = R.col(2);
        const Vector3d across = m - m.dot(axis) * axis;
        if (across.norm() <= kAcross) {
          add(R.col(0), omega.cross(R.col(0)));
          add(R.col(1), omega.cross(R.col(1)));
        } else {
          const auto& [low, high] = body.core->disc;
          add_if_across((high.z - low.z) * axis + (high.radius - low.radius) * across.normalized());
        }
        break;
      }
    }
  }

  int count() const { return static_cast<int>(count_); }
  const Vector3d& edge(std::size_t k) const { return edge_[k]; }

  /// Returns the part of n' in the span of the directions.
  Vector3d rate() const {
    if (count_ == 0) return Vector3d::Zero();
    if (count_ == 1) return change_[0] * edge_[0];
    const Vector3d c = edge_[0].cross(edge_[1]);
    return (change_[0] * edge_[1].cross(c) + change_[1] * c.cross(edge_[0])) / c.squaredNorm();
  }

 private:
  Vector3d n_;
  std::size_t count_ = 0;
  std::array<Vector3d, 2> edge_;
  std::array<double, 2> change_{};
};

}  // namespace

Vector3d turning_with_rims(const PlacedPair& pair, const ConvexFeatures& features, const Vector3d& n, double distance,
                           const PairVelocity& velocity) {
  constexpr double kFlat = 1e-12;  // radius of curvature, in units of the bodies' reach, that is a kink
  const auto& [v, omega_a, omega_b] = velocity;
  if (features.count == 0) return Vector3d::Zero();
  FlatDirections flat(n);
  for (std::size_t k = 1; k < static_cast<std::size_t>(features.count); ++k) {
    const Vector3d e_a = features.a[k] - features.a[0];
    const Vector3d e_b = features.b[k] - features.b[0];
    const bool rolls = rolls_to(pair.a, pair.R_a, features.a[k], features.a[0]) &&
                       rolls_to(pair.b, pair.R_b, features.b[k], features.b[0]);
    if (!rolls) flat.add(e_b - e_a, omega_b.cross(e_b) - omega_a.cross(e_a));
  }
  flat.add(pair.a, pair.R_a, n, omega_a);
  flat.add(pair.b, pair.R_b, -n, omega_b);
  const Vector3d fixed = flat.rate();
  if (flat.count() == 2) return n.cross(fixed);
  const Matrix3d H_a = hessian_of_rims(pair.a, pair.R_a, n);
  const Matrix3d H_b = hessian_of_rims(pair.b, pair.R_b, -n);
  const Matrix3d H = H_a + H_b + std::max(0.0, distance) * Matrix3d::Identity();
  const double least = kFlat * (pair.a.core_reach + pair.b.core_reach);
  const Vector3d x = v + omega_b.cross(features.point_b()) - omega_a.cross(features.point_a()) +
                     H_a * omega_a.cross(n) + H_b * omega_b.cross(n);
  // What is left is in the plane across n, and across the edge if there is one.
  const Vector3d rest = x - H * fixed;
  if (flat.count() == 1) {
    const Vector3d b = n.cross(flat.edge(0)).normalized();
    const double bend = b.dot(H * b);
    return bend > least ? n.cross(fixed + b.dot(rest) / bend * b) : n.cross(fixed);
  }
  const Vector3d p = n.unitOrthogonal();
  const Vector3d q = n.cross(p);
  const double pp = p.dot(H * p);
  const double pq = p.dot(H * q);
  const double qq = q.dot(H * q);
  const double determinant = pp * qq - pq * pq;
  if (!(determinant > least * (pp + qq))) return Vector3d::Zero();
  const double along_p = (qq * p.dot(rest) - pq * q.dot(rest)) / determinant;
  const double along_q = (pp * q.dot(rest) - pq * p.dot(rest)) / determinant;
  return n.cross(along_p * p + along_q * q);
}

}  // namespace ed::internal
